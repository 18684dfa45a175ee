"""Routes by the plan's clock and battery, and the same routes flown in simulation: for tests and benchmarks of the energy model."""

from dataclasses import dataclass

import numpy as np

from missions.flight_plan.conditions import Conditions
from missions.flight_plan.performance import IRIS_BATTERY_WH, IRIS_MAX_AIRSPEED_MPS, Performance
from missions.flight_plan.rules import FlightRules
from missions.flight_plan.timing import Timing, timing
from missions.flight_plan.waypoints import RoutePoint, RoutePoints, Waypoints
from missions.mavlink.frozen import HOVER, FrozenRoute
from missions.mavlink.items import flight_loads
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.flown import Ending, fly_mission
from simulation.flight.states import Mode
from simulation.flight.uav import SimulatedUav
from simulation.flight.weather import Weather

# The figures of the model files in simulation/aircraft_models, as a type of UAV has them. Speeds up and down are the rows' own.
PERFORMANCES = {
    "iris": Performance(
        battery_wh=IRIS_BATTERY_WH, max_airspeed_mps=IRIS_MAX_AIRSPEED_MPS,
        climb_speed_mps=AIRFRAMES["iris"].climb_mps, descent_speed_mps=AIRFRAMES["iris"].descent_mps,
    ),
    "inspector": Performance(
        battery_wh=263.2, mass_kg=3.77, max_airspeed_mps=19.0, rotor_disk_m2=4 * 0.1297, efficiency=0.498, avionics_w=30.0,
        drag_area_m2=0.032, rotor_drag=4 * 3.6e-4 * 400.0 / (3.77 * 9.80665),
        climb_speed_mps=AIRFRAMES["inspector"].climb_mps, descent_speed_mps=AIRFRAMES["inspector"].descent_mps,
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


def compared(route: FrozenRoute, code: str, weather: Weather, seed: int) -> Compared:
    """The plan knows the mean wind. Raises AssertionError where the flight does not end as it should."""
    planned = planned_timing(route, code, weather.conditions)
    uav = SimulatedUav(AIRFRAMES[code], route.take_off.position, weather=weather, seed=seed)
    assert uav.load(flight_loads(route)[0].mission).is_done
    flown = fly_mission(uav, sample_steps=25)
    assert flown.ending in {Ending.LANDED, Ending.HOVERING}, flown.ending
    assert all(getattr(event, "mode", Mode.MISSION) in {Mode.MISSION, Mode.HOLD} for event in flown.events), "it returned by itself"
    began_s = flown.samples[0].at_s
    return Compared(planned.total_s, planned.total_wh or 0.0, flown.end.at_s - began_s, flown.end.battery_used_wh)
