"""Routes by the plan's clock and battery, and the same routes flown in simulation: for tests and benchmarks of the energy model."""

import random
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import HOVER, LAND, FrozenRoute, FrozenWaypoint, TakeOff
from mavlink.mission_items import flight_loads
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.performance import IRIS_BATTERY_WH, IRIS_MAX_AIRSPEED_MPS, Performance
from planning.rules import FlightRules
from planning.task import Task, TaskKind
from planning.trajectory.timing import Timing, timing
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.faults import Weather
from simulation.flight.flown import Ending, fly_mission
from simulation.flight.states import FlightMode
from simulation.flight.uav import SimulatedUav
from tests.telemetry.estimation.routes import drawn_route, route_on_line

HOME = LonLat(9.0, 47.0)
FRAME = LocalFrame.around(*HOME)
CALM, WINDY, ROUGH = "calm", "wind", "wind, gusts of 1.5 m/s and turbulence"

# The figures of the model files in simulation/aircraft_models. Speeds up and down are left to the rules, as types of UAVs leave them.
PERFORMANCES = {
    "iris": Performance(battery_wh=IRIS_BATTERY_WH, max_airspeed_mps=IRIS_MAX_AIRSPEED_MPS),
    "inspector": Performance(
        battery_wh=263.2, mass_kg=3.77, max_airspeed_mps=19.0, rotor_disk_m2=4 * 0.1297, efficiency=0.498, avionics_w=30.0,
        drag_area_m2=0.032, rotor_drag=4 * 3.6e-4 * 400.0 / (3.77 * 9.80665),
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Compared:
    """A flight as planned and as flown: seconds from leaving the ground to touching it, and watt-hours."""

    planned_s: float
    planned_wh: float
    flown_s: float
    flown_wh: float

    @property
    def time_ratio(self) -> float:
        return self.planned_s / self.flown_s

    @property
    def energy_ratio(self) -> float:
        return self.planned_wh / self.flown_wh


def usable_wh(code: str) -> float:
    return PERFORMANCES[code].usable_wh or 0.0


def planned_timing(route: FrozenRoute, code: str, conditions: Conditions, rules: FlightRules | None = None) -> Timing:
    """Of the route's first flight, over flat ground at sea level."""
    flight = route.flights[0]
    points = RoutePoints.of(
        [
            RoutePoint(waypoint.position, waypoint.kind, waypoint.altitude_agl_m, None, waypoint.target, waypoint.task, waypoint.speed_mps)
            for waypoint in flight.waypoints
        ]
    )
    heights_m = np.array([waypoint.altitude_relative_m for waypoint in flight.waypoints], dtype=np.float64)
    return timing(
        Waypoints(points, heights_m, heights_m),
        cruise_speed_mps=route.cruise_speed_mps,
        performance=PERFORMANCES[code],
        conditions=conditions,
        lands=flight.end_action != HOVER,
        rules=rules or FlightRules(),
    )


def compared(route: FrozenRoute, code: str, weather: Weather, seed: int, *, physics_hz: int = 250) -> Compared:
    """The plan knows the mean wind. Raises AssertionError where the flight does not end as it should."""
    planned = planned_timing(route, code, weather.conditions)
    uav = SimulatedUav(AIRFRAMES[code], route.take_off.position, weather=weather, seed=seed, physics_hz=physics_hz)
    assert uav.load(flight_loads(route)[0].mission).is_done
    flown = fly_mission(uav, sample_steps=25)
    assert flown.ending in {Ending.LANDED, Ending.HOVERING}, flown.ending
    assert all(getattr(event, "mode", FlightMode.MISSION) in {FlightMode.MISSION, FlightMode.HOLD} for event in flown.events), (
        "it returned by itself"
    )
    began_s = flown.samples[0].at_s
    return Compared(planned.total_s, planned.total_wh or 0.0, flown.end.at_s - began_s, flown.end.battery_used_wh)


def made_route(stops: Sequence[tuple[float, float, float, float]], speed_mps: float) -> FrozenRoute:
    """Stops are metres to east and north of the take-off, metres above it, and seconds held. It lands under the last."""
    degrees = FRAME.to_degrees(np.array([stop[:2] for stop in stops], dtype=np.float64)).tolist()
    waypoints = tuple(
        FrozenWaypoint(
            number, LonLat(*position), WaypointKind.PASS, stop[2], stop[2], None, Task(TaskKind.HOLD, stop[3]) if stop[3] else None
        )
        for number, (position, stop) in enumerate(zip(degrees, stops, strict=True))
    )
    return FrozenRoute("Tern", TakeOff(HOME, None), speed_mps, LAND, waypoints)


def square(side_m: float, speed_mps: float) -> FrozenRoute:
    corners = [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]
    return made_route([(side_m * east, side_m * north, 30.0, 0.0) for east, north in corners], speed_mps)


def zigzag(legs: int, leg_m: float, speed_mps: float) -> FrozenRoute:
    """To the north and to the east by turns, with a right angle after each leg."""
    return made_route([(leg_m * (number // 2), leg_m * ((number + 1) // 2), 40.0, 0.0) for number in range(legs + 1)], speed_mps)


def climbs(times: int, speed_mps: float) -> FrozenRoute:
    """Each time 60 m up and down again, and 60 m on."""
    heights = [30.0, *([90.0, 90.0, 30.0, 30.0] * times)]
    return made_route([(60.0 * (number // 2), 0.0, height_m, 0.0) for number, height_m in enumerate(heights)], speed_mps)


def holds(times: int, speed_mps: float) -> FrozenRoute:
    """Each time 100 m on, and 20 s there."""
    return made_route([(100.0 * number, 0.0, 40.0, 20.0 if number else 0.0) for number in range(times + 1)], speed_mps)


def mission(seed: int, lines: Sequence[Sequence[LonLat]] = ()) -> tuple[FrozenRoute, str]:
    """Past towers and back, with things to do at some; an airframe whose battery lasts for it. With lines along a stretch of one."""
    code = "iris" if seed % 2 else "inspector"
    while True:
        speeds_mps = {"iris": (4.0, 5.0, 6.0, 8.0), "inspector": (8.0, 10.0, 12.0, 14.0)}[code]
        route = route_on_line(seed, lines, speeds_mps) if lines else drawn_route(seed, speeds_mps)
        if code == "inspector" or (planned_timing(route, code, Conditions()).total_wh or 0.0) < usable_wh(code):
            return route, code
        code = "inspector"


def air_of(seed: int, code: str, kind: str) -> Weather:
    """Calm, an even wind, or one with gusts and turbulence on it."""
    chance = random.Random(f"air {seed}")
    wind = WindLayer(60.0, chance.uniform(2.0, 0.5 * AIRFRAMES[code].max_airspeed_mps), chance.uniform(0.0, 359.0))
    if kind == CALM:
        return Weather()
    rough = kind == ROUGH
    return Weather(Conditions((wind,)), 1.5 if rough else 0.0, turbulence_mps_at_20ft=wind.speed_mps if rough else 0.0)
