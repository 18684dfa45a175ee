"""Targets put into a plan where they cost least."""

import math

import numpy as np
from numba import njit

from planning.solver.objective import raised_to
from planning.solver.plan_state import (
    ABSENT,
    FIRST,
    NO_LIMIT_M,
    PlanState,
    RandomState,
    Workspace,
    done_on_other_sorties,
    draw,
    duration_s,
    save,
    settle,
)
from planning.solver.problem_arrays import ProblemArrays

BLINK_SHARE = 0.01  # how often a place is overlooked
INSERTION_NEIGHBOURS = 20  # beside which a place is looked for
METRES = -1  # in place of a power: the price is the metres


@njit(cache=True, nogil=True)
def recreate(problem: ProblemArrays, work: Workspace, waiting: int, kind: int, power: int, scale: float, is_near: bool) -> None:
    """Put in what waits where it costs least: the heavy first, else at random, the far first or the near first."""
    plan = work.plan
    if not problem.is_makespan:
        power = METRES
    for number in range(waiting):
        target = work.waiting[number]
        if kind == 0:
            work.key[number] = draw(work.random)
        elif kind == 1:
            work.key[number] = -problem.far_m[target]
        else:
            work.key[number] = problem.far_m[target]
    for number in range(1, waiting):
        target, key = work.waiting[number], work.key[number]
        weight = problem.weight[target]
        place = number
        while place > 0:
            other = problem.weight[work.waiting[place - 1]]
            if other > weight or (other == weight and work.key[place - 1] <= key):
                break
            work.waiting[place], work.key[place] = work.waiting[place - 1], work.key[place - 1]
            place -= 1
        work.waiting[place], work.key[place] = target, key
    again = True
    while again:  # a target that came later may have joined two networks
        again = False
        is_first = True
        for number in range(waiting):
            if plan.uav_of[work.waiting[number]] < 0:
                target = work.waiting[number]
                if _insert(problem, work, target, power, scale, is_near) or (
                    is_near and _insert(problem, work, target, power, scale, not is_near)
                ):
                    again = again or not is_first
                else:
                    is_first = False


@njit(cache=True, nogil=True)
def _insert(problem: ProblemArrays, work: Workspace, target: int, power: int, scale: float, is_near: bool) -> bool:
    """Put a target in where it costs least: beside its neighbours and at the ends of routes, or anywhere."""
    plan = work.plan
    least, least_m, at_uav, at_place, at_visit = np.inf, 0.0, ABSENT, FIRST, FIRST
    blink = _next_blink(work.random)
    if problem.has_sorties and problem.is_makespan:
        _look_beside(problem, work)
    for index in range(problem.option_from[target], problem.option_from[target + 1]):
        visit = problem.option[index]
        for uav in range(len(plan.size)):
            if not problem.usable[uav, visit] or plan.done[uav] + problem.done[visit] > problem.most[uav]:
                continue
            if problem.has_sorties and _is_of_no_use(problem, plan, uav, visit):
                continue
            onward_m, back_m = problem.onward_m[problem.class_of[uav], visit], problem.back_m[problem.class_of[uav], visit]
            count = plan.size[uav]
            if count == 0:
                added_m, best_place = problem.first_m[uav, visit] + problem.end_m[uav, visit], 0
            else:
                added_m = problem.first_m[uav, visit] + onward_m[plan.visit[uav, 0]] - plan.gap_m[uav, 0]
                best_place = 0
            if problem.is_limited and not _fits(problem, plan, uav, visit, FIRST):
                added_m = math.inf
            if count:
                last_m = back_m[plan.visit[uav, count - 1]] + problem.end_m[uav, visit] - plan.gap_m[uav, count]
                if last_m < added_m and not (problem.is_limited and not _fits(problem, plan, uav, visit, count)):
                    added_m, best_place = last_m, count
                for place in range(1, 1 if is_near else count):
                    here_m = back_m[plan.visit[uav, place - 1]] + onward_m[plan.visit[uav, place]] - plan.gap_m[uav, place]
                    if here_m < added_m and not (problem.is_limited and not _fits(problem, plan, uav, visit, place)):
                        if blink == 0:
                            blink = _next_blink(work.random)
                        else:
                            added_m, best_place = here_m, place
                            blink -= 1
            if added_m == math.inf or (added_m >= least and not problem.is_makespan):
                continue
            price = _price(problem, work, uav, visit, added_m, power, scale)
            if price < least:
                least, least_m, at_uav, at_place, at_visit = price, added_m, uav, best_place, visit
        for number in range(1, min(problem.near.shape[1], INSERTION_NEIGHBOURS + 1) if is_near else 1):
            other = problem.near[target, number]
            uav = plan.uav_of[other]
            if uav < 0:
                continue
            onward_m, back_m = problem.onward_m[problem.class_of[uav], visit], problem.back_m[problem.class_of[uav], visit]
            for place in range(max(1, plan.place[other]), min(plan.size[uav], plan.place[other] + 2)):
                added_m = back_m[plan.visit[uav, place - 1]] + onward_m[plan.visit[uav, place]] - plan.gap_m[uav, place]
                if added_m >= least and not problem.is_makespan:
                    continue
                if not problem.usable[uav, visit] or plan.done[uav] + problem.done[visit] > problem.most[uav]:
                    break
                if problem.has_sorties and _is_of_no_use(problem, plan, uav, visit):
                    break
                if problem.is_limited and not _fits(problem, plan, uav, visit, place):
                    continue
                price = _price(problem, work, uav, visit, added_m, power, scale)
                if price < least:
                    if blink == 0:
                        blink = _next_blink(work.random)
                    else:
                        least, least_m, at_uav, at_place, at_visit = price, added_m, uav, place, visit
                        blink -= 1
    if at_uav < 0 or (least_m > NO_LIMIT_M):
        return False
    save(work, at_uav)
    _put(problem, plan, at_uav, at_place, at_visit, least_m)
    return True


@njit(cache=True, nogil=True)
def _next_blink(random: RandomState) -> int:
    """How many places are looked at before one is overlooked."""
    return int(-math.log(1.0 - draw(random)) / BLINK_SHARE)


@njit(cache=True, nogil=True, inline="always")  # a plan handed on costs more than the price, and so does a branch in here
def _price(problem: ProblemArrays, work: Workspace, uav: int, visit: int, added_m: float, power: int, scale: float) -> float:
    """What a visit costs that makes a route so much longer; inf if the UAV cannot fly as far."""
    length_m, service_s = work.plan.length_m[uav], work.plan.service_s[uav] + work.beside_s[uav]
    limit_m, speed_mps, added_s = problem.limit_m[uav], problem.speed_mps[uav], problem.service_s[visit] + work.opened_s[uav]
    return _price_of(length_m, service_s, added_m, added_s, limit_m, speed_mps, power, scale)


@njit(cache=True, nogil=True)
def _price_of(
    length_m: float, work_s: float, added_m: float, service_s: float, limit_m: float, speed_mps: float, power: int, scale: float
) -> float:
    if length_m + added_m > limit_m and not (length_m > NO_LIMIT_M and added_m < 0.0):
        return math.inf
    if power == METRES:
        return added_m
    now_s = duration_s(length_m, speed_mps, work_s)
    later_s = now_s + added_m / speed_mps + service_s
    return raised_to(later_s / scale, power) - raised_to(now_s / scale, power) + 1e-7 * (later_s - now_s) / scale


@njit(cache=True, nogil=True)
def _look_beside(problem: ProblemArrays, work: Workspace) -> None:
    """Fill in what the UAV's other sorties add to each, and what an empty one begins with beyond what it counts."""
    plan = work.plan
    for uav in range(len(plan.size)):
        beside_s = 0.0
        for other in range(problem.first_of[uav], problem.end_of[uav]):
            if other != uav and (plan.size[other] or other == problem.first_of[uav]):
                beside_s += duration_s(plan.length_m[other], problem.speed_mps[other], plan.service_s[other])
        work.opened_s[uav] = 0.0 if plan.size[uav] or uav == problem.first_of[uav] else plan.service_s[uav]
        work.beside_s[uav] = beside_s - work.opened_s[uav]


@njit(cache=True, nogil=True)
def _is_of_no_use(problem: ProblemArrays, plan: PlanState, uav: int, visit: int) -> bool:
    """Whether the UAV has done enough on all its sorties, or has an earlier one that is as empty."""
    if plan.size[uav] == 0 and uav > problem.first_of[uav] and plan.size[uav - 1] == 0:
        return True
    done = done_on_other_sorties(problem, plan, uav) + plan.done[uav] + problem.done[visit]
    return bool(done > problem.most[uav])


@njit(cache=True, nogil=True, inline="always")
def _fits(problem: ProblemArrays, plan: PlanState, uav: int, visit: int, place: int) -> bool:
    """Whether the route keeps what is limited beside what the objective counts; one that has no way somewhere may be mended."""
    count, number = plan.size[uav], problem.class_of[uav]
    for at in range(len(problem.more_limit)):
        left = plan.visit[uav, place - 1] if place > 0 else -1
        right = plan.visit[uav, place] if place < count else -1
        more = problem.more_first[at, uav, visit] if left < 0 else problem.more_onward[at, number, left, visit]
        more += problem.more_end[at, uav, visit] if right < 0 else problem.more_onward[at, number, visit, right]
        if count:
            if left < 0:
                more -= problem.more_first[at, uav, right]
            elif right < 0:
                more -= problem.more_end[at, uav, left]
            else:
                more -= problem.more_onward[at, number, left, right]
        taken = plan.taken[uav, at]
        if taken + more > problem.more_limit[at, uav] and not (taken > NO_LIMIT_M and more < 0.0):
            return False
    return True


@njit(cache=True, nogil=True)
def _put(problem: ProblemArrays, plan: PlanState, uav: int, place: int, visit: int, added_m: float) -> None:
    count, route, gap_m = plan.size[uav], plan.visit[uav], plan.gap_m[uav]
    gap_m[count + 1] = gap_m[count]
    for at in range(count, place, -1):
        route[at], gap_m[at] = route[at - 1], gap_m[at - 1]
        plan.place[problem.target[route[at]]] = at
    route[place] = visit
    plan.place[problem.target[visit]] = place
    number = problem.class_of[uav]
    gap_m[place] = problem.first_m[uav, visit] if place == 0 else problem.onward_m[number, route[place - 1], visit]
    gap_m[place + 1] = problem.end_m[uav, visit] if place == count else problem.onward_m[number, visit, route[place + 1]]
    plan.size[uav] = count + 1
    plan.length_m[uav] += added_m
    plan.service_s[uav] += problem.service_s[visit]
    plan.done[uav] += problem.done[visit]
    plan.uav_of[problem.target[visit]] = uav
    if problem.is_limited:
        settle(problem, plan, uav)
