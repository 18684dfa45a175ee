"""Manual edits that survive planning again: legs with the same endpoints that are still clear."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from missions.models import Mission, Route
from missions.services.manual_edits.checks import ManualEditContext, manual_edit_context
from missions.services.manual_edits.edits import checked_manual_edit, places_of, settle_manual_edits, store_manual_edit
from missions.services.manual_edits.legs import EditedLeg, Step, hand_legs_from_json, legs_between, step_points, step_row, target_keys
from operation.reasons import Reason
from planning.plan import PlannedRoute, PlanWarning
from planning.plan_json import warning_to_json
from planning.request import InvalidRequest
from planning.trajectory.waypoints import RoutePoints

NOT_KEPT = "by_hand_not_kept"


@dataclass(frozen=True, eq=False)
class _Kept:
    legs: list[EditedLeg]
    rows: list[Step]
    points: RoutePoints
    flown: PlannedRoute


def keep_by_hand(mission: Mission) -> int:
    """Apply as many edited legs of the previous plan as possible to the newly planned routes; returns how many.

    The caller holds the mission's row, has stored the plan and saves the row. The planned routes can be restored like any undo. The plan
    warns of legs that were discarded.
    """
    remembered = hand_legs_from_json((mission.last_plan or {}).get("by_hand", ()))
    if not remembered:
        return 0
    ground, targets, count = manual_edit_context(), target_keys(mission), 0
    flown = {route.mission_uav.name: route for route in mission.routes.select_related("mission_uav").filter(geometry__isnull=False)}
    for name, legs in remembered.items():
        route = flown.get(name)
        kept = None if route is None or route.charging else _kept(mission, route, legs, targets, ground)
        if route is not None and kept is not None:
            route.before_hand = [[step_row(row) for row in route.waypoints.select_related("target")]]
            store_manual_edit(mission, route, kept.flown, places_of(kept.points, _by_hand(kept.rows)))
            count += len(kept.legs)
        missed = len(legs) - (0 if kept is None else len(kept.legs))
        uav = next((row.sequence for row in mission.mission_uavs.all() if row.name == name), None)
        if missed and uav is not None:
            mission.plan_warnings = [*mission.plan_warnings, _warning(name, uav, missed, len(legs))]
    if count:
        settle_manual_edits(mission)
    return count


def _warning(name: str, uav: int, missed: int, count: int) -> dict[str, Any]:
    return warning_to_json(PlanWarning(NOT_KEPT, uav, Reason("edits_discarded", {"missed": missed, "legs": count, "uav": name})))


def _kept(mission: Mission, route: Route, legs: Sequence[EditedLeg], targets: dict[int, Any], ground: ManualEditContext) -> _Kept | None:
    """Return the route with all legs whose endpoints still exist; where these are not clear together, with each leg that stays clear."""
    stored = list(route.waypoints.select_related("target"))
    if any((row.task or {}).keys() & {"view", "speed_mps"} for row in stored):  # such routes are not changed by hand: see list_faults
        return None
    planned = [step_row(row) for row in stored]
    there = {(start, end) for start, end, _first, _last in legs_between(planned, targets)}
    left = [leg for leg in legs if (leg.start, leg.end) in there]
    if not left:
        return None
    whole = _tried(mission, route, left, planned, targets, ground)
    if whole is not None or len(left) == 1:
        return whole
    best: _Kept | None = None
    for leg in left:
        best = _tried(mission, route, [*([] if best is None else best.legs), leg], planned, targets, ground) or best
    return best


def _tried(
    mission: Mission, route: Route, legs: list[EditedLeg], planned: Sequence[Step], targets: dict[int, Any], ground: ManualEditContext
) -> _Kept | None:
    rows = _with_legs(planned, legs, targets)
    points = RoutePoints.of(step_points(rows))
    try:
        flown = checked_manual_edit(mission, route, points, _by_hand(rows), ground)
    except InvalidRequest:
        return None
    return _Kept(legs, rows, points, flown)


def _by_hand(rows: Sequence[Step]) -> NDArray[np.bool_]:
    return np.array([row["is_by_hand"] for row in rows], dtype=np.bool_)


def _with_legs(planned: Sequence[Step], legs: Sequence[EditedLeg], targets: dict[int, Any]) -> list[Step]:
    by_ends = {(leg.start, leg.end): leg for leg in legs}
    rows = [planned[0]]
    for start, end, first, last in legs_between(planned, targets):
        leg, own = by_ends.get((start, end)), planned[last]
        rows += planned[first + 1 : last] if leg is None or leg.points is None else leg.points
        if leg is not None and leg.is_end_by_hand:
            own = own | {"agl_m": leg.end_agl_m, "speed_mps": leg.end_speed_mps, "is_by_hand": True}
        rows.append(own)
    return rows
