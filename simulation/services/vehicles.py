"""Simulated UAVs for the flights of a rehearsal: JSBSim models over the stored terrain, in the air of a set of conditions."""

from collections.abc import Sequence
from dataclasses import replace

from mavlink.vehicle_plan import MissionItem
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.events import Crashed, Said
from simulation.flight.states import Mode, Outcome, Severity, UavState
from simulation.flight.uav import SimulatedUav
from simulation.rehearsing.flying import MakeVehicle, Start, Vehicle
from simulation.rehearsing.ground import BlockedGround, Heights
from simulation.rehearsing.sky import Sky
from simulation.rehearsing.sky_weather import weather_of
from simulation.services.fleet import StandIn
from simulation.vehicle_protocol.havens import havens_of


class RehearsedUav:
    """A simulated UAV as a rehearsal orders it about."""

    def __init__(self, uav: SimulatedUav) -> None:
        self._uav = uav

    @property
    def now_s(self) -> float:
        return self._uav.now_s

    @property
    def state(self) -> UavState:
        return self._uav.state

    def step(self) -> None:
        self._uav.step()

    def load(self, items: Sequence[MissionItem], rally: Sequence[MissionItem]) -> Outcome:
        self._uav.havens = havens_of(rally, self._uav.state.home_amsl_m)
        return self._uav.load(items)

    def arm(self) -> Outcome:
        return self._uav.arm()

    def take_off(self, height_relative_m: float) -> Outcome:
        return self._uav.take_off(height_relative_m)

    def start_mission(self) -> Outcome:
        return self._uav.set_mode(Mode.MISSION)

    def take_texts(self) -> list[str]:
        """What it has said of trouble since it was last asked. Why it has crashed is told once."""
        events = self._uav.take_events()
        reasons = [event.reason for event in events if isinstance(event, Crashed)]
        said = [event.text for event in events if isinstance(event, Said) and event.severity is not Severity.INFO]
        return [text for text in said if not any(text.endswith(reason) for reason in reasons)] + reasons


def vehicle_maker(stand_ins: Sequence[StandIn], sky: Sky, terrain: Heights | None) -> MakeVehicle:
    """Makes the UAV for each flight: its airframe with the battery of the UAV that it stands in for, as full as the conditions say."""
    by_uav = {stand_in.uav: stand_in for stand_in in stand_ins}
    weather = weather_of(sky)

    def make(start: Start) -> Vehicle:
        stand_in = by_uav[start.uav]
        airframe = replace(AIRFRAMES[stand_in.airframe], battery_wh=stand_in.battery_wh)
        home_m = 0.0 if start.ground_amsl_m is None else start.ground_amsl_m
        ground = BlockedGround(None if start.ground_amsl_m is None else terrain, home_m)
        uav = SimulatedUav(
            airframe, start.home, ground=ground, weather=weather, seed=start.seed, heading_deg=start.heading_deg,
            battery_percent=sky.battery_percent,
        )  # fmt: skip
        return RehearsedUav(uav)

    return make
