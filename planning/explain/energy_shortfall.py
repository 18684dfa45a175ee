"""How many Wh are missing for what no battery lasts for: as the best route to it alone is drawn, over the ground and what stands tall."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from operation.reasons import Reason
from planning.assignment.candidate_plan import CandidatePlan
from planning.assignment.unassigned import LOCKED, of_battery, with_minutes
from planning.checks.battery import IN_EVERY_ROUTE
from planning.checks.least_shortfall import IsClear, LeastShortfalls, RouteShortfall
from planning.checks.wires import NO_PATH, wires_in_the_way
from planning.plan import UnassignedTarget
from planning.problem import UnassignedReason
from planning.request import PlanRequest, UavRequest
from planning.solver.reach import NOT_ON_ONE_ROUTE, RANGE_ALONE, THERE

OUT_OF_REACH = {UnassignedReason.BEYOND_RANGE.value, UnassignedReason.BEYOND_ENERGY.value}


def with_shortfalls(found: CandidatePlan, is_clear: IsClear | None = None) -> list[UnassignedTarget]:
    """The targets left out, with the Wh that are missing for those for which no battery lasts. Locked runs keep their reasons.

    is_clear: whether a drawn route keeps clear of all zones, where the plan stands on fewer: a way that does not is none.
    """
    reported = list(found.left_out)
    rows = [row for row, item in enumerate(reported) if item.reason in OUT_OF_REACH and not item.is_for(LOCKED.code)]
    if rows:
        shortfalls = LeastShortfalls(found, is_clear)
        for row in rows:
            reported[row] = _reported(reported[row], found.request, shortfalls)
    return reported


def least_missing(
    plan: Sequence[UnassignedTarget], other: Sequence[UnassignedTarget], flown: Mapping[int, UavRequest]
) -> list[UnassignedTarget]:
    """What another plan leaves out as out of reach, too, may lack less on its ways, nothing where it could be done alone on these.

    Who has the range on one way lacks the battery. flown: what the other plan visits, and who does; that is not out of reach at all.
    """
    theirs = {item.target: item for item in other if item.missing is not None}

    def least(item: UnassignedTarget) -> UnassignedTarget:
        same = theirs.get(item.target)
        if item.reason in OUT_OF_REACH and item.missing and item.target in flown:
            alone = _alone(item.target, flown[item.target])
            return replace(alone, why=(*alone.why, LOCKED)) if item.is_for(LOCKED.code) else alone
        if same is None or item.reason not in OUT_OF_REACH:
            return item
        if item.missing is None:
            return same
        if same.missing is None:
            return item
        if item.missing == 0.0 or same.missing == 0.0:
            return item if item.missing == 0.0 else same
        if item.reason != same.reason:
            return item if item.reason == UnassignedReason.BEYOND_ENERGY.value else same
        return item if item.missing <= same.missing else same

    return [least(item) for item in plan]


def _reported(item: UnassignedTarget, request: PlanRequest, shortfalls: LeastShortfalls) -> UnassignedTarget:
    """Who has the range, but was kept from a target, lacks the battery, even where the solver saw only the range of the others."""
    by_range = item.reason == UnassignedReason.BEYOND_RANGE.value
    is_alone = by_range and not item.missing
    least = None if is_alone else shortfalls.of_battery(item.target)
    if least is None and not by_range:
        for target, uav in shortfalls.barred:
            if target == item.target:
                return UnassignedTarget(target, NO_PATH, (wires_in_the_way(request.uavs[uav].name),), uavs=(uav,))
    if least is None:
        is_way = shortfalls.is_clear is None or (by_range and shortfalls.of_range(item.target) is not None)
        if is_way or by_range:
            return item if is_way else replace(item, missing=None)
        anyhow = _reported(item, request, LeastShortfalls(shortfalls.found))  # where zones are not in force: no less is missing
        return replace(anyhow, missing=None)
    reported = replace(item, reason=UnassignedReason.BEYOND_ENERGY.value)
    if least.missing <= 0.0:
        if item.is_for(IN_EVERY_ROUTE.code):
            return replace(reported, missing=0.0)
        return _alone(item.target, request.uavs[least.uav])
    shortfall = of_battery(request.uavs[least.uav], least.missing)
    return replace(
        reported,
        why=(with_minutes(_beyond_battery(least, request), shortfall),),
        missing=least.missing,
        shortfall=shortfall,
        uavs=(least.uav,),
    )


def _alone(target: int, uav: UavRequest) -> UnassignedTarget:
    """What keeps it from the route of a UAV that could do it alone."""
    if uav.performance.usable_wh is not None:
        return UnassignedTarget(target, UnassignedReason.BEYOND_ENERGY.value, (Reason("in_reach_alone"),), 0.0)
    reported = NOT_ON_ONE_ROUTE if uav.max_range_m is None else RANGE_ALONE
    return UnassignedTarget(target, reported.reason.value, (reported.why,), 0.0)


def _beyond_battery(lack: RouteShortfall, request: PlanRequest) -> Reason:
    uav = request.uavs[lack.uav]
    figures = {"uav": uav.name, "missing_wh": lack.missing}
    if lack.route.shortfall_wh > 0.0:
        return Reason("beyond_battery_with_charging", figures)  # fewer may do by paths that were not drawn
    needed_wh = lack.missing + (uav.performance.usable_wh or 0.0)
    return Reason("beyond_battery_as_drawn", {**figures, "needed_wh": needed_wh, "there": THERE[request.route_end(lack.uav)]})
