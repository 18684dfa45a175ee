"""Why a target is left out after the routes are found: the solver's reason, and the wish, the distance or the zones behind it."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from operation.reasons import MAX_NAMED, Reason
from planning.airspace import NamedZone
from planning.assignment.assignment import Assignment
from planning.assignment.options import has_sensor, may_do
from planning.assignment.refusals import Grounding
from planning.assignment.routing_input import RoutingInput
from planning.connection_points import TargetPaths, is_near_network
from planning.context import ResolvedTarget
from planning.energy.power import power_w
from planning.plan import Shortfall, UnassignedTarget
from planning.problem import End, Objective, Problem, Unassigned, UnassignedReason
from planning.request import PlanRequest, TargetRequest, UavRequest
from planning.solver.reach import needed_range_m, reachable

LOCKED = Reason("locked_run")
WIND = "wind"
NEEDS_UAV = {"beyond_range", "beyond_battery"}  # reasons of the solver, which has no names


def explained_unassigned(
    unassigned: Sequence[Unassigned],
    routing: RoutingInput,
    uavs: Sequence[int],
    asked: Assignment,
    grounded: Mapping[int, Grounding],
    no_landing: Mapping[int, NamedZone],
    kept_from: Mapping[int, Collection[int]],
) -> list[UnassignedTarget]:
    """Return the solver's reasons in full. no_landing: zones in which UAVs would land at targets, by their numbers among those routed;
    kept_from: of UAVs the targets for which their battery does not last."""
    request, ways, visits_of = routing.request, routing.ways, asked.problem.visits_of_target()
    in_runs = {target for lock in asked.problem.locks if len(lock.targets) > 1 for target in lock.targets}
    found = []
    for item in unassigned:
        target, visits = routing.targets[item.target], visits_of[item.target]
        if item.target in no_landing and item.reason is UnassignedReason.NO_PATH:
            landing = Reason("lands_through_zone", no_landing[item.target].params)
            found.append(UnassignedTarget(target.target, "inside_zone", (landing,)))
            continue
        not_charged = [uav for uav, kept in kept_from.items() if target.target in kept]
        if not_charged and item.reason is UnassignedReason.NOT_ALLOWED:
            too_small = (_battery_too_small(not_charged, request),)
            found.append(UnassignedTarget(target.target, UnassignedReason.BEYOND_ENERGY.value, too_small, uavs=tuple(not_charged)))
            continue
        if item.target in asked.held_back:
            found.append(UnassignedTarget(target.target, UnassignedReason.NOT_ALLOWED.value, asked.held_back[item.target]))
            continue
        why: tuple[Reason, ...]
        named: tuple[int, ...] = () if item.uav is None else (uavs[item.uav],)
        if item.reason is UnassignedReason.MAX_TARGETS:
            able = _able(asked.problem, uavs, visits)
            reason, why = item.reason.value, (_all_full(request.targets[target.target], able, request),)
            named = tuple(able)
        else:
            reason, why = _why(item, request.targets[target.target], request, asked, visits, ways, grounded) or _path_barred(
                target, item, asked.problem, visits, routing, grounded
            )
        missing = item.missing if reason == item.reason.value else None
        shortfall = None if not missing or item.uav is None else _shortfall(request.uavs[uavs[item.uav]], item.reason, missing)
        if named and why[0].code in NEEDS_UAV:
            why = (_with(why[0], uav=request.uavs[named[0]].name), *why[1:])
        if shortfall is not None:
            why = (with_minutes(why[0], shortfall), *why[1:])
        if item.target in in_runs:
            why = (*why, LOCKED)
        found.append(UnassignedTarget(target.target, reason, why, missing, shortfall, named))
    return found


def _with(reason: Reason, **params: object) -> Reason:
    return Reason(reason.code, {**reason.params, **params})


def _battery_too_small(uavs: Sequence[int], request: PlanRequest) -> Reason:
    """uavs: those whose battery was tried, as their routes are drawn."""
    code = "battery_too_small_with_charging" if any(request.may_charge(uav) for uav in uavs) else "battery_too_small"
    return Reason(code, {"any_uav": [request.uavs[uav].name for uav in uavs]})


def _shortfall(uav: UavRequest, reason: UnassignedReason, missing: float) -> Shortfall:
    return of_range(uav, missing) if reason is UnassignedReason.BEYOND_RANGE else of_battery(uav, missing)


def _why(
    item: Unassigned,
    target: TargetRequest,
    request: PlanRequest,
    asked: Assignment,
    visits: Sequence[int],
    ways: TargetPaths,
    grounded: Mapping[int, Grounding],
) -> tuple[str, tuple[Reason, ...]] | None:
    """Where a wish is what keeps the target from its route, that wish."""
    if item.reason is UnassignedReason.NOT_ALLOWED:
        return item.reason.value, _nobody_may(target, request, grounded)
    if item.reason is UnassignedReason.NO_PATH and _is_cut_off_from_bases(asked.problem, visits, ways):
        return item.reason.value, (Reason("no_path_to_base"),)
    return None


def _is_cut_off_from_bases(problem: Problem, visits: Sequence[int], ways: TargetPaths) -> bool:
    """Whether every UAV that may do it has to land at a base, and none can be reached from where it meets the network."""
    may = [uav for uav in range(len(problem.uavs)) if any(problem.may_fly(uav, visit) for visit in visits)]
    return (
        bool(may)
        and all(problem.uavs[uav].end is End.ANY_BASE for uav in may)
        and any(ways.exit_legs[visit] for visit in visits)
        and not np.isfinite(ways.to_base_m[list(visits)]).any()
    )


def _nobody_may(target: TargetRequest, request: PlanRequest, grounded: Mapping[int, Grounding]) -> tuple[Reason, ...]:
    """Who could do it stays on the ground, and why; or nobody has the sensor."""
    if target.uav:
        tied = next((number for number, uav in enumerate(request.uavs) if uav.name == target.uav), None)
        if tied is not None and not has_sensor(request.uavs[tied], target.sensor):
            return (Reason("tied_without_sensor", {"uav": target.uav, "sensor": target.sensor}),)
        if tied is not None and tied in grounded:
            return Reason("tied_to_grounded", {"uav": target.uav}), grounded[tied].why
        return (Reason("tied_to_unable", {"uav": target.uav}),)
    able = [number for number, uav in enumerate(request.uavs) if may_do(uav, target)]
    if able:
        return Reason("no_flying_uav_with_sensor", {"sensor": target.sensor}), *_why_grounded(able, grounded)
    return (Reason("no_uav_with_sensor", {"sensor": target.sensor}),)


def _why_grounded(uavs: Sequence[int], grounded: Mapping[int, Grounding]) -> list[Reason]:
    """Of the first of these UAVs."""
    return [grounded[uav].why for uav in uavs if uav in grounded][:MAX_NAMED]


def _able(problem: Problem, uavs: Sequence[int], visits: Sequence[int]) -> list[int]:
    """The UAVs, by their places in the request, that could do one of the visits alone."""
    within = reachable(problem, needed_range_m(problem))[:, list(visits)].any(axis=1)
    return [uavs[start] for start in np.flatnonzero(within).tolist()]


def _all_full(target: TargetRequest, able: Sequence[int], request: PlanRequest) -> Reason:
    """Each UAV that could do it alone has its most: which they are, where they are few."""
    if target.uav:
        return Reason("tied_to_full", {"uav": target.uav})
    if not able or len(able) > MAX_NAMED:
        return Reason("all_uavs_full")
    full = [request.uavs[uav] for uav in able]
    if len(full) == 1:
        return Reason("uav_full", {"uav": full[0].name, "most": full[0].most_targets})
    return Reason("uavs_full", {"uavs": [uav.name for uav in full[:-1]], "last": full[-1].name})


def _path_barred(
    target: ResolvedTarget,
    item: Unassigned,
    problem: Problem,
    visits: Sequence[int],
    routing: RoutingInput,
    grounded: Mapping[int, Grounding],
) -> tuple[str, tuple[Reason, ...]]:
    """Where the solver found no path, whether that is the distance to the network or the zones around."""
    ways, airspace = routing.ways, routing.airspace
    if item.reason is not UnassignedReason.NO_PATH:
        return item.reason.value, (item.why,)
    if not ways.uavs:
        return item.reason.value, (item.why, *_why_grounded(sorted(grounded), grounded))
    if _is_stopped_by_wind(problem, visits):
        return WIND, (Reason("wind_too_strong"),)
    reach = {"reach_km": airspace.access.access_leg_m / 1_000}
    if not any(ways.entry_legs[visit] for visit in visits):
        if any(is_near_network(airspace.graph, end, airspace.access.access_leg_m) for end in (target.course[0], target.course[-1])):
            return UnassignedReason.NO_PATH.value, (Reason("access_barred", reach),)
        return "too_far_from_network", (Reason("too_far_from_network", reach),)
    if not any(ways.uav_legs):
        return UnassignedReason.NO_PATH.value, (Reason("no_access_for_uavs", reach),)
    return item.reason.value, (item.why,)


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


def with_minutes(reason: Reason, shortfall: Shortfall) -> Reason:
    """The reason with the minutes of the shortfall; rounded up, as no less would do."""
    return _with(reason, minutes=math.ceil(shortfall.seconds / 6.0) / 10.0)
