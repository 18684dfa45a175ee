"""Whether a UAV was at its targets, and stayed as long as was planned.

What a vehicle counts says that it went on to the next waypoint, not why: a person may have told it to leave one out. So where it was
decides. Between two reports it can have been anywhere that its speed allows: a target that it can have been at, and that it says it has
passed, is taken for reached. One that it cannot have been at was not, whatever is said.
"""

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from inspection.geodesy import distance_m
from missions.mavlink.frozen import FrozenRoute, FrozenWaypoint
from telemetry.mission_report.fix import Fix, own_s

REACHED_M = 15.0  # across: an autopilot takes a waypoint for reached some metres before it, and GPS errs by some more
HOLD_SLACK_S = 3.0  # slowing down and setting out are part of a hold


@dataclass(frozen=True, slots=True)
class Visit:
    """What the reports say of one target of a route.

    closest_m is the nearest that the UAV was seen, can_have_reached whether it may have been within REACHED_M between reports,
    reached_s the first time at which it was seen there or, unseen, the middle of the time in which it can have been; held_s the longest
    that it can have stayed by its own clock, all stays taken together.
    """

    target: int
    waypoint_sequence: int
    planned_hold_s: float
    closest_m: float | None = None
    reached_s: float | None = None
    held_s: float = 0.0
    can_have_reached: bool = False

    @property
    def is_done(self) -> bool:
        return self.can_have_reached and self.held_s >= self.planned_hold_s - HOLD_SLACK_S


def visits_of(route: FrozenRoute, fixes: Sequence[Fix], *, fastest_mps: float) -> list[Visit]:
    """Of each waypoint with a target, in the order of the route. fixes: in order, of one UAV; fastest_mps: over ground, wind and all."""
    return [_visit(waypoint, fixes, fastest_mps) for waypoint in route.waypoints if waypoint.target is not None]


def _visit(waypoint: FrozenWaypoint, fixes: Sequence[Fix], fastest_mps: float) -> Visit:
    hold_s = 0.0 if waypoint.task is None else waypoint.task.hold_s
    target = -1 if waypoint.target is None else waypoint.target
    near = _about(waypoint, fixes)
    if not near:
        return Visit(target, waypoint.sequence, hold_s)
    here = np.broadcast_to(np.array(waypoint.position), (len(near), 2))
    away_m = distance_m(np.array([fix.position for fix in near]), here).tolist()
    seen = [fix.at_s for fix, metres in zip(near, away_m, strict=True) if metres <= REACHED_M]
    held_s, first_between_s = 0.0, None
    for (before, before_m), (after, after_m) in pairwise(zip(near, away_m, strict=True)):
        to_fly_m = max(before_m - REACHED_M, 0.0) + max(after_m - REACHED_M, 0.0)
        between_s = own_s(before, after)
        spare_s = between_s - to_fly_m / fastest_mps
        if spare_s < 0.0:
            continue
        held_s += spare_s
        if first_between_s is None:
            share = (max(before_m - REACHED_M, 0.0) / fastest_mps + spare_s / 2.0) / between_s
            first_between_s = before.at_s + share * (after.at_s - before.at_s)
    return Visit(
        target=target,
        waypoint_sequence=waypoint.sequence,
        planned_hold_s=hold_s,
        closest_m=min(away_m),
        reached_s=seen[0] if seen else first_between_s,
        held_s=held_s,
        can_have_reached=bool(seen) or first_between_s is not None,
    )


def _about(waypoint: FrozenWaypoint, fixes: Sequence[Fix]) -> Sequence[Fix]:
    """From the last report on the leg before it to the first on the leg after it, where the UAV tells; else all.

    A route may pass one place twice: what it was seen doing there on another leg does not count.
    """
    told = [fix.waypoint_sequence for fix in fixes]
    if any(sequence is None for sequence in told):
        return fixes
    sequences = [sequence for sequence in told if sequence is not None]
    if any(after < before for before, after in pairwise(sequences)):
        return fixes
    first = bisect_left(sequences, waypoint.sequence)
    last = bisect_left(sequences, waypoint.sequence + 2)
    return fixes[max(first - 1, 0) : last + 1]
