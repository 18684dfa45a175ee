"""Finds UAVs in the air that come near each other within the next seconds."""

import math
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.detector_state import position_of
from telemetry.alerting.surroundings import Conflict

STANDS_BELOW_MPS = 1.0
CLIMBS_ABOVE_MPS = 0.7
SAME_COURSE_DEG, HEAD_ON_DEG = 60.0, 150.0
HIGHER_M = 2.0
FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
STEP_S = 2.0
MAX_BOUND_M = 10.0  # of each UAV; a wider bound would conflict with every UAV
DEGREE_M = 111_195.0
MAX_MET = 8  # conflicts reported per UAV: in a crowd, more would not help
SAME_RATE = 0.1  # relative difference up to which two estimated clock rates count as equal
FAR_M, FAR_HEIGHT_M = 15.0, 8.0  # scales that weigh horizontal against vertical distance
MIN_CLIMB_MPS = 1.0  # from the ground; a faster climb is extrapolated
NEAR_M, NEAR_HEIGHT_M = 150.0, 60.0  # greater distances are not reported: no limit reaches that far


class Why(StrEnum):
    CLIMBS = "it climbs towards the other one"
    OTHER_STANDS = "the other one stands still"
    BEHIND = "it is behind"
    HIGHER = "it is higher"
    ON_ITS_RIGHT = "it has the other one on its right"
    EITHER = "either can be held"


class Flying(NamedTuple):
    """Position (east, north) [m], height [m], NaN if unknown, and velocity [m/s]."""

    east_m: float
    north_m: float
    height_m: float
    east_mps: float
    north_mps: float
    climb_mps: float

    @property
    def speed_mps(self) -> float:
        return math.hypot(self.east_mps, self.north_mps)


def yielding(first: Flying, second: Flying) -> tuple[bool, Why]:
    """Return whether the first UAV gives way, and why."""
    first_stands, second_stands = first.speed_mps < STANDS_BELOW_MPS, second.speed_mps < STANDS_BELOW_MPS
    for is_first, one, stands in ((True, first, first_stands), (False, second, second_stands)):
        if stands and one.climb_mps > CLIMBS_ABOVE_MPS:
            return is_first, Why.CLIMBS
    if first_stands != second_stands:
        return second_stands, Why.OTHER_STANDS
    if first_stands:
        return _higher(first, second)
    turn_deg = _angle_deg((first.east_mps, first.north_mps), (second.east_mps, second.north_mps))
    bearing_deg = _angle_deg((first.east_mps, first.north_mps), (second.east_m - first.east_m, second.north_m - first.north_m))
    if abs(turn_deg) < SAME_COURSE_DEG:
        return abs(bearing_deg) < 90.0, Why.BEHIND
    if abs(turn_deg) > HEAD_ON_DEG:
        return _higher(first, second)
    return bearing_deg > 0.0, Why.ON_ITS_RIGHT


def _higher(first: Flying, second: Flying) -> tuple[bool, Why]:
    above_m = first.height_m - second.height_m
    if math.isnan(above_m) or abs(above_m) < HIGHER_M:
        return False, Why.EITHER
    return above_m > 0.0, Why.HIGHER


def _angle_deg(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Return the clockwise angle from one direction to another, -180 to 180."""
    turned = math.degrees(math.atan2(*other) - math.atan2(*one))
    return (turned + 180.0) % 360.0 - 180.0


@dataclass(frozen=True, slots=True)
class Moving:
    """A UAV in the air on one of its possible paths.

    `ahead` is its position at each STEP_S, in lon/lat, beginning now. `height_m` is AMSL, None: unknown. `heights_m` gives it for each step
    where a constant `climb_mps` does not apply. Bounds hold with 95 %.

    UAVs of different `organisation`s are not compared. Neither are simulated twins with other UAVs, nor UAVs whose clocks run at different
    rates, which do not fly at the same time: seconds are the UAVs' own.
    """

    uav_id: int
    name: str
    organisation: int
    ahead: tuple[tuple[float, float], ...]
    height_m: float | None
    climb_mps: float
    bound_m: float
    bound_height_m: float
    clock_rate: float = 1.0
    heights_m: tuple[float, ...] | None = None
    velocity_mps: tuple[float, float] = (0.0, 0.0)  # to east and north
    here: tuple[float, float] | None = None  # lon/lat now, if `ahead` begins elsewhere
    is_twin: bool = False

    def heights_at(self, steps: int) -> FloatArray:
        """Return the height at each of the first steps (steps,); NaN: unknown."""
        if self.height_m is None:
            return np.full(steps, math.nan)
        if self.heights_m is not None:
            return np.array(self.heights_m[:steps], dtype=np.float64)
        return np.asarray(self.height_m + self.climb_mps * STEP_S * np.arange(steps), dtype=np.float64)


def ways_of(inputs: DetectorInput, within_s: float) -> list[Moving]:
    """Return the possible paths of a UAV in flight: by its velocity, and along its approved route with the climb from the ground."""
    moving = moving_of(inputs, within_s)
    if moving is None:
        return []
    planned = _as_planned(inputs, moving)
    return [moving] if planned is None else [moving, planned]


def _as_planned(inputs: DetectorInput, moving: Moving) -> Moving | None:
    place, model, newest = inputs.place, inputs.model, inputs.uav.newest
    if place is None or model is None or newest is None or not inputs.flies_mission or place.across_m > inputs.limits.off_route_m:
        return None
    reported, line = newest.measurement, model.line
    if reported.altitude_relative_m is None or moving.height_m is None:
        return None
    seconds = [STEP_S * step for step in range(len(moving.ahead))]
    points = line.planned_ahead(place, reported.altitude_relative_m, max(moving.climb_mps, MIN_CLIMB_MPS), seconds)
    if points is None:
        return None
    origin = line.frame.origin
    return replace(
        moving,
        here=moving.ahead[0],
        ahead=tuple(
            (origin.lon + east / line.frame.metres_per_degree_east, origin.lat + north / line.frame.metres_per_degree_north)
            for east, north, _ in points
        ),
        heights_m=tuple(moving.height_m + height_m - reported.altitude_relative_m for _, _, height_m in points),
    )


def moving_of(inputs: DetectorInput, within_s: float) -> Moving | None:
    """Return the path by its velocity; None if it is not in flight or its position is unknown."""
    uav, place, model = inputs.uav, inputs.place, inputs.model
    estimate, newest = uav.estimate, uav.newest
    position = estimate.position if estimate is not None else None if newest is None else position_of(newest)
    if position is None or newest is None or not inputs.is_in_flight:
        return None
    reported = newest.measurement
    north_mps, east_mps = reported.velocity_north_mps or 0.0, reported.velocity_east_mps or 0.0
    speed_mps = math.hypot(north_mps, east_mps)
    degree_east_m = DEGREE_M * math.cos(math.radians(position.lat))
    seconds = [STEP_S * step for step in range(int(within_s / STEP_S) + 2)]
    if place is not None and model is not None and inputs.flies_mission and place.across_m <= inputs.limits.off_route_m:
        line = model.line
        here = line.at(place.along_m)
        ways = [line.at(place.along_m + speed_mps * after_s) for after_s in seconds]
        ahead = [(position.lon + (east - here[0]) / degree_east_m, position.lat + (north - here[1]) / DEGREE_M) for east, north in ways]
    else:
        ahead = [(position.lon + east_mps * after_s / degree_east_m, position.lat + north_mps * after_s / DEGREE_M) for after_s in seconds]
    return Moving(
        uav_id=uav.uav_id,
        name=uav.name,
        organisation=uav.organisation_id,
        is_twin=uav.is_twin,
        ahead=tuple(ahead),
        height_m=reported.altitude_amsl_m if estimate is None or estimate.altitude_amsl_m is None else estimate.altitude_amsl_m,
        climb_mps=-(reported.velocity_down_mps or 0.0),
        bound_m=0.0 if estimate is None else max(estimate.bound.along_m, estimate.bound.across_m),
        bound_height_m=0.0 if estimate is None else estimate.bound_height_m,
        clock_rate=inputs.link.clock_rate,
        velocity_mps=(east_mps, north_mps),
    )


def conflicts(moving: Sequence[Moving], within_s: float) -> dict[int, list[Conflict]]:
    """Return the conflicts within a time, by the UAV with the smaller key of each pair. In a crowd only the nearest are kept.

    A pair has one conflict for each two of their paths that come near, the nearest first.
    """
    found: dict[int, list[Conflict]] = defaultdict(list)
    if len(moving) < 2:
        return found
    steps = min(min(len(one.ahead) for one in moving), int(within_s / STEP_S) + 1)
    way = np.array([one.ahead[:steps] for one in moving], dtype=np.float64)
    middle_lat = math.radians(float(way[:, 0, 1].mean()))
    way = way * (DEGREE_M * math.cos(middle_lat), DEGREE_M)
    group = np.array([one.organisation for one in moving])
    heights = np.array([one.heights_at(steps) for one in moving])
    ones, others = _pairs(way)
    rate, key = np.array([one.clock_rate for one in moving]), np.array([one.uav_id for one in moving])
    near = (group[ones] == group[others]) & (np.abs(rate[ones] - rate[others]) <= SAME_RATE * np.maximum(rate[ones], rate[others]))
    twin = np.array([one.is_twin for one in moving])
    near &= (key[ones] != key[others]) & (twin[ones] == twin[others])
    near &= ~(_least_apart_m(heights, ones, others) > NEAR_HEIGHT_M)  # NaN: unknown
    ones, others = ones[near], others[near]
    lateral_m, height_m, in_s = _closest(way[ones] - way[others], heights[ones] - heights[others])
    met = Counter[int]()
    reported: set[tuple[int, int]] = set()
    for pair in np.lexsort((in_s, np.maximum(lateral_m / FAR_M, height_m / FAR_HEIGHT_M))).tolist():
        if lateral_m[pair] > NEAR_M or height_m[pair] > NEAR_HEIGHT_M:
            continue
        first, second = sorted((moving[ones[pair]], moving[others[pair]]), key=lambda uav: uav.uav_id)
        is_new = (first.uav_id, second.uav_id) not in reported
        if is_new and met[first.uav_id] >= MAX_MET and met[second.uav_id] >= MAX_MET:
            continue
        found[first.uav_id].append(_conflict(first, second, float(lateral_m[pair]), float(height_m[pair]), float(in_s[pair])))
        if is_new:
            reported.add((first.uav_id, second.uav_id))
            met.update((first.uav_id, second.uav_id))
    return found


def _pairs(way: FloatArray) -> tuple[IntArray, IntArray]:
    """Return index pairs whose paths' bounding boxes are within NEAR_M; way (n, steps, 2) [m]."""
    low, high = way.min(axis=1) - NEAR_M / 2.0, way.max(axis=1) + NEAR_M / 2.0
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    ones, others = shapely.STRtree(boxes).query(boxes)
    once = ones < others
    return ones[once], others[once]


def _least_apart_m(heights: FloatArray, ones: IntArray, others: IntArray) -> FloatArray:
    """Return the smallest vertical distance of each pair (p,) at any time; heights (n, steps)."""
    low, high = heights.min(axis=1), heights.max(axis=1)
    apart_m: FloatArray = np.maximum(low[ones] - high[others], low[others] - high[ones])
    return apart_m


def _closest(between: FloatArray, above: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return horizontal and vertical distance (p,) [m] at the closest approach, and the seconds until then.

    between (p, steps, 2) and above (p, steps) [m] lead from one UAV to the other at each step. Unknown heights count as equal. A UAV that
    climbs or descends past the other within a step counts as at its height.
    """
    here, on = between[:, :-1], np.diff(between, axis=1)
    square = (on * on).sum(axis=2)
    share = np.clip(-(here * on).sum(axis=2) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    metres = np.hypot(*(here + share[:, :, None] * on).transpose(2, 0, 1))
    before, after = above[:, :-1], above[:, 1:]
    height = np.where(before * after < 0.0, 0.0, np.minimum(np.abs(before), np.abs(after)))
    height = np.where(np.isnan(height), 0.0, height)
    step = np.maximum(metres / FAR_M, height / FAR_HEIGHT_M).argmin(axis=1)
    rows = np.arange(len(between))
    return metres[rows, step], height[rows, step], (step + share[rows, step]) * STEP_S


def _conflict(first: Moving, second: Moving, lateral_m: float, height_m: float, in_s: float) -> Conflict:
    bound_m = math.hypot(min(first.bound_m, MAX_BOUND_M), min(second.bound_m, MAX_BOUND_M))
    bound_height_m = math.hypot(min(first.bound_height_m, MAX_BOUND_M), min(second.bound_height_m, MAX_BOUND_M))
    origin = first.here or first.ahead[0]
    one, other = _flying(first, origin), _flying(second, origin)
    east_m, north_m = other.east_m - one.east_m, other.north_m - one.north_m
    apart_m = math.hypot(east_m, north_m)
    opening = east_m * (other.east_mps - one.east_mps) + north_m * (other.north_mps - one.north_mps)
    is_first, why = yielding(one, other)
    yields = first if is_first else second
    return Conflict(
        other_id=second.uav_id,
        other_name=second.name,
        in_s=in_s,
        lateral_m=lateral_m,
        height_m=height_m,
        least_lateral_m=max(0.0, lateral_m - bound_m),
        least_height_m=max(0.0, height_m - bound_height_m),
        now_lateral_m=apart_m,
        now_height_m=None if first.height_m is None or second.height_m is None else abs(first.height_m - second.height_m),
        closing_mps=-opening / apart_m if apart_m > 0.0 else 0.0,
        bound_m=math.hypot(first.bound_m, second.bound_m),
        yields_id=yields.uav_id,
        yields_name=yields.name,
        why=why,
    )


def _flying(uav: Moving, origin: tuple[float, float]) -> Flying:
    """Return position and velocity in metres from an origin (lon, lat)."""
    lon, lat = uav.here or uav.ahead[0]
    east_m = (lon - origin[0]) * DEGREE_M * math.cos(math.radians(origin[1]))
    height_m = math.nan if uav.height_m is None else uav.height_m
    return Flying(east_m, (lat - origin[1]) * DEGREE_M, height_m, *uav.velocity_mps, uav.climb_mps)


def elsewhere(
    uav_id: int, name: str, organisation: int, estimated: dict[str, Any], within_s: float, clock_rate: float = 1.0, *, is_twin: bool = False
) -> Moving:
    """Return a UAV that another estimator process estimates, in the form of services/watches.py, extrapolated straight on."""
    lon, lat = estimated["position"]
    heading_rad, speed_mps = math.radians(estimated["heading_deg"] or 0.0), estimated["speed_mps"]
    degree_east_m = DEGREE_M * math.cos(math.radians(lat))
    seconds = [STEP_S * step for step in range(int(within_s / STEP_S) + 2)]
    east, north = speed_mps * math.sin(heading_rad) / degree_east_m, speed_mps * math.cos(heading_rad) / DEGREE_M
    return Moving(
        uav_id=uav_id,
        name=name,
        organisation=organisation,
        ahead=tuple((lon + east * after_s, lat + north * after_s) for after_s in seconds),
        height_m=estimated["altitude_amsl_m"],
        climb_mps=0.0,
        bound_m=max(estimated["bound"]["along_m"], estimated["bound"]["across_m"]),
        bound_height_m=estimated["bound"]["height_m"],
        clock_rate=clock_rate,
        velocity_mps=(speed_mps * math.sin(heading_rad), speed_mps * math.cos(heading_rad)),
        is_twin=is_twin,
    )
