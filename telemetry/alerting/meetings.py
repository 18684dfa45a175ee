"""Which UAVs in the air come near each other within the next seconds."""

import math
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from telemetry.alerting.memory import position_of
from telemetry.alerting.situation import Situation
from telemetry.alerting.surroundings import Meeting

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

STEP_S = 2.0
MOST_BOUND_M = 10.0  # of each; a UAV that may be anywhere would meet everyone
DEGREE_M = 111_195.0
MOST_MET = 8  # others that each is told of: in a crowd more would say nothing new
SAME_RATE = 0.1  # of clocks: by which what was learnt of two that are the same may differ
NEAR_M, NEAR_HEIGHT_M = 150.0, 60.0  # farther ones are not told: no limit reaches so far beyond


@dataclass(frozen=True, slots=True)
class Moving:
    """A UAV in the air. `ahead` is where it will be each STEP_S, now first, in lon/lat; `height_m` counts from sea level, None: not known.

    Bounds hold 95 of 100 times. UAVs of different `organisation`s are told of each other nothing; nor are those whose clocks run at
    different rates, which are not in the air at the same time: seconds are the UAVs' own.
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


def moving_of(situation: Situation, within_s: float) -> Moving | None:
    """None where it is not in flight, or where nobody knows where it is."""
    uav, place, model = situation.uav, situation.place, situation.model
    estimate, newest = uav.estimate, uav.newest
    position = estimate.position if estimate is not None else None if newest is None else position_of(newest)
    if position is None or newest is None or not situation.is_in_flight:
        return None
    told = newest.measurement
    north_mps, east_mps = told.velocity_north_mps or 0.0, told.velocity_east_mps or 0.0
    speed_mps = math.hypot(north_mps, east_mps)
    degree_east_m = DEGREE_M * math.cos(math.radians(position.lat))
    seconds = [STEP_S * step for step in range(int(within_s / STEP_S) + 2)]
    if place is not None and model is not None and situation.flies_mission and place.across_m <= situation.limits.off_route_m:
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
        ahead=tuple(ahead),
        height_m=told.altitude_amsl_m if estimate is None or estimate.altitude_amsl_m is None else estimate.altitude_amsl_m,
        climb_mps=-(told.velocity_down_mps or 0.0),
        bound_m=0.0 if estimate is None else max(estimate.bound.along_m, estimate.bound.across_m),
        bound_height_m=0.0 if estimate is None else estimate.bound_height_m,
        clock_rate=situation.link.clock_rate,
    )


def meetings(moving: Sequence[Moving], within_s: float) -> dict[int, list[Meeting]]:
    """By the UAV with the smaller key of each pair: how near they come within so many seconds; of a crowd those that come nearest."""
    found: dict[int, list[Meeting]] = defaultdict(list)
    if len(moving) < 2:
        return found
    steps = min(min(len(one.ahead) for one in moving), int(within_s / STEP_S) + 1)
    way = np.array([one.ahead[:steps] for one in moving], dtype=np.float64)
    middle_lat = math.radians(float(way[:, 0, 1].mean()))
    way = way * (DEGREE_M * math.cos(middle_lat), DEGREE_M)
    group = np.array([one.organisation for one in moving])
    ones, others = _pairs(way)
    rate = np.array([one.clock_rate for one in moving])
    near = (group[ones] == group[others]) & (np.abs(rate[ones] - rate[others]) <= SAME_RATE * np.maximum(rate[ones], rate[others]))
    near &= ~(_least_apart_m(moving, within_s, ones, others) > NEAR_HEIGHT_M)  # NaN: not known
    ones, others = ones[near], others[near]
    lateral_m, in_s = _closest(way[ones] - way[others])
    met = Counter[int]()
    for pair in np.argsort(lateral_m, kind="stable").tolist():
        if lateral_m[pair] > NEAR_M:
            break
        first, second = sorted((moving[ones[pair]], moving[others[pair]]), key=lambda uav: uav.uav_id)
        if met[first.uav_id] >= MOST_MET and met[second.uav_id] >= MOST_MET:
            continue
        meeting = _meeting(first, second, float(lateral_m[pair]), float(in_s[pair]))
        if meeting.height_m <= NEAR_HEIGHT_M:
            found[first.uav_id].append(meeting)
            met.update((first.uav_id, second.uav_id))
    return found


def _pairs(way: FloatArray) -> tuple[IntArray, IntArray]:
    """Places of those whose boxes, about all that they fly over, are not farther apart than NEAR_M; way (n, steps, 2) [m]."""
    low, high = way.min(axis=1) - NEAR_M / 2.0, way.max(axis=1) + NEAR_M / 2.0
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    ones, others = shapely.STRtree(boxes).query(boxes)
    once = ones < others
    return ones[once], others[once]


def _least_apart_m(moving: Sequence[Moving], within_s: float, ones: IntArray, others: IntArray) -> FloatArray:
    """In height, of each pair (p,), at any time."""
    height_m = np.array([math.nan if one.height_m is None else one.height_m for one in moving])
    reach_m = within_s * np.abs([one.climb_mps for one in moving])
    apart_m: FloatArray = np.abs(height_m[ones] - height_m[others]) - reach_m[ones] - reach_m[others]
    return apart_m


def _closest(between: FloatArray) -> tuple[FloatArray, FloatArray]:
    """How near (p,) [m], and in how many seconds; between (p, steps, 2) [m] leads from the one to the other at each step."""
    here, on = between[:, :-1], np.diff(between, axis=1)
    square = (on * on).sum(axis=2)
    share = np.clip(-(here * on).sum(axis=2) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    metres = np.hypot(*(here + share[:, :, None] * on).transpose(2, 0, 1))
    step = metres.argmin(axis=1)
    rows = np.arange(len(between))
    return metres[rows, step], (step + share[rows, step]) * STEP_S


def _meeting(first: Moving, second: Moving, lateral_m: float, in_s: float) -> Meeting:
    height_m = _height_between_m(first, second, in_s)
    bound_m = math.hypot(min(first.bound_m, MOST_BOUND_M), min(second.bound_m, MOST_BOUND_M))
    bound_height_m = math.hypot(min(first.bound_height_m, MOST_BOUND_M), min(second.bound_height_m, MOST_BOUND_M))
    return Meeting(
        other_id=second.uav_id,
        other_name=second.name,
        in_s=in_s,
        lateral_m=lateral_m,
        height_m=height_m,
        least_lateral_m=max(0.0, lateral_m - bound_m),
        least_height_m=max(0.0, height_m - bound_height_m),
    )


def _height_between_m(first: Moving, second: Moving, at_s: float) -> float:
    """Heights that are not known count as the same. Who climbs or sinks passes all heights on its way."""
    if first.height_m is None or second.height_m is None:
        return 0.0
    now_m = first.height_m - second.height_m
    then_m = now_m + (first.climb_mps - second.climb_mps) * at_s
    return 0.0 if now_m * then_m < 0.0 else min(abs(now_m), abs(then_m))


def elsewhere(uav_id: int, name: str, organisation: int, estimated: dict[str, Any], within_s: float, clock_rate: float = 1.0) -> Moving:
    """One that another watch estimates, as estimation/as_json.py writes it: straight on."""
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
    )
