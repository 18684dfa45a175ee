"""Why a target is left out after the routes are found: the solver's reason, and the wish, the distance or the zones behind it."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from planning.assignment.assignment import Assignment
from planning.assignment.options import has_sensor, may_do
from planning.assignment.refusals import Grounding
from planning.assignment.routing_input import RoutingInput
from planning.connection_points import Ways, is_near_network
from planning.context import ResolvedTarget
from planning.energy.power import power_w
from planning.plan import Shortfall, UnassignedTarget
from planning.problem import End, Objective, Problem, Reason, Unassigned
from planning.request import PlanRequest, TargetRequest, UavRequest
from planning.solver.reach import NEAREST, needed_range_m, reachable

LOCKED = " It is locked to others: the run is left out as a whole."
WIND = "wind"
TOO_STRONG = "The wind is too strong on every way to it, or back."
MAX_NAMED = 3  # UAVs that a reason names


def explained_unassigned(
    unassigned: Sequence[Unassigned],
    routing: RoutingInput,
    uavs: Sequence[int],
    asked: Assignment,
    grounded: Mapping[int, Grounding],
    no_landing: Mapping[int, str],
    kept_from: Mapping[int, Collection[int]],
) -> list[UnassignedTarget]:
    """Return the solver's reasons in full. no_landing: zones in which UAVs would land at targets, by their numbers among those routed;
    kept_from: of UAVs the targets for which their battery does not last."""
    request, ways, visits_of = routing.request, routing.ways, asked.problem.visits_of_target()
    in_runs = {target for lock in asked.problem.locks if len(lock.targets) > 1 for target in lock.targets}
    found = []
    for item in unassigned:
        target, visits = routing.targets[item.target], visits_of[item.target]
        if item.target in no_landing and item.reason is Reason.NO_PATH:
            message = f"To land there is to fly through {no_landing[item.target]}."
            found.append(UnassignedTarget(target.target, "inside_zone", message))
            continue
        not_charged = [uav for uav, kept in kept_from.items() if target.target in kept]
        if not_charged and item.reason is Reason.NOT_ALLOWED:
            message = _does_not_last(not_charged, request)
            found.append(UnassignedTarget(target.target, Reason.BEYOND_ENERGY.value, message, uavs=tuple(not_charged)))
            continue
        if item.target in asked.held_back:
            found.append(UnassignedTarget(target.target, Reason.NOT_ALLOWED.value, asked.held_back[item.target]))
            continue
        named: tuple[int, ...] = () if item.uav is None else (uavs[item.uav],)
        if item.reason is Reason.MAX_TARGETS:
            able = _able(asked.problem, uavs, visits)
            reason, message = item.reason.value, _all_have_enough(request.targets[target.target], able, request)
            named = tuple(able)
        else:
            reason, message = _why(item, request.targets[target.target], request, asked, visits, ways, grounded) or _way_barred(
                target, item, asked.problem, visits, routing, grounded
            )
        missing = item.missing if reason == item.reason.value else None
        shortfall = None if not missing or item.uav is None else _shortfall(request.uavs[uavs[item.uav]], item.reason, missing)
        if item.uav is not None:
            message = message.replace(NEAREST, request.uavs[uavs[item.uav]].name)
        told = message if shortfall is None else with_minutes(message, shortfall)
        found.append(UnassignedTarget(target.target, reason, told + (LOCKED if item.target in in_runs else ""), missing, shortfall, named))
    return found


def _does_not_last(uavs: Sequence[int], request: PlanRequest) -> str:
    """uavs: those whose battery was tried, as their routes are drawn."""
    names = " or ".join(request.uavs[uav].name for uav in uavs)
    if any(request.may_charge(uav) for uav in uavs):
        return f"However {names} charges on the way, the battery does not last for it."
    return f"The battery of {names} does not last for it."


def _shortfall(uav: UavRequest, reason: Reason, missing: float) -> Shortfall:
    return of_range(uav, missing) if reason is Reason.BEYOND_RANGE else of_battery(uav, missing)


def _why(
    item: Unassigned,
    target: TargetRequest,
    request: PlanRequest,
    asked: Assignment,
    visits: Sequence[int],
    ways: Ways,
    grounded: Mapping[int, Grounding],
) -> tuple[str, str] | None:
    """Where a wish is what keeps the target from its route, that wish."""
    if item.reason is Reason.NOT_ALLOWED:
        return item.reason.value, _nobody_may(target, request, grounded)
    if item.reason is Reason.NO_PATH and _is_cut_off_from_bases(asked.problem, visits, ways):
        return item.reason.value, "There is no way from it to a base that lies outside every no-fly zone."
    return None


def _is_cut_off_from_bases(problem: Problem, visits: Sequence[int], ways: Ways) -> bool:
    """Whether every UAV that may do it has to land at a base, and none can be reached from where it meets the network."""
    may = [uav for uav in range(len(problem.uavs)) if any(problem.may_fly(uav, visit) for visit in visits)]
    return (
        bool(may)
        and all(problem.uavs[uav].end is End.ANY_BASE for uav in may)
        and any(ways.exit_legs[visit] for visit in visits)
        and not np.isfinite(ways.to_base_m[list(visits)]).any()
    )


def _nobody_may(target: TargetRequest, request: PlanRequest, grounded: Mapping[int, Grounding]) -> str:
    """Who could do it stays on the ground, and why; or nobody has the sensor."""
    if target.uav:
        tied = next((number for number, uav in enumerate(request.uavs) if uav.name == target.uav), None)
        if tied is not None and not has_sensor(request.uavs[tied], target.sensor):
            return f"It is tied to {target.uav}, which does not have the sensor {target.sensor}."
        if tied is not None and tied in grounded:
            return f"It is tied to {target.uav}. {grounded[tied].message}"
        return f"It is tied to {target.uav}, which cannot fly to it."
    able = [number for number, uav in enumerate(request.uavs) if may_do(uav, target)]
    if able:
        return " ".join([f"No UAV that can take off has the sensor {target.sensor}.", *_why_grounded(able, grounded)])
    return f"No UAV of the plan has the sensor {target.sensor}."


def _why_grounded(uavs: Sequence[int], grounded: Mapping[int, Grounding]) -> list[str]:
    """Of the first of these UAVs."""
    return [grounded[uav].message for uav in uavs if uav in grounded][:MAX_NAMED]


def _able(problem: Problem, uavs: Sequence[int], visits: Sequence[int]) -> list[int]:
    """The UAVs, by their places in the request, that could do one of the visits alone."""
    within = reachable(problem, needed_range_m(problem))[:, list(visits)].any(axis=1)
    return [uavs[start] for start in np.flatnonzero(within).tolist()]


def _all_have_enough(target: TargetRequest, able: Sequence[int], request: PlanRequest) -> str:
    """Each UAV that could do it alone has its most: which they are, where they are few."""
    if target.uav:
        return f"It is tied to {target.uav}, which has as many targets as it may have."
    if not able or len(able) > MAX_NAMED:
        return "Each UAV that can do it has as many targets as it may have."
    full = [request.uavs[uav] for uav in able]
    if len(full) == 1:
        return f"{full[0].name} has as many targets as it may have ({full[0].most_targets})."
    return f"{', '.join(uav.name for uav in full[:-1])} and {full[-1].name} have as many targets as they may have."


def _way_barred(
    target: ResolvedTarget,
    item: Unassigned,
    problem: Problem,
    visits: Sequence[int],
    routing: RoutingInput,
    grounded: Mapping[int, Grounding],
) -> tuple[str, str]:
    """Where the solver found no way, whether that is the distance to the network or the zones around."""
    ways, airspace = routing.ways, routing.airspace
    if item.reason is not Reason.NO_PATH:
        return item.reason.value, item.message
    if not ways.uavs:
        return item.reason.value, " ".join([item.message, *_why_grounded(sorted(grounded), grounded)])
    if _is_stopped_by_wind(problem, visits):
        return WIND, TOO_STRONG
    reach = f"{airspace.access.access_leg_m / 1_000:g} km"
    if not any(ways.entry_legs[visit] for visit in visits):
        if any(is_near_network(airspace.graph, end, airspace.access.access_leg_m) for end in (target.course[0], target.course[-1])):
            return Reason.NO_PATH.value, f"Every straight way to it from the network within {reach} meets a no-fly zone."
        return "too_far_from_network", f"It is more than {reach} from the network."
    if not any(ways.uav_legs):
        return Reason.NO_PATH.value, f"No UAV has a clear way of up to {reach} to the network from where it stands."
    return item.reason.value, item.message


def _is_stopped_by_wind(problem: Problem, visits: Sequence[int]) -> bool:
    """Whether a way is there, but none in this wind."""
    if problem.seconds is None:
        return False
    in_wind, without = (bool(np.isfinite(needed_range_m(one)[:, list(visits)]).any()) for one in (problem, in_calm(problem)))
    return without and not in_wind


def in_calm(problem: Problem) -> Problem:
    """The problem without wind, and without what limits the energy in it."""
    uavs = tuple(replace(uav, usable_wh=None) for uav in problem.uavs)
    return replace(problem, uavs=uavs, objective=Objective.TOTAL, seconds=None, wh=None)


def of_range(uav: UavRequest, metres: float) -> Shortfall:
    return Shortfall(metres / uav.cruise_speed_mps, metres=metres)


def of_battery(uav: UavRequest, wh: float) -> Shortfall:
    fastest_mps = uav.performance.max_airspeed_mps or math.inf
    watts = power_w(uav.performance, airspeed_mps=min(uav.cruise_speed_mps, fastest_mps))
    return Shortfall(wh * 3_600.0 / watts, wh=wh)


def with_minutes(sentence: str, shortfall: Shortfall) -> str:
    """The sentence, at whose end the shortfall stands, with its minutes; rounded up, as no less would do."""
    minutes = math.ceil(shortfall.seconds / 6.0) / 10.0
    return f"{sentence.removesuffix('.')}: {minutes:,.1f} min of flight."
