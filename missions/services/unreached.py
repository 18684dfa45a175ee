"""Why a target is left out after the routes are found: the solver's reason, and the wish, the distance or the zones behind it."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from missions.routing.problem import BoolArray, End, Objective, Problem, Reason, Unassigned
from missions.routing.reach import needed_range_m, reachable
from missions.routing.terminals import Ways, is_near_network
from missions.services.assignment import Assignment
from missions.services.places import Place
from missions.services.refusals import LeftOut, Scene, groundings
from missions.services.requests import PlanRequest, TargetRequest, UavRequest
from missions.services.shortfall import Shortfall, of_battery, of_range, with_minutes
from missions.services.wishes import has_sensor, may_do

LOCKED = " It is locked to others: the run is left out as a whole."
WIND = "wind"
TOO_STRONG = "The wind is too strong on every way to it, or back."
MOST_NAMED = 3  # UAVs that a reason names


def unreached_places(
    unassigned: Sequence[Unassigned],
    request: PlanRequest,
    uavs: Sequence[int],
    asked: Assignment,
    places: Sequence[Place],
    ways: Ways,
    scene: Scene,
    no_landing: Mapping[int, str],
    kept_from: Mapping[int, Collection[int]],
) -> list[LeftOut]:
    """The solver's reasons in full; uavs, ways and visits as it had them. no_landing: zones in which UAVs would land at places, by number;
    kept_from: of UAVs the targets for which they cannot charge in time."""
    visits_of = asked.problem.visits_of_target()
    crew: _Crew | None = None
    in_runs = {target for lock in asked.problem.locks if len(lock.targets) > 1 for target in lock.targets}
    found = []
    for item in unassigned:
        place, visits = places[item.target], visits_of[item.target]
        if item.target in no_landing and item.reason is Reason.NO_PATH:
            message = f"To land there is to fly through {no_landing[item.target]}."
            found.append(LeftOut(place.target, "inside_zone", message))
            continue
        not_charged = [request.uavs[uav].name for uav, targets in kept_from.items() if place.target in targets]
        if not_charged and item.reason is Reason.NOT_ALLOWED:
            message = f"However {' or '.join(not_charged)} charges on the way, the battery does not last for it."
            found.append(LeftOut(place.target, Reason.BEYOND_ENERGY.value, message))
            continue
        if item.target in asked.held_back:
            found.append(LeftOut(place.target, Reason.NOT_ALLOWED.value, asked.held_back[item.target]))
            continue
        if item.reason is Reason.MOST_TARGETS:
            crew = crew or _crew_of(request, asked.problem, scene)
            reason, message = item.reason.value, _all_have_enough(request.targets[place.target], crew, visits)
        else:
            reason, message = _why(item, request.targets[place.target], request, asked, visits, ways) or _way_barred(
                place, item, asked.problem, visits, ways, scene
            )
        missing = item.missing if reason == item.reason.value else None
        shortfall = None if not missing or item.uav is None else _shortfall(request.uavs[uavs[item.uav]], item.reason, missing)
        told = message if shortfall is None else with_minutes(message, shortfall)
        found.append(LeftOut(place.target, reason, told + (LOCKED if item.target in in_runs else ""), missing, shortfall))
    return found


def _shortfall(uav: UavRequest, reason: Reason, missing: float) -> Shortfall:
    return of_range(uav, missing) if reason is Reason.BEYOND_RANGE else of_battery(uav, missing)


def _why(
    item: Unassigned, target: TargetRequest, request: PlanRequest, asked: Assignment, visits: Sequence[int], ways: Ways
) -> tuple[str, str] | None:
    """Where a wish is what keeps the target from its route, that wish."""
    if item.reason is Reason.NOT_ALLOWED:
        return item.reason.value, _nobody_may(target, request)
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


def _nobody_may(target: TargetRequest, request: PlanRequest) -> str:
    if target.uav:
        tied = next((uav for uav in request.uavs if uav.name == target.uav), None)
        if tied is not None and not has_sensor(tied, target.sensor):
            return f"It is tied to {target.uav}, which does not have the sensor {target.sensor}."
        return f"It is tied to {target.uav}, which cannot take off."
    if any(may_do(uav, target) for uav in request.uavs):
        return f"No UAV that can take off has the sensor {target.sensor}."
    return f"No UAV of the plan has the sensor {target.sensor}."


@dataclass(frozen=True, eq=False)
class _Crew:
    """The UAVs that fly, and which of the visits each could do alone, (u, v)."""

    uavs: tuple[UavRequest, ...]
    within: BoolArray


def _crew_of(request: PlanRequest, problem: Problem, scene: Scene) -> _Crew:
    grounded = groundings(request.uavs, scene)
    flying = tuple(uav for number, uav in enumerate(request.uavs) if number not in grounded)
    return _Crew(flying, reachable(problem, needed_range_m(problem)))


def _all_have_enough(target: TargetRequest, crew: _Crew, visits: Sequence[int]) -> str:
    """Each UAV that could do it alone has its most: which they are, where they are few."""
    if target.uav:
        return f"It is tied to {target.uav}, which has as many targets as it may have."
    able = np.asarray(crew.within[:, list(visits)].any(axis=1))
    if len(crew.uavs) != len(able) or able.sum() > MOST_NAMED:  # a UAV may have been put out of service meanwhile
        fitting = f"Each UAV with the sensor {target.sensor}" if target.sensor else "Each UAV"
        return f"{fitting} that has the range for it has as many targets as it may have."
    full = [uav for uav, is_able in zip(crew.uavs, able, strict=True) if is_able]
    far = any(may_do(uav, target) for uav, is_able in zip(crew.uavs, able, strict=True) if not is_able)
    rest = ", and no other UAV has the range for it." if far else "."
    if len(full) == 1:
        return f"{full[0].name} has as many targets as it may have ({full[0].most_targets}){rest}"
    return f"{', '.join(uav.name for uav in full[:-1])} and {full[-1].name} have as many targets as they may have{rest}"


def _way_barred(place: Place, item: Unassigned, problem: Problem, visits: Sequence[int], ways: Ways, scene: Scene) -> tuple[str, str]:
    """Where the solver found no way, whether that is the distance to the network or the zones around."""
    if item.reason is not Reason.NO_PATH or not ways.uavs:
        return item.reason.value, item.message
    if _is_stopped_by_wind(problem, visits):
        return WIND, TOO_STRONG
    reach = f"{scene.access.access_leg_m / 1_000:g} km"
    if not any(ways.entry_legs[visit] for visit in visits):
        if any(is_near_network(scene.graph, end, scene.access.access_leg_m) for end in (place.course[0], place.course[-1])):
            return Reason.NO_PATH.value, f"Every straight way to it from the network within {reach} meets a no-fly zone."
        return "too_far_from_network", f"It is more than {reach} from the network."
    if not any(ways.uav_legs):
        return Reason.NO_PATH.value, f"No UAV has a clear way of up to {reach} to the network from where it stands."
    return item.reason.value, item.message


def _is_stopped_by_wind(problem: Problem, visits: Sequence[int]) -> bool:
    """Whether a way is there, but none in this wind."""
    if problem.seconds is None:
        return False
    uavs = tuple(replace(uav, usable_wh=None) for uav in problem.uavs)
    calm = replace(problem, uavs=uavs, objective=Objective.TOTAL, seconds=None, wh=None)
    in_wind, without = (bool(np.isfinite(needed_range_m(one)[:, list(visits)]).any()) for one in (problem, calm))
    return without and not in_wind
