"""Flights that did not happen: a UAV flies an approved flight second by second, and reports what instruments would."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from uuid import UUID

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import LAND, Flight, FrozenWaypoint, TakeOff
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.performance import Performance
from planning.rules import FlightRules, Manoeuvres
from planning.task import Task, TaskKind
from planning.trajectory.waypoints import WaypointKind
from telemetry.alerting.consumption import Consumption
from telemetry.alerting.energy import energy_plan
from telemetry.alerting.route_line import RouteLine
from telemetry.alerting.surroundings import FlightModel

MISSION = UUID(int=8)
START_S = 1_795_000_000.0
CLIMB_MPS, SINK_MPS = 2.5, 1.5
MANOEUVRES = Manoeuvres(acceleration_mps2=math.inf, corner_mps2=math.inf, settle_s=0.0, lift_s=0.0)  # as _fly turns and stops: at once


@dataclass(frozen=True)
class State:
    """Where it is in truth, `seconds` after take-off. `share` is of the leg that leads to vertex `vertex`."""

    seconds: float
    east: float
    north: float
    height_m: float
    east_mps: float = 0.0
    north_mps: float = 0.0
    up_mps: float = 0.0
    vertex: int = 0
    holds: bool = False
    is_in_air: bool = True
    used_percent: float = 0.0


@dataclass(frozen=True)
class TrueFlight:
    """`states` are one second apart."""

    flight: Flight
    model: FlightModel
    frame: LocalFrame
    cruise_mps: float
    conditions: Conditions
    states: tuple[State, ...]

    def position(self, east: float, north: float) -> LonLat:
        return LonLat(*self.frame.to_degrees(np.array([[east, north]]))[0].tolist())

    def cruising(self, least_s: int) -> list[int]:
        """Seconds from which it flies straight and level on for so long."""
        found = []
        for second in range(len(self.states) - least_s):
            first, last = self.states[second], self.states[second + least_s]
            if first.vertex == last.vertex and not first.holds and not last.holds and math.hypot(first.east_mps, first.north_mps) > 1.0:
                found.append(second)
        return found


def true_flight(seed: int, *, least_leg_m: float = 80.0) -> TrueFlight:
    random = np.random.default_rng(seed)
    frame = LocalFrame.around(float(random.uniform(-170, 170)), float(random.uniform(-60, 65)))
    vertices, heights = _way(random, least_leg_m)
    count = len(vertices)
    ground = np.concatenate([[0.0], np.cumsum(random.normal(0, 4, count - 2)), [0.0]])
    cruise_mps = float(random.uniform(6, 13))
    waypoints = tuple(
        FrozenWaypoint(
            sequence=place,
            position=LonLat(*frame.to_degrees(np.array([vertices[place]]))[0].tolist()),
            kind=WaypointKind.START if place == 0 else WaypointKind.END if place == count - 1 else WaypointKind.TARGET,
            altitude_agl_m=float(heights[place] - ground[place]),
            altitude_relative_m=float(heights[place]),
            altitude_amsl_m=float(heights[place] + 100.0),
            task=Task(TaskKind.HOLD, float(random.integers(5, 40))) if 0 < place < count - 1 and random.random() < 0.5 else None,
            target=place if 0 < place < count - 1 else None,
        )
        for place in range(count)
    )
    flight = Flight(0, TakeOff(waypoints[0].position, 100.0), waypoints, LAND)
    conditions = Conditions((WindLayer(50.0, float(random.uniform(0, 4)), float(random.uniform(0, 359))),))
    max_airspeed_mps = cruise_mps + 6.0
    rules = FlightRules(manoeuvres=MANOEUVRES)
    planned = {"cruise_speed_mps": cruise_mps, "conditions": conditions, "rules": rules}
    performance = Performance(battery_wh=400.0, mass_kg=2.5, max_airspeed_mps=max_airspeed_mps, descent_speed_mps=SINK_MPS)
    energy = energy_plan(flight, performance=performance, **planned)
    assert energy is not None
    # some flights come back with hardly the reserve
    performance = replace(performance, battery_wh=400.0 * energy.until_percent[-1] / float(random.uniform(55, 76)))
    energy = energy_plan(flight, performance=performance, **planned)
    assert energy is not None
    consumption = Consumption(cruise_mps, performance, conditions.wind_at(60.0))
    model = FlightModel(RouteLine(flight), energy, max_airspeed_mps, 20.0, consumption=consumption)
    states = tuple(_fly([tuple(vertex) for vertex in vertices.tolist()], heights.tolist(), waypoints, cruise_mps, model))
    return TrueFlight(flight, model, frame, cruise_mps, conditions, states)


def _way(random: np.random.Generator, least_leg_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Out and back, the last vertex above the first."""
    count = int(random.integers(3, 7))
    heading, here, vertices = random.uniform(0, 2 * math.pi), np.zeros(2), [np.zeros(2)]
    for _ in range(count):
        heading += random.normal(0, 0.7)
        here = here + random.uniform(least_leg_m, least_leg_m + 400) * np.array([math.sin(heading), math.cos(heading)])
        vertices.append(here)
    back = [vertex + random.normal(0, 8, 2) for vertex in reversed(vertices[1:-1])]
    vertices += [*back, np.zeros(2)]
    heights = random.uniform(40, 80, len(vertices))
    heights[-1] = heights[0]
    return np.array(vertices), heights


def _fly(vertices: list, heights: list[float], waypoints: tuple, cruise_mps: float, model: FlightModel) -> Iterator[State]:
    seconds, height, used = 0.0, 0.0, model.energy.used_percent
    holds = [0.0 if waypoint.task is None else waypoint.task.hold_s * model.consumption.percent_per_s(0.0) for waypoint in waypoints]
    while height < heights[0]:
        yield State(seconds, *vertices[0], height, up_mps=CLIMB_MPS, used_percent=used[0] * height / heights[0])
        seconds, height = seconds + 1, height + CLIMB_MPS
    for place in range(1, len(vertices)):
        (e1, n1), (e2, n2) = vertices[place - 1], vertices[place]
        length = math.dist((e1, n1), (e2, n2))
        share, step = 0.0, cruise_mps / length
        rise = heights[place] - heights[place - 1]
        step = min(step, CLIMB_MPS / max(abs(rise), 1e-9))  # it climbs no faster
        while share < 1.0:
            yield State(
                seconds, e1 + share * (e2 - e1), n1 + share * (n2 - n1), heights[place - 1] + share * rise,
                step * (e2 - e1), step * (n2 - n1), step * rise, place,
                used_percent=_between(used[place - 1] + holds[place - 1], used[place], share),
            )  # fmt: skip
            seconds, share = seconds + 1, share + step
        stays_s = math.ceil(waypoints[place].task.hold_s) if waypoints[place].task else 0
        for second in range(stays_s):
            taken = used[place] + holds[place] * second / stays_s
            yield State(seconds, e2, n2, heights[place], vertex=place, holds=True, used_percent=taken)
            seconds += 1
    height, last, landed = heights[-1], len(vertices) - 1, model.energy.until_percent[-1]
    while height > 0.5:
        taken = _between(used[-1], landed, 1.0 - _landing_s(height) / _landing_s(heights[-1]))
        yield State(seconds, *vertices[-1], height, up_mps=-SINK_MPS, vertex=last, holds=True, used_percent=taken)
        seconds, height = seconds + 1, height - (SINK_MPS if height > MANOEUVRES.slow_below_m else MANOEUVRES.landing_mps)
    for _ in range(10):
        yield State(seconds, *vertices[-1], 0.0, vertex=last, holds=True, is_in_air=False, used_percent=landed)
        seconds += 1


def _landing_s(height_m: float) -> float:
    return max(height_m - MANOEUVRES.slow_below_m, 0.0) / SINK_MPS + min(height_m, MANOEUVRES.slow_below_m) / MANOEUVRES.landing_mps


def _between(start: float, end: float, share: float) -> float:
    return start + share * (end - start)


@dataclass
class Instruments:
    """What a UAV's report says of a state; errors as of common receivers, and an autopilot that strays some metres."""

    flight: TrueFlight
    seed: int
    random: np.random.Generator = field(init=False)
    stray: np.ndarray = field(init=False)
    drain: float = field(init=False)

    def __post_init__(self) -> None:
        self.random = np.random.default_rng(self.seed + 1_000_000)
        self.stray = np.zeros(3)
        self.drain = float(self.random.uniform(0.94, 1.02))

    def values(self, state: State) -> dict:
        random = self.random
        self.stray = 0.9 * self.stray + random.normal(0, (0.8, 0.8, 0.3))
        east, north, up = self.stray + random.normal(0, (1.2, 1.2, 0.6)) + (state.east, state.north, state.height_m)
        position = self.flight.position(east, north)
        wind = self.flight.conditions.wind_at(50.0)
        return {
            "longitude_deg": position.lon, "latitude_deg": position.lat, "altitude_relative_m": float(up),
            "altitude_amsl_m": float(up) + 100.0,
            "velocity_north_mps": state.north_mps + random.normal(0, 0.2), "velocity_east_mps": state.east_mps + random.normal(0, 0.2),
            "velocity_down_mps": -state.up_mps + random.normal(0, 0.1),
            "battery_percent": float(max(0, round(100.0 - self.drain * state.used_percent + random.normal(0, 0.3)))),
            "mode": "MISSION", "is_armed": state.is_in_air, "is_in_air": state.is_in_air, "gps_fix": 3,
            "satellites": int(random.integers(10, 18)), "hdop": float(random.uniform(0.6, 1.4)), "waypoint_sequence": state.vertex,
            "wind_north_mps": wind[1] + random.normal(0, 0.5), "wind_east_mps": wind[0] + random.normal(0, 0.5),
        }  # fmt: skip
