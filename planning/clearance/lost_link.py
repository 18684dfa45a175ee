"""What a UAV does when it hears nothing any more, and from where that would go wrong."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat, distance_m
from inspection.geodesy.local_frame import LocalFrame
from planning.clearance.surroundings import SAMPLE_SPACING_M, Surroundings
from planning.clearance.zone_clearance import TAKE_OFF, FlownRoute, breaches
from planning.energy.conditions import Conditions, air_density
from planning.energy.leg_cost import J_PER_WH, Air, hold_taken, landing_taken, leg_taken
from planning.energy.path_cost import FlightClass
from planning.energy.performance import Performance
from planning.rules import FlightRules
from planning.trajectory.heights import GroundHeights
from planning.trajectory.spans_below import tops_below
from planning.trajectory.timing import Timing
from planning.trajectory.waypoints import BASE, Waypoints

FloatArray = NDArray[np.float64]

HEIGHT_ROUNDING_M = 1e-6


class LostLink(StrEnum):
    GO_ON = "go_on"  # the route is flown to its end, as it was checked
    HOLD = "hold"  # it stays for a while where it is, and then returns
    RETURN = "return"


class ReturnTrouble(StrEnum):
    BATTERY = "battery"
    WIND = "wind"
    ZONE = "zone"
    TOO_HIGH = "too_high"  # what clears the ground is above the greatest height somewhere on the way
    OBSTACLE = "obstacle"  # what clears a mast, wires or a bridge is, and would not be without them
    UNKNOWN_GROUND = "unknown_ground"


@dataclass(frozen=True)
class LostLinkPlan:
    """What is done, and where a UAV may return to beside its start: it takes what is nearest."""

    behaviour: LostLink
    rally_points: tuple[LonLat, ...] = ()
    hold_s: float = 0.0  # before it returns; only with HOLD
    home: LonLat | None = None  # of a route that begins in the air: where its UAV took off, which is its start then


@dataclass(frozen=True)
class FailedReturn:
    """A waypoint from which the return is no way home.

    return_point: 0 for the start, n for the n-th rally point; missing_wh with BATTERY, zone (a row of the zones) with ZONE, over_m, by how
    much it is too high, with TOO_HIGH and OBSTACLE.
    """

    waypoint: int
    return_point: int
    trouble: ReturnTrouble
    missing_wh: float | None = None
    zone: int | None = None
    over_m: float | None = None


@dataclass(frozen=True)
class Returns:
    """What the check of a route finds. highest_m: at which height above its start a UAV returns where it returns highest.

    Ways that are too high do not count. None where none is left, where it does not return, or where the ground is not known.
    """

    failed: list[FailedReturn]
    highest_m: float | None


@dataclass(frozen=True, eq=False)
class _Return:
    """One straight way: samples of the ground under it (m,), from the waypoint to the return point, 0 where flat ground is assumed.

    is_known: whether these count from the sea.
    """

    waypoint: int
    return_point: int
    length_m: float
    east: float
    north: float
    line: FloatArray  # (m, 2)
    ground_m: FloatArray
    is_known: bool


def checked_returns(
    waypoints: Waypoints,
    clock: Timing,
    plan: LostLinkPlan,
    *,
    flying: FlightClass,
    conditions: Conditions,
    rules: FlightRules,
    around: Surroundings,
    departs_s: float | None = None,
) -> Returns:
    """Every waypoint from which holding and returning would not go well, and each reason for it, in the order of the route.

    The UAV climbs where it is, flies straight to the nearest of its start and the rally points at one height above the sea, and lands
    there. That height clears the ground by transit_agl_m and what stands or hangs beside the way by clearance_m, and is not lower than
    where it is; it must not be above max_agl_m anywhere. The battery has to do with its reserve left, after what is done at the waypoint.
    Without heights of the ground flat ground is assumed, as the route then does. departs_s: when the route begins, in seconds since the
    epoch; without it zones count at any time, as the facts say. Between waypoints it is not looked; they are no farther apart than
    longest_leg_m.
    """
    if plan.behaviour is LostLink.GO_ON or not len(waypoints):
        return Returns([], None)
    hold_s = plan.hold_s if plan.behaviour is LostLink.HOLD else 0.0
    performance = flying.performance
    air = Air.of(performance, flying.cruise_speed_mps, conditions, rules)
    taken_wh = _taken_wh(clock, performance)
    begin = LonLat(*waypoints.points.position[0].tolist()) if plan.home is None else plan.home
    returns = _returns(waypoints, begin, plan.rally_points, around.ground_heights_m)
    starts, ends = (np.stack([one.line[side] for one in returns]) for side in (0, -1))
    known = around.ground_heights_m if returns[0].is_known else None
    tops_m = tops_below(starts, ends, around.spans, known, rules.transit_agl_m - rules.clearance_m)
    failed = []
    levels_m = []
    for one, top_m in zip(returns, tops_m.tolist(), strict=True):
        if waypoints.points.kind[one.waypoint] == BASE:  # it stands there, with a new battery
            continue
        if np.isnan(one.ground_m).any() or top_m == math.inf:
            failed.append(FailedReturn(one.waypoint, one.return_point, ReturnTrouble.UNKNOWN_GROUND))
            continue
        over_ground_m = max(_amsl_m(one, waypoints), float(one.ground_m.max()) + rules.transit_agl_m)
        level_m = max(over_ground_m, top_m + rules.clearance_m)
        most_m = float(one.ground_m.min()) + rules.max_agl_m + HEIGHT_ROUNDING_M
        if level_m > most_m:
            trouble = ReturnTrouble.TOO_HIGH if over_ground_m > most_m else ReturnTrouble.OBSTACLE
            failed.append(FailedReturn(one.waypoint, one.return_point, trouble, over_m=level_m - most_m + HEIGHT_ROUNDING_M))
        else:
            levels_m.append(level_m)
        taken = _taken(one, waypoints, level_m, hold_s, air)
        if math.isinf(taken[-1][0]):
            failed.append(FailedReturn(one.waypoint, one.return_point, ReturnTrouble.WIND))
        elif performance.usable_wh is not None and taken_wh is not None:
            missing_wh = float(taken_wh[one.waypoint]) + taken[-1][1] / J_PER_WH - performance.usable_wh
            if missing_wh > 0.0:
                failed.append(FailedReturn(one.waypoint, one.return_point, ReturnTrouble.BATTERY, missing_wh=missing_wh))
        start_s = None if departs_s is None else departs_s + float(clock.arrival_s[one.waypoint])
        flown = _flown(one, waypoints, level_m, start_s, [seconds for seconds, _ in taken])
        met = dict.fromkeys(breach.zone for breach in breaches(flown, around.zones, around.margins) if breach.leg != TAKE_OFF)
        failed += [FailedReturn(one.waypoint, one.return_point, ReturnTrouble.ZONE, zone=zone) for zone in met]
    # The first waypoint stands over the start; from home the ground is told by what is above sea level less what is above home.
    stands_m = float(returns[0].ground_m[0]) if plan.home is None else _home_m(waypoints)
    highest_m = max(levels_m, default=math.nan) - stands_m
    return Returns(failed, None if math.isnan(highest_m) else highest_m)


def _home_m(waypoints: Waypoints) -> float:
    """Of the ground from which relative heights count, over the ground that returns know."""
    return 0.0 if waypoints.amsl_m is None else float(waypoints.amsl_m[0] - waypoints.relative_m[0])


def _taken_wh(clock: Timing, performance: Performance) -> FloatArray | None:
    """Out of the battery at each waypoint (n,), less what it was charged with on the way; None where that is not known."""
    if performance.battery_wh is None or clock.battery_left_percent is None:
        return clock.used_wh
    taken_wh: FloatArray = performance.battery_wh * (1.0 - clock.battery_left_percent / 100.0)
    return taken_wh


def _returns(waypoints: Waypoints, home: LonLat, rally_points: Sequence[LonLat], ground_heights_m: GroundHeights | None) -> list[_Return]:
    """From each waypoint the way to the nearest return point; of two that are as near, to the first."""
    position = waypoints.points.position
    return_points = np.array([home, *rally_points], dtype=np.float64).reshape(-1, 2)
    metres = np.stack([distance_m(position, np.broadcast_to(return_point, position.shape)) for return_point in return_points])
    nearest = metres.argmin(axis=0)
    lines = []
    for place, return_point in zip(position, return_points[nearest], strict=True):
        count = max(1, math.ceil(float(distance_m(place, return_point)[0]) / SAMPLE_SPACING_M))
        lines.append(place + np.linspace(0.0, 1.0, count + 1)[:, None] * (return_point - place))
    # Where the route knows no height above the sea, its heights above ground are all there is.
    known = None if waypoints.amsl_m is None else ground_heights_m
    samples = np.concatenate(lines)
    ground_m = np.zeros(len(samples)) if known is None else known(samples)
    ends = np.cumsum([len(line) for line in lines])
    found = []
    for waypoint, (line, under_m) in enumerate(zip(lines, np.split(ground_m, ends[:-1]), strict=True)):
        return_point = int(nearest[waypoint])
        frame = LocalFrame.around(*line[0].tolist())
        east, north = frame.to_metres(line[-1:])[0].tolist()
        straight_m = math.hypot(east, north) or 1.0
        length_m = float(metres[return_point, waypoint])
        found.append(_Return(waypoint, return_point, length_m, east / straight_m, north / straight_m, line, under_m, known is not None))
    return found


def _amsl_m(one: _Return, waypoints: Waypoints) -> float:
    """Of the waypoint, over the ground that the return knows."""
    return float(one.ground_m[0] + waypoints.points.agl_m[one.waypoint])


def _taken(one: _Return, waypoints: Waypoints, level_m: float, hold_s: float, air: Air) -> list[tuple[float, float]]:
    """Seconds and joules until it has stayed and climbed, until it is over the return point, and until it has landed."""
    task = waypoints.points.task.get(one.waypoint)
    stays_s = hold_s + (0.0 if task is None else task.hold_s)
    here_m, agl_m = _amsl_m(one, waypoints), float(waypoints.points.agl_m[one.waypoint])
    level_agl_m, down_m = level_m - float(one.ground_m[0]), level_m - float(one.ground_m[-1])
    is_known = waypoints.amsl_m is not None
    density = air_density(here_m if is_known else 0.0, air.temperature_c)
    up = leg_taken(0.0, 0.0, 0.0, agl_m, level_agl_m, level_m - here_m, density, air)
    stops_s = 2.0 * air.own.brake_s + air.own.settle_s  # however short it stays: it turns round
    stay = hold_taken(stays_s + stops_s, agl_m, density, air)
    density = air_density(level_m if one.is_known else 0.0, air.temperature_c)
    # The ground under it rises and falls, so that one of the winds between its least and its greatest height may be met.
    across = max(
        (
            leg_taken(one.length_m, one.east, one.north, height_m, height_m, 0.0, density, air)
            for height_m in (level_m - float(one.ground_m.min()), level_m - float(one.ground_m.max()))
        ),
        key=lambda found: found[1] if len(air.table) else found[0],
    )
    touching = landing_taken(down_m, density, air)
    down = np.add(leg_taken(0.0, 0.0, 0.0, down_m, 0.0, -down_m, density, air), touching)
    sums = np.cumsum([np.add(stay, up), across, down], axis=0)
    return [(float(seconds), float(joules)) for seconds, joules in sums]


def _flown(one: _Return, waypoints: Waypoints, level_m: float, start_s: float | None, seconds: Sequence[float]) -> FlownRoute:
    """The waypoint, the place above it, and the return point; it is at the waypoint from start_s on.

    On the way it is between its least and its greatest height above ground, wherever that is.
    """
    lowest_m, highest_m = level_m - one.ground_m.max(), level_m - one.ground_m.min()
    start_agl_m = float(waypoints.points.agl_m[one.waypoint])
    agl_m = np.array([start_agl_m, level_m - one.ground_m[0], lowest_m, highest_m, level_m - one.ground_m[-1]])
    amsl_m = np.array([_amsl_m(one, waypoints), level_m, level_m, level_m, level_m]) if one.is_known else None
    position = one.line[[0, 0, 0, -1, -1]]
    if start_s is None:
        return FlownRoute(position, agl_m, amsl_m, lands=True)
    arrival_s = start_s + np.array([0.0, seconds[0], seconds[0], seconds[1], seconds[1]])
    return FlownRoute(position, agl_m, amsl_m, arrival_s=arrival_s, departs_s=start_s, ends_s=start_s + seconds[2], lands=True)
