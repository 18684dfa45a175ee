"""Flies a single route file: its track, deviation and energy, and whether it can be flown."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat, path_length_m
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import LAND, FrozenRoute, FrozenWaypoint, TakeOff
from mavlink.mission_items import flight_loads
from mavlink.vehicle_plan import MissionItem
from planning.trajectory.waypoints import WaypointKind
from simulation.flight.airframe import Airframe
from simulation.flight.events import ItemReached, ModeChanged, StatusTextSent
from simulation.flight.faults import Weather
from simulation.flight.flown import Ending, FlownFlightLog, fly_mission
from simulation.flight.orders import FlyTo, orders
from simulation.flight.states import FlightMode, Severity
from simulation.flight.uav import SimulatedUav

MAX_WAYPOINTS = 9_000
HEIGHTS_M = (1.0, 5_000.0)
SPEEDS_MPS = (0.2, 50.0)
MAX_LEG_M = 200_000.0  # beyond the range of any battery


class InvalidRoute(ValueError):
    """A route file that cannot be flown; the message names the entry."""


@dataclass(frozen=True)
class RouteFile:
    """A route. Heights are above the ground at the first waypoint."""

    positions: tuple[LonLat, ...]
    altitudes_relative_m: tuple[float, ...]
    speed_mps: float


def read_route(value: Any) -> RouteFile:
    """Parse `{"waypoints": [{"position": [lon, lat], "altitude_relative_m"}], "speed_mps"}`. Raises InvalidRoute."""
    if not isinstance(value, Mapping):
        raise InvalidRoute("The route is not an object with waypoints and speed_mps.")
    waypoints = value.get("waypoints")
    if not isinstance(waypoints, list) or not waypoints:
        raise InvalidRoute("waypoints must be a list with at least one waypoint.")
    if len(waypoints) > MAX_WAYPOINTS:
        raise InvalidRoute(f"waypoints has {len(waypoints):,} entries; at most {MAX_WAYPOINTS:,} are flown.")
    positions, heights = [], []
    for number, waypoint in enumerate(waypoints):
        if not isinstance(waypoint, Mapping):
            raise InvalidRoute(f"waypoints[{number}] is not an object with position and altitude_relative_m.")
        positions.append(_position(waypoint.get("position"), f"waypoints[{number}].position"))
        if number and abs(positions[-1].lon - positions[-2].lon) > 180.0:
            raise InvalidRoute(f"waypoints[{number}] is on the other side of the 180th meridian; routes across it are not flown.")
        heights.append(_number(waypoint.get("altitude_relative_m"), f"waypoints[{number}].altitude_relative_m", *HEIGHTS_M))
        if number and (length_m := path_length_m(np.array(positions[-2:]))) > MAX_LEG_M:
            raise InvalidRoute(
                f"waypoints[{number}] is {length_m / 1000:,.0f} km from the one before; at most {MAX_LEG_M / 1000:.0f} km are flown. "
                "A position is [longitude, latitude]."
            )
    return RouteFile(tuple(positions), tuple(heights), _number(value.get("speed_mps"), "speed_mps", *SPEEDS_MPS))


def items_of(route: RouteFile) -> tuple[MissionItem, ...]:
    """Return take-off below the first waypoint, all waypoints, and landing below the last."""
    waypoints = tuple(
        FrozenWaypoint(number, position, WaypointKind.PASS, height_m, height_m)
        for number, (position, height_m) in enumerate(zip(route.positions, route.altitudes_relative_m, strict=True))
    )
    frozen = FrozenRoute("", TakeOff(route.positions[0], None), route.speed_mps, LAND, waypoints)
    return flight_loads(frozen)[0].mission


def _position(value: Any, place: str) -> LonLat:
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 2:
        raise InvalidRoute(f"{place} must be [longitude, latitude].")
    lon = _number(value[0], f"{place}[0], the longitude,", -180.0, 180.0)
    lat = _number(value[1], f"{place}[1], the latitude,", -85.0, 85.0)
    return LonLat(lon, lat)


def _number(value: Any, place: str, least: float, most: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidRoute(f"{place} must be a number.")
    if not least <= value <= most:  # also for NaN; integers may have hundreds of digits
        raise InvalidRoute(f"{place} must be from {least:g} to {most:g}, not {_shown(value)}.")
    return float(value)


def _shown(value: float) -> str:
    try:
        return f"{value:g}"
    except OverflowError:
        return "a number so large"


FloatArray = NDArray[np.float64]
TRACK_STEPS = 5  # one row of the track every 0.2 s
MAX_BESIDE_M = 5.0
MAX_LANDING_M = 2.0
MIN_RESERVE_PERCENT = 20.0  # the default reserve of plans


def cross_track_m(track: FloatArray, legs: NDArray[np.int64], waypoints: Sequence[LonLat]) -> FloatArray:
    """Return the distance of each track point from its leg, or from the previous or next leg, whichever is nearest [m].

    track (n, 2), lon lat [deg]. legs (n,): number of waypoints passed before, at least 1, so that leg k leads from waypoint k - 1 to
    waypoint k. A leg is the straight line between its waypoints in longitude and latitude, without extension. Returns shape (n,).
    """
    nearest = np.full(len(track), np.inf)
    for leg in np.unique(legs):
        rows = np.flatnonzero(legs == leg)
        for near in (leg - 1, leg, leg + 1):
            if 1 <= near < len(waypoints):
                nearest[rows] = np.minimum(nearest[rows], _beside_m(track[rows], waypoints[near - 1], waypoints[near]))
        if len(waypoints) == 1:
            nearest[rows] = _beside_m(track[rows], waypoints[0], waypoints[0])
    return nearest


def _beside_m(points: FloatArray, start: LonLat, end: LonLat) -> FloatArray:
    frame = LocalFrame.around(*start)
    away = frame.to_metres(points)
    along = frame.to_metres(np.array([end]))[0]
    length2 = float(along @ along)
    share = np.clip(away @ along / length2, 0.0, 1.0) if length2 > 0.0 else np.zeros(len(points))
    off = away - share[:, None] * along
    return np.asarray(np.hypot(off[:, 0], off[:, 1]), dtype=np.float64)


@dataclass(frozen=True)
class RouteFlight:
    """`cross_track_m` (n,) is that of each step between the first and last waypoint."""

    flown: FlownFlightLog
    cross_track_m: np.ndarray[Any, np.dtype[np.float64]]
    reasons: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        beside, end = self.cross_track_m, self.flown.end
        began_s = self.flown.samples[0].at_s if self.flown.samples else 0.0
        return {
            "track": [
                [round(sample.at_s - began_s, 2), sample.lon, sample.lat, sample.altitude_relative_m]
                for sample in self.flown.samples[::TRACK_STEPS]
            ],
            "cross_track_rms_m": float(np.sqrt(np.mean(beside**2))) if len(beside) else None,
            "cross_track_max_m": float(beside.max()) if len(beside) else None,
            "energy_wh": end.battery_used_wh,
            "duration_s": round(end.at_s - began_s, 2),
            "assessment": {"result": "fail" if self.reasons else "pass", "reasons": list(self.reasons)},
        }


def fly_route(
    route: RouteFile, airframe: Airframe, *, weather: Weather, seed: int, battery_percent: float = 100.0, physics_hz: int = 250
) -> RouteFlight:
    """Fly over flat ground, from a take-off below the first waypoint to a landing below the last."""
    items = items_of(route)
    uav = SimulatedUav(airframe, route.positions[0], weather=weather, seed=seed, battery_percent=battery_percent, physics_hz=physics_hz)
    refused = uav.load(items)
    if not refused.is_done:
        raise ValueError(str(refused))
    flown = fly_mission(uav)
    places = [index for index, order in enumerate(orders(items, is_home_first=False)) if isinstance(order, FlyTo)]
    passed_s = {event.index: event.at_s for event in flown.events if isinstance(event, ItemReached)}
    beside = _beside(flown, route, [passed_s[place] for place in places if place in passed_s])
    missed = [number for number, place in enumerate(places) if place not in passed_s]
    return RouteFlight(flown, beside, tuple(_reasons(flown, route, weather, airframe, beside, missed)))


def _beside(flown: FlownFlightLog, route: RouteFile, passed_s: list[float]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return the deviation from the passing of the first waypoint to that of the last, or to the end of an incomplete flight."""
    if not passed_s:
        return np.zeros(0)
    times = np.array([sample.at_s for sample in flown.samples])
    own = [event.at_s for event in flown.events if isinstance(event, ModeChanged) and event.is_own]
    until_s = passed_s[-1] if len(passed_s) == len(route.positions) else min([*own, flown.end.at_s])
    inside = (times >= passed_s[0]) & (times <= max(until_s, passed_s[0]))
    track = np.array([(sample.lon, sample.lat) for sample in flown.samples])[inside]
    legs = np.clip(np.searchsorted(np.array(passed_s), times[inside], side="right"), 1, max(len(route.positions) - 1, 1))
    return cross_track_m(track, legs, route.positions)


def _reasons(
    flown: FlownFlightLog,
    route: RouteFile,
    weather: Weather,
    airframe: Airframe,
    beside: np.ndarray[Any, np.dtype[np.float64]],
    missed: list[int],
) -> list[str]:
    reasons = []
    if flown.refusal is not None:
        reasons.append(f"The UAV did not take off: {flown.refusal.words}")
    if flown.crash is not None:
        reasons.append(f"The UAV crashed after {flown.crash.at_s:.0f} s: {flown.crash.reason}")
    wind_mps, height_m = _strongest_wind(weather, route)
    if wind_mps > airframe.max_airspeed_mps:
        reasons.append(
            f"The wind of {wind_mps:.1f} m/s at {height_m:.0f} m is more than the {airframe.max_airspeed_mps:g} m/s that the UAV flies."
        )
    if missed:
        words = f"waypoint {missed[0] + 1}" if len(missed) == 1 else f"{len(missed)} waypoints, waypoint {missed[0] + 1} the first,"
        reasons.append(f"Not reached: {words} of {len(route.positions)}.")
    own = next(
        (event for event in flown.events if isinstance(event, ModeChanged) and event.is_own and event.mode is not FlightMode.HOLD), None
    )
    if own is not None:
        why = [
            stated.text
            for stated in flown.events
            if isinstance(stated, StatusTextSent) and stated.severity is not Severity.INFO and stated.at_s <= own.at_s
        ]
        reasons.append(f"The UAV gave the mission up after {own.at_s:.0f} s. {why[-1] if why else ''}".strip())
    if flown.ending is Ending.FLYING:
        reasons.append("The flight did not come to an end.")
    if len(beside) and beside.max() > MAX_BESIDE_M:
        reasons.append(f"Up to {beside.max():.1f} m beside the route, limit {MAX_BESIDE_M:g} m.")
    if flown.touched_down_at is not None:
        off_m = _distance_m(flown.touched_down_at, route.positions[-1])
        if off_m > MAX_LANDING_M:
            reasons.append(f"Landed {off_m:.1f} m from the last waypoint, limit {MAX_LANDING_M:g} m.")
    if flown.end.battery_percent < MIN_RESERVE_PERCENT:
        reasons.append(f"{flown.end.battery_percent:.0f} % battery at the end, limit {MIN_RESERVE_PERCENT:g} %.")
    return reasons


def _strongest_wind(weather: Weather, route: RouteFile) -> tuple[float, float]:
    """Return the strongest steady wind at the heights of the waypoints [m/s], and its height above ground [m]."""
    winds = [(float(np.hypot(*weather.conditions.wind_at(height_m))), height_m) for height_m in set(route.altitudes_relative_m)]
    return max(winds)


def _distance_m(one: LonLat, other: LonLat) -> float:
    return path_length_m(np.array([one, other]))
