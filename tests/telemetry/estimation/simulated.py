"""Flights of simulated UAVs as truths for the estimator: flown by JSBSim along the very items that would be sent.

Nothing of the estimator is in them: another autopilot, other speeds up and down, winds that differ from the forecast, gusts, turbulence.
Now and then an operator pauses a flight, calls it back, or lets it land.
"""

import math
import random
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from pymavlink.dialects.v20 import common as mavlink

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import Flight, FrozenRoute
from mavlink.autopilot_type import AutopilotType, mode_name
from mavlink.mission_items import flight_loads
from mavlink.vehicle_plan import MissionItem
from planning.energy.conditions import Conditions, WindLayer
from simulation.flight.airframe import AIRFRAMES, Airframe
from simulation.flight.events import ItemReached
from simulation.flight.faults import Weather
from simulation.flight.states import FlightMode, MissionItemState
from simulation.flight.uav import SimulatedUav
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot, usual_number
from telemetry.estimation.knowledge import Knowledge
from tests.simulation.rehearsals.planned_flights import planned_timing, usable_wh
from tests.telemetry.estimation.received import reports_of
from tests.telemetry.estimation.routes import drawn_route, route_on_line
from tests.telemetry.estimation.scoring import BEGUN_S, INTERVALS_S, Score, score
from tests.telemetry.estimation.truth import MAX_DURATION_S, STEP_S, Events, Truth

SAMPLE_STEPS = 5  # of 0.04 s; the rest of a truth's rows lie between
HOVERS_S = 20.0
STANDS_S = 8.0  # after the landing
SPEEDS_MPS = {"iris": (4.0, 5.0, 6.0, 8.0), "inspector": (8.0, 10.0, 12.0, 14.0)}
MAX_WIND_MPS = {"iris": 6.0, "inspector": 10.0}  # as forecast
WIND_AGL_M = 60.0


@dataclass(frozen=True)
class SimulatedFlight:
    """What is flown, what the plan knew of it, and the air that it really met."""

    route: FrozenRoute
    flight: Flight
    knowledge: Knowledge
    airframe: Airframe
    weather: Weather
    autopilot_type: SimulatedAutopilot


def simulated_flight(seed: int, lines: Sequence[Sequence[LonLat]] = ()) -> SimulatedFlight:
    """Every other airframe an Iris, where its battery lasts for the route; with lines every other flight along a stretch of one of them."""
    chance = random.Random(f"simulated {seed}")
    code = "iris" if seed // 2 % 2 else "inspector"
    autopilot_type = chance.choice(list(SimulatedAutopilot))
    while True:
        speeds, most_mps = SPEEDS_MPS[code], MAX_WIND_MPS[code]
        route = route_on_line(seed, lines, speeds) if lines and seed % 2 else drawn_route(seed, speeds)
        forecast = WindLayer(WIND_AGL_M, chance.choice([0.0, 1.0]) * chance.uniform(1.0, most_mps), chance.uniform(0.0, 359.0))
        timed = planned_timing(route, code, Conditions((forecast,)))
        if code == "inspector" or (timed.total_wh or math.inf) < usable_wh(code):
            break
        code = "inspector"
    flight = route.flights[0]
    knowledge = Knowledge(
        flight, route.cruise_speed_mps, AIRFRAMES[code].max_airspeed_mps, conditions=Conditions((forecast,)), home=flight.take_off.position
    )
    return SimulatedFlight(route, flight, knowledge, AIRFRAMES[code], _weather(forecast, chance), autopilot_type)


def _weather(forecast: WindLayer, chance: random.Random) -> Weather:
    """The forecast wind is turned, stronger or weaker, and more than its mean."""
    speed_mps = forecast.speed_mps * min(max(chance.gauss(1.0, 0.25), 0.3), 1.5)
    wind = WindLayer(WIND_AGL_M, speed_mps, (forecast.from_deg + chance.gauss(0.0, 15.0)) % 360.0)
    rough = chance.choice(["smooth", "gusts", "turbulence"])
    return Weather(
        Conditions((wind,)),
        gusts_mps=chance.uniform(0.5, 2.0) if rough == "gusts" else 0.0,
        turbulence_mps_at_20ft=max(speed_mps, 3.0) if rough == "turbulence" else 0.0,
    )


def fly_simulated(case: SimulatedFlight, seed: int, events: Events | None = None, *, physics_hz: int = 250) -> Truth:
    """Stands there for a while, is started, flies, and stands or hovers again at the end."""
    return _Operator(case, seed, events or Events(), physics_hz).fly()


@dataclass
class _Log:
    rows: list[tuple[float, ...]] = field(default_factory=list)
    modes: list[FlightMode] = field(default_factory=list)
    armed: list[bool] = field(default_factory=list)
    in_air: list[bool] = field(default_factory=list)
    sequence: list[int] = field(default_factory=list)
    reached: dict[int, float] = field(default_factory=dict)


class _Operator:
    """Pauses, calls back and lands as those of `truth.py` do, at the same shares of flights."""

    def __init__(self, case: SimulatedFlight, seed: int, events: Events, physics_hz: int) -> None:
        chance = random.Random(f"operator {seed}")
        self._case = case
        self._items: tuple[MissionItem, ...] = flight_loads(case.route)[case.flight.number].mission
        self._frame = LocalFrame.around(*case.flight.take_off.position)
        self._uav = SimulatedUav(
            case.airframe, case.flight.take_off.position, weather=case.weather, seed=seed, heading_deg=chance.uniform(0.0, 359.0),
            physics_hz=physics_hz,
        )  # fmt: skip
        self._log = _Log()
        self._starts_s = chance.uniform(2.0, 12.0)
        length_s = planned_timing(case.route, case.airframe.code, case.knowledge.conditions).total_s
        stated = chance.random()
        self._pauses_s = chance.uniform(0.1, 0.9) * length_s if stated < events.paused else math.inf
        self._goes_on_s = self._pauses_s + chance.uniform(15.0, 90.0)
        called = events.paused <= stated < events.paused + events.returned + events.landed
        self._called_s = chance.uniform(0.1, 0.9) * length_s if called else math.inf
        self._is_return = stated < events.paused + events.returned

    def fly(self) -> Truth:
        uav = self._uav
        self._must(uav.load(self._items).is_done)
        self._until(self._starts_s)
        self._must(uav.set_mode(FlightMode.MISSION).is_done and uav.arm().is_done)
        while uav.now_s < MAX_DURATION_S and uav.is_armed and uav.mission_state is not MissionItemState.COMPLETE:
            self._intervene()
            self._step()
        self._must(not uav.is_crashed)
        self._until(uav.now_s + (HOVERS_S if uav.is_armed else STANDS_S))
        return self._truth()

    def _intervene(self) -> None:
        uav = self._uav
        if uav.now_s >= self._pauses_s and uav.state.is_in_air:
            self._pauses_s = math.inf
            uav.hold()
        elif uav.now_s >= self._goes_on_s and self._pauses_s == math.inf:
            self._goes_on_s = math.inf
            uav.set_mode(FlightMode.MISSION)
        elif uav.now_s >= self._called_s and uav.state.is_in_air:
            self._called_s = math.inf
            _ = uav.return_home() if self._is_return else uav.land()

    def _until(self, second: float) -> None:
        while self._uav.now_s < second:
            self._step()

    def _step(self) -> None:
        for _ in range(SAMPLE_STEPS):
            self._uav.step()
        state, log = self._uav.state, self._log
        north_mps, east_mps, down_mps = state.velocity_ned_mps
        log.rows.append((self._uav.now_s, *state.true_position, state.altitude_relative_m, east_mps, north_mps, -down_mps))
        log.modes.append(state.mode)
        log.armed.append(state.is_armed)
        log.in_air.append(state.is_in_air)
        log.sequence.append(self._waypoint(state.current_item))
        for event in self._uav.take_events():
            if isinstance(event, ItemReached) and self._items[event.index].command == mavlink.MAV_CMD_NAV_WAYPOINT:
                item = self._items[event.index]
                log.reached.setdefault(self._waypoint(event.index), event.at_s - item.parameters[0])  # told when its hold is over

    def _waypoint(self, item: int) -> int:
        waypoint = self._items[item].waypoint
        return 0 if waypoint is None else waypoint

    def _must(self, is_well: bool) -> None:
        if not is_well:
            raise AssertionError(f"a flight that is none: {self._uav.take_events()}")

    def _truth(self) -> Truth:
        log, columns = self._log, np.array(self._log.rows)
        columns[:, 1:3] = self._frame.to_metres(columns[:, 1:3])
        seconds = np.arange(0.0, columns[-1, 0], STEP_S)
        rows = np.column_stack([seconds, *(np.interp(seconds, columns[:, 0], column) for column in columns[:, 1:].T)])
        place = np.minimum(np.searchsorted(columns[:, 0], seconds), len(columns) - 1).tolist()
        names = {
            mode: mode_name(AutopilotType(self._case.autopilot_type), usual_number(self._case.autopilot_type, mode)) for mode in FlightMode
        }
        return Truth(
            self._frame,
            rows,
            [names[log.modes[row]] for row in place],
            [log.in_air[row] for row in place],
            [log.sequence[row] for row in place],
            log.reached,
            [log.armed[row] for row in place],
        )


def score_simulated(
    seeds: Iterable[int], lines: Sequence[Sequence[LonLat]] = (), intervals_s: Sequence[float] = INTERVALS_S, *, physics_hz: int = 250
) -> dict[float, Score]:
    """By report interval. The model flies as well at 100 Hz, for less."""
    found = {every_s: Score() for every_s in intervals_s}
    for seed in seeds:
        case = simulated_flight(seed, lines)
        truth = fly_simulated(case, seed, physics_hz=physics_hz)
        for every_s, so_far in found.items():
            so_far.add(score(truth, case.knowledge, reports_of(truth, every_s, seed, begun_s=BEGUN_S)))
    return found
