"""Whether a UAV visited its targets, and held as long as planned.

A vehicle's waypoint count shows that it continued, not why: a user may have skipped a waypoint. The position therefore decides. Between two
reports the UAV may have been anywhere within its speed. A target counts as reached if the UAV can have been there and reports having passed
it. One that it cannot have reached counts as missed, whatever is reported.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from inspection.geodesy import distance_m
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import FrozenRoute, FrozenWaypoint
from telemetry.alerting.route_line import RouteLine, RoutePlace
from telemetry.mission_report.fix import Fix, airborne, uav_s

REACHED_M = 15.0  # across: an autopilot accepts a waypoint some metres before it; GPS adds a few more
HOLD_SLACK_S = 3.0  # braking and departure are part of a hold
JOINED_S = 12.0  # between two reports joined by a straight line: UAVs report at least every ten seconds
TURNED_M = 20.0  # back along a leg: then the next leg is flown
OFF_LEG_M = 30.0  # farther from the leg than from a later one: then the later one is flown

Pass = tuple[Sequence[Fix], int]  # reports, and how many precede the flight to the waypoint


@dataclass(frozen=True, slots=True)
class ReportedVisit:
    """What the reports show of one target of a route.

    closest_m is the smallest distance of the reported track, altitude_relative_m the height at the nearest report [m above take-off].
    can_have_reached: it may have been within REACHED_M between reports. reached_s is the first report there, else the middle of the time in
    which it can have been there. held_s is the longest possible stay by its clock, summed over all stays.
    """

    target: int
    waypoint_sequence: int
    planned_hold_s: float
    closest_m: float | None = None
    reached_s: float | None = None
    held_s: float = 0.0
    can_have_reached: bool = False
    altitude_relative_m: float | None = None

    @property
    def is_confirmed(self) -> bool:
        """Return whether the reports show it at the target, not only that it is possible."""
        return self.closest_m is not None and self.closest_m <= REACHED_M

    @property
    def is_done(self) -> bool:
        return self.can_have_reached and self.held_s >= self.planned_hold_s - HOLD_SLACK_S


def visits_of(route: FrozenRoute, fixes: Sequence[Fix], *, fastest_mps: float) -> list[ReportedVisit]:
    """Return the visit of each waypoint with a target, in route order.

    fixes: of one UAV, sorted by time. fastest_mps: maximum ground speed, wind included.
    """
    in_air = airborne(fixes)
    reported = _waypoints_reported(in_air) or _waypoints_by_place(route, in_air)
    found = []
    for place, waypoint in enumerate(route.waypoints):
        if waypoint.target is None:
            continue
        following = route.waypoints[place + 1 : place + 2]
        is_followed_here = any(_apart_m(waypoint, other) <= REACHED_M for other in following)
        passes = [(in_air, 0)] if reported is None else _passes(waypoint.sequence, in_air, reported, is_followed_here=is_followed_here)
        found.append(_best([_visit(waypoint, own, before, fastest_mps) for own, before in passes or [([], 0)]]))
    return found


def _best(visits: Sequence[ReportedVisit]) -> ReportedVisit:
    """Return the first of several passes that was long enough, else the longest; a restarted mission has several."""
    done = next((visit for visit in visits if visit.is_done), None)
    return done or max(visits, key=lambda visit: (visit.can_have_reached, visit.held_s))


def _apart_m(one: FrozenWaypoint, other: FrozenWaypoint) -> float:
    return float(distance_m(np.array([one.position]), np.array([other.position]))[0])


def _visit(waypoint: FrozenWaypoint, near: Sequence[Fix], before: int, fastest_mps: float) -> ReportedVisit:
    """Return the visit in a pass. before: how many of its reports precede the flight to the waypoint."""
    hold_s = 0.0 if waypoint.task is None else waypoint.task.hold_s
    target = -1 if waypoint.target is None else waypoint.target
    if not near:
        return ReportedVisit(target, waypoint.sequence, hold_s)
    here = np.broadcast_to(np.array(waypoint.position), (len(near), 2))
    away_m = distance_m(np.array([fix.position for fix in near]), here).tolist()
    seen = [fix.at_s for fix, metres in zip(near[before:], away_m[before:], strict=True) if metres <= REACHED_M]
    held_s, first_between_s = 0.0, None
    for (earlier, earlier_m), (later, later_m) in pairwise(zip(near, away_m, strict=True)):
        to_fly_m = max(earlier_m - REACHED_M, 0.0) + max(later_m - REACHED_M, 0.0)
        between_s = uav_s(earlier, later)
        spare_s = between_s - to_fly_m / fastest_mps
        if spare_s < 0.0:
            continue
        held_s += spare_s
        if first_between_s is None:
            share = (max(earlier_m - REACHED_M, 0.0) / fastest_mps + spare_s / 2.0) / between_s
            first_between_s = earlier.at_s + share * (later.at_s - earlier.at_s)
    return ReportedVisit(
        target=target,
        waypoint_sequence=waypoint.sequence,
        planned_hold_s=hold_s,
        closest_m=_nearest_m(waypoint, near, away_m),
        reached_s=seen[0] if seen else first_between_s,
        held_s=held_s,
        can_have_reached=bool(seen) or first_between_s is not None,
        altitude_relative_m=near[int(np.argmin(away_m))].altitude_relative_m,
    )


def _waypoints_reported(fixes: Sequence[Fix]) -> list[int] | None:
    """Return the waypoint that each fix flies to, or that of the previous fix if not reported; None if no fix reports one."""
    if all(fix.waypoint_sequence is None for fix in fixes):
        return None
    reported: list[int] = []
    for fix in fixes:
        before = reported[-1] if reported else -1
        reported.append(before if fix.waypoint_sequence is None else fix.waypoint_sequence)
    return reported


def _waypoints_by_place(route: FrozenRoute, fixes: Sequence[Fix]) -> list[int] | None:
    """Return the waypoints of a vehicle that reports none, by its place along the route; None for a route of several flights."""
    if len(route.flights) != 1 or len(route.waypoints) < 2:
        return None
    line = RouteLine(route.flights[0], route.charging_stops)
    reported, leg, farthest_m = [], 0, 0.0
    for fix in fixes:
        here = line.east_north(fix.position)
        on_leg = line.beside(leg, fix.position)
        farthest_m = max(farthest_m, on_leg.along_m)
        is_at_end = math.dist(here, line.vertices[leg + 1]) <= REACHED_M
        has_turned = farthest_m - on_leg.along_m > TURNED_M
        if is_at_end or has_turned:
            leg = min(leg + 1, len(line.vertices) - 2)
        elif on_leg.across_m > OFF_LEG_M:
            ahead = line.place_from(fix.position, RoutePlace(line.along_m[leg], 0.0, leg, 0.0))
            leg = ahead.leg if ahead.across_m + OFF_LEG_M < on_leg.across_m else leg
        farthest_m = max(farthest_m, line.along_m[leg])
        reported.append(line.sequences[leg + 1])
    return reported


def _nearest_m(waypoint: FrozenWaypoint, fixes: Sequence[Fix], away_m: Sequence[float]) -> float:
    """Return the distance of a track: of its reports, and of straight lines between those at most JOINED_S apart."""
    frame = LocalFrame.around(*waypoint.position)
    metres = frame.to_metres(np.array([fix.position for fix in fixes]))
    joined = [uav_s(before, after) <= JOINED_S for before, after in pairwise(fixes)]
    if not any(joined):
        return min(away_m)
    start, along = metres[:-1][joined], np.diff(metres, axis=0)[joined]
    square = np.maximum((along**2).sum(axis=1), 1e-9)
    share = np.clip(-(start * along).sum(axis=1) / square, 0.0, 1.0)[:, None]
    return min(float(np.hypot(*(start + share * along).T).min()), *away_m)


def _passes(sequence: int, fixes: Sequence[Fix], reported: Sequence[int], *, is_followed_here: bool) -> list[Pass]:
    """Return the reports of each approach to a waypoint, at it and on the leg after it, with one more at either end.

    A route may pass a place several times, and a vehicle may restart its mission: reports there during the flight to another waypoint do
    not count. is_followed_here: the next waypoint is at the same place, so being there is no evidence.
    """
    last = sequence if is_followed_here else sequence + 1
    found: list[Pass] = []
    begin: int | None = None
    for place, number in enumerate(reported):
        is_on_it = sequence <= number <= last
        if is_on_it and begin is None:
            begin = max(place - 1, 0)
        elif not is_on_it and begin is not None:
            found.append((fixes[begin : place + 1], int(reported[begin] < sequence)))
            begin = None
        elif not is_on_it and place > 0 and reported[place - 1] < sequence and number > last:  # passed between two reports
            found.append((fixes[place - 1 : place + 1], 1))
    return found if begin is None else [*found, (fixes[begin:], int(reported[begin] < sequence))]
