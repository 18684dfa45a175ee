"""Several flights of one UAV as one route: between two of them it stands at its base and gets another battery."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from inspection.geodesy import path_length_m
from planning.energy.conditions import Conditions
from planning.energy.performance import Performance
from planning.rules import FlightRules
from planning.task import Task, TaskKind
from planning.trajectory.timing import Timing, timing
from planning.trajectory.waypoints import BASE, NONE, FloatArray, RoutePoints, Waypoints


def joined_sorties(sorties: Sequence[Waypoints], turnaround_s: float) -> Waypoints:
    """One after another, each of at least one waypoint; in between, on the ground under the end of each, a waypoint of the kind `base`."""
    joined = sorties[0]
    for sortie in sorties[1:]:
        joined = _joined(joined, sortie, turnaround_s)
    return joined


def _joined(first: Waypoints, second: Waypoints, turnaround_s: float) -> Waypoints:
    one, other, stop = first.points, second.points, len(first)
    tasks = one.task | {stop: Task(TaskKind.HOLD, turnaround_s)} | {stop + 1 + place: task for place, task in other.task.items()}
    points = RoutePoints(
        np.concatenate([one.position, one.position[-1:], other.position]),
        np.concatenate([one.agl_m, [0.0], other.agl_m]),
        np.concatenate([one.kind, [BASE], other.kind]),
        np.concatenate([one.asset, [NONE], other.asset]),
        np.concatenate([one.target, [NONE], other.target]),
        tasks,
        one.speed_mps | {stop + 1 + place: speed_mps for place, speed_mps in other.speed_mps.items()},
    )

    def heights(left_m: FloatArray, right_m: FloatArray) -> FloatArray:
        return np.concatenate([left_m, [left_m[-1] - one.agl_m[-1]], right_m])

    amsl_m = None if first.amsl_m is None or second.amsl_m is None else heights(first.amsl_m, second.amsl_m)
    is_flat = first.relative_m is one.agl_m and second.relative_m is other.agl_m
    return Waypoints(points, amsl_m, points.agl_m if is_flat else heights(first.relative_m, second.relative_m))


def timing_of_route(
    waypoints: Waypoints,
    *,
    cruise_speed_mps: float,
    performance: Performance,
    conditions: Conditions,
    lands: bool,
    rules: FlightRules,
) -> Timing:
    """As `timing`, over all flights of a route: Wh and battery count from each take-off anew, in total they are of all.

    Raises NoHeadway.
    """
    stops = np.flatnonzero(waypoints.points.kind == BASE).tolist()
    flown = [
        timing(
            waypoints if end - begin == len(waypoints) else waypoints.part(begin, end),
            cruise_speed_mps=cruise_speed_mps,
            performance=performance,
            conditions=conditions,
            lands=lands or end < len(waypoints),
            rules=rules,
        )
        for begin, end in zip([0, *(stop + 1 for stop in stops)], [*stops, len(waypoints)], strict=True)
    ]
    whole = flown[0]
    for stop, sortie in zip(stops, flown[1:], strict=True):
        whole = _one_after_another(whole, sortie, waypoints.points.task[stop].hold_s)
    return whole


def _one_after_another(first: Timing, second: Timing, turnaround_s: float) -> Timing:
    """The first lands, the UAV waits, the second takes off."""

    def column(left: FloatArray | None, at_stop: float | None, right: FloatArray | None) -> FloatArray | None:
        return None if left is None or right is None else np.concatenate([left, [at_stop], right])

    begins_s = first.total_s + turnaround_s
    flown_wh = None if first.total_wh is None or second.total_wh is None else first.total_wh + second.total_wh
    last_wh = None if first.total_wh is None else first.total_wh - _before_last_wh(first)
    return replace(
        second,
        arrival_s=np.concatenate([first.arrival_s, [first.total_s], begins_s + second.arrival_s]),
        used_wh=column(first.used_wh, last_wh, second.used_wh),
        battery_left_percent=column(first.battery_left_percent, first.end_percent, second.battery_left_percent),
        total_s=begins_s + second.total_s,
        total_wh=flown_wh,
    )


def _before_last_wh(whole: Timing) -> float:
    """Of the flights before the last one of a route."""
    if whole.used_wh is None:
        return 0.0
    drops = np.flatnonzero(np.diff(whole.used_wh) < 0)  # a new battery
    return float(whole.used_wh[drops].sum())


def lengths_of_sorties(waypoints: Waypoints) -> list[float]:
    """Metres of each flight of a route."""
    position = waypoints.points.position
    stops = np.flatnonzero(waypoints.points.kind == BASE).tolist()
    return [path_length_m(position[begin : end + 1]) for begin, end in zip([0, *stops], [*stops, len(position) - 1], strict=True)]


def wh_of_sorties(clock: Timing) -> list[float]:
    """What each flight of a route takes; none where its energy is not known."""
    if clock.used_wh is None or clock.total_wh is None:
        return []
    drops = np.flatnonzero(np.diff(clock.used_wh) < 0)
    landed = clock.used_wh[drops].tolist()
    return [*landed, clock.total_wh - sum(landed)]
