"""Flies a mission from arming to its end, as fast as the processor permits."""

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from inspection.geodesy import LonLat
from simulation.flight.events import Crashed, Event, PhotoTaken
from simulation.flight.states import FlightMode, MissionItemState, OrderRefused, SimulatedState
from simulation.flight.uav import SimulatedUav

MAX_DURATION_S = 4 * 3_600.0  # longer than any battery lasts
SETTLES_S = 2.0  # after the last item, until it hovers


class Ending(StrEnum):
    LANDED = "landed"
    HOVERING = "hovering"
    CRASHED = "crashed"
    FLYING = "flying"  # the time limit was reached
    REFUSED = "refused"  # it did not take off


class FlightSample(NamedTuple):
    """True position. Heights are above the take-off and above ground; the battery is in percent."""

    at_s: float
    lon: float
    lat: float
    altitude_relative_m: float
    altitude_agl_m: float
    battery_percent: float


@dataclass(frozen=True)
class FlownFlightLog:
    """Log of a flight. `samples` begin at arming, `end` is the final state, and `refusal` is why it did not take off."""

    ending: Ending
    samples: tuple[FlightSample, ...]
    events: tuple[Event, ...]
    end: SimulatedState
    refusal: OrderRefused | None = None

    @property
    def crash(self) -> Crashed | None:
        return next((event for event in self.events if isinstance(event, Crashed)), None)

    @property
    def photos(self) -> tuple[PhotoTaken, ...]:
        return tuple(event for event in self.events if isinstance(event, PhotoTaken))

    @property
    def touched_down_at(self) -> LonLat | None:
        return self.end.true_position if self.ending is Ending.LANDED else None


def fly_mission(uav: SimulatedUav, *, longest_s: float = MAX_DURATION_S, sample_steps: int = 1) -> FlownFlightLog:
    """Arm and fly the loaded mission until it has landed, hovers after its last item, or has crashed.

    Samples every `sample_steps` steps of 0.04 s. Terminates for every mission: an endless one empties the battery.
    """
    outcome = uav.set_mode(FlightMode.MISSION)
    if outcome.is_done:
        outcome = uav.arm()
    if isinstance(outcome, OrderRefused):
        return FlownFlightLog(Ending.REFUSED, (), tuple(uav.take_events()), uav.state, outcome)
    samples, events, began_s = [_sample(uav)], uav.take_events(), uav.now_s
    hovers_since_s: float | None = None
    ending = Ending.FLYING
    steps = 0
    while uav.now_s - began_s < longest_s:
        uav.step()
        steps += 1
        if steps % sample_steps == 0:
            samples.append(_sample(uav))
        events += uav.take_events()
        if uav.is_crashed:
            ending = Ending.CRASHED
            break
        if not uav.is_armed:
            ending = Ending.LANDED
            break
        if uav.mission_state is MissionItemState.COMPLETE:
            hovers_since_s = uav.now_s if hovers_since_s is None else hovers_since_s
            if uav.now_s - hovers_since_s >= SETTLES_S:
                ending = Ending.HOVERING
                break
    if steps % sample_steps:
        samples.append(_sample(uav))
    return FlownFlightLog(ending, tuple(samples), tuple(events), uav.state)


def _sample(uav: SimulatedUav) -> FlightSample:
    return FlightSample(*uav.true_place, uav.battery_percent)
