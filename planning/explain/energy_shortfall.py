"""How many Wh are missing for what no battery lasts for: as the best route to it alone is drawn, over the ground and what stands tall."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from planning.assignment.candidate_plan import CandidatePlan
from planning.assignment.unassigned import LOCKED, of_battery, with_minutes
from planning.checks.battery import KEPT_BACK
from planning.checks.least_shortfall import IsClear, Lack, LeastLacks
from planning.checks.wires import NO_PATH, barred_text
from planning.plan import UnassignedTarget
from planning.problem import End, Reason
from planning.request import PlanRequest, UavRequest
from planning.solver.reach import NOT_ON_ONE_ROUTE, RANGE_ALONE

OUT_OF_REACH = {Reason.BEYOND_RANGE.value, Reason.BEYOND_ENERGY.value}
ALONE = "It is within what the battery may give alone, but not within what is left after the other targets."
_THERE = {End.OPEN: "there", End.RETURN: "there and back", End.ANY_BASE: "there and on to the nearest base"}


def with_lacks(found: CandidatePlan, is_clear: IsClear | None = None) -> list[UnassignedTarget]:
    """The targets left out, with the Wh that are missing for those for which no battery lasts. Locked runs keep their reasons.

    is_clear: whether a drawn route keeps clear of all zones, where the plan stands on fewer: a way that does not is none.
    """
    told = list(found.left_out)
    rows = [row for row, item in enumerate(told) if item.reason in OUT_OF_REACH and not item.message.endswith(LOCKED)]
    if rows:
        lacks = LeastLacks(found, is_clear)
        for row in rows:
            told[row] = _told(told[row], found.request, lacks)
    return told


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
            return replace(alone, message=alone.message + LOCKED) if item.message.endswith(LOCKED) else alone
        if same is None or item.reason not in OUT_OF_REACH:
            return item
        if item.missing is None:
            return same
        if same.missing is None:
            return item
        if item.missing == 0.0 or same.missing == 0.0:
            return item if item.missing == 0.0 else same
        if item.reason != same.reason:
            return item if item.reason == Reason.BEYOND_ENERGY.value else same
        return item if item.missing <= same.missing else same

    return [least(item) for item in plan]


def _told(item: UnassignedTarget, request: PlanRequest, lacks: LeastLacks) -> UnassignedTarget:
    """Who has the range, but was kept from a target, lacks the battery, even where the solver saw only the range of the others."""
    by_range = item.reason == Reason.BEYOND_RANGE.value
    is_alone = by_range and not item.missing
    least = None if is_alone else lacks.of_battery(item.target)
    if least is None and not by_range:
        for target, uav in lacks.barred:
            if target == item.target:
                return UnassignedTarget(target, NO_PATH, barred_text(request.uavs[uav].name), uavs=(uav,))
    if least is None:
        is_way = lacks.is_clear is None or (by_range and lacks.of_range(item.target) is not None)
        if is_way or by_range:
            return item if is_way else replace(item, missing=None)
        anyhow = _told(item, request, LeastLacks(lacks.found))  # where zones are not in force: no less is missing
        return replace(anyhow, missing=None)
    told = replace(item, reason=Reason.BEYOND_ENERGY.value)
    if least.missing <= 0.0:
        if item.message == KEPT_BACK:
            return replace(told, missing=0.0)
        return _alone(item.target, request.uavs[least.uav])
    shortfall = of_battery(request.uavs[least.uav], least.missing)
    return replace(
        told, message=with_minutes(_message(least, request), shortfall), missing=least.missing, shortfall=shortfall, uavs=(least.uav,)
    )


def _alone(target: int, uav: UavRequest) -> UnassignedTarget:
    """What keeps it from the route of a UAV that could do it alone."""
    if uav.performance.usable_wh is not None:
        return UnassignedTarget(target, Reason.BEYOND_ENERGY.value, ALONE, 0.0)
    told = NOT_ON_ONE_ROUTE if uav.max_range_m is None else RANGE_ALONE
    return UnassignedTarget(target, told.reason.value, told.message, 0.0)


def _message(lack: Lack, request: PlanRequest) -> str:
    uav = request.uavs[lack.uav]
    more = f"{lack.missing:,.1f} Wh more than the battery of {uav.name} may give."
    if lack.route.lacks_wh > 0.0:
        return f"However {uav.name} charges on the way, it alone takes up to {more}"  # fewer may do by ways that were not drawn
    needed, there = f"{lack.missing + (uav.performance.usable_wh or 0.0):,.1f} Wh", _THERE[request.route_end(lack.uav)]
    return f"Over the ground and what stands tall it takes {needed} {there}, {more}"
