"""Plans improved by taking strings of targets out and putting them back, worse ones accepted as in annealing.

Slack induction by string removals: J. Christiaens, G. Vanden Berghe, Transportation Science 54 (2020). Here several strings may come
from one route, which helps where few UAVs fly many targets, and for the longest route the strings lie around it.
"""

import math

import numpy as np
from numba import njit

from planning.problem import IntArray
from planning.solver.exchanges import NONE, draw_move, make
from planning.solver.insertion import recreate
from planning.solver.objective import cost_of, cost_of_routes, is_better, is_wanted, longest_of
from planning.solver.plan_state import (
    NO,
    NO_LIMIT_M,
    Workspace,
    copy_plan,
    copy_route,
    draw,
    draw_below,
    keeps_further_limits,
    raw_workspace,
    save,
    settle,
    values,
)
from planning.solver.problem_arrays import ProblemArrays, raw_problem

MEAN_REMOVED = 10.0
MAX_STRING_LENGTH = 10.0
SPLIT_SHARE = 0.5  # how often a string keeps some targets in its middle
KEEP_SHARE = 0.01  # how often one more of them is let go
AROUND_MAX_SHARE = 0.5
MOVES_FOR_TOTAL, MOVES_FOR_LONGEST = 20, 4  # in each round; for the longest route, taking out and putting back brings more
NEAR_SHARE = 0.9  # how often a place is looked for beside neighbours and at the ends of routes alone


@njit(cache=True, nogil=True)
def construct(problem: ProblemArrays, work: Workspace, power: int, tries: int) -> None:
    """Fill the empty plan from several orders of insertion; the best stays, as the current and the best plan."""
    scale = 1e-9
    for visit in range(len(problem.target)):
        for uav in range(len(problem.usable)):
            if problem.usable[uav, visit]:
                scale = max(scale, min(problem.far_m[problem.target[visit]], NO_LIMIT_M) / problem.speed_mps[uav])
    plan = work.plan
    for number in range(tries):
        for uav in range(len(plan.size)):
            plan.size[uav] = 0
            settle(problem, plan, uav)
        plan.uav_of[:] = -1
        for target in range(len(plan.uav_of)):
            work.waiting[target] = target
        work.is_saved[:] = True
        recreate(problem, work, len(plan.uav_of), number % 3, power, scale, NO)
        for uav in range(len(plan.size)):
            settle(problem, plan, uav)
        if number == 0 or is_better(problem, plan, work.best):
            copy_plan(plan, work.best)
    copy_plan(work.best, work.plan)


@njit(cache=True, nogil=True)
def begin_at(problem: ProblemArrays, work: Workspace, visit: IntArray, size: IntArray) -> bool:
    """Make a plan the current one, and the best one, if it keeps all limits and is better than the best; returns whether it was.

    visit (u, t): of each UAV the first size[u] are its visits.
    """
    plan = work.plan
    plan.uav_of[:] = -1
    for uav in range(len(size)):
        plan.visit[uav, : size[uav]] = visit[uav, : size[uav]]
        plan.size[uav] = size[uav]
    work.is_saved[:] = True
    if _is_whole(problem, work) and is_better(problem, plan, work.best):
        copy_plan(plan, work.best)
        return True
    copy_plan(work.best, plan)
    return False


@njit(cache=True, nogil=True)
def anneal(problem: ProblemArrays, work: Workspace, rounds: int, warm: float, cold: float, power: int) -> None:
    """So many rounds of moves, taking out and putting back, the temperature falling from warm to cold, in units of the cost."""
    _anneal(raw_problem(problem), raw_workspace(work), rounds, warm, cold, power)


@njit(cache=True, nogil=True)
def _anneal(problem: ProblemArrays, work: Workspace, rounds: int, warm: float, cold: float, power: int) -> None:
    plan = work.plan
    scale = max(1e-9, values(problem, work.best)[2])
    missed, cost = cost_of(problem, plan, power, scale)
    best_missed, best_total_m, _ = values(problem, work.best)
    cooling = math.exp(math.log(cold / warm) / rounds) if rounds else 1.0
    moves = MOVES_FOR_LONGEST if problem.is_makespan else MOVES_FOR_TOTAL
    temperature = warm
    for _ in range(rounds):
        temperature *= cooling
        for _ in range(moves):
            longest = -1
            if problem.is_makespan and draw(work.random) < AROUND_MAX_SHARE:
                longest = longest_of(problem, plan)
            if longest >= 0 and plan.size[longest] == 0:
                break
            move = draw_move(problem, plan, work.random, longest)
            if move.kind == NONE or not is_wanted(problem, plan, move, cost, temperature, power, scale, work.random):
                continue
            copy_route(plan, work.saved, move.uav)
            copy_route(plan, work.saved, move.other_uav)
            make(problem, plan, work.saved, move)
            settle(problem, plan, move.uav)
            settle(problem, plan, move.other_uav)
            if problem.is_limited and not (
                keeps_further_limits(problem, plan, move.uav) and keeps_further_limits(problem, plan, move.other_uav)
            ):
                _take_back(problem, work, move.uav)
                _take_back(problem, work, move.other_uav)
                continue
            cost = cost_of_routes(problem, plan, power, scale)
            if (problem.is_makespan or missed < best_missed or cost < best_total_m) and is_better(problem, plan, work.best):
                copy_plan(plan, work.best)
                best_missed, best_total_m, _ = values(problem, plan)
        work.is_saved[:] = False
        count = _ruin(problem, work)
        left_out = count
        for target in range(len(plan.uav_of)):
            if plan.uav_of[target] < 0 and not work.is_removed[target]:
                work.waiting[count] = target
                count += 1
        for place in range(left_out):
            work.is_removed[work.waiting[place]] = False
        dice = draw(work.random)
        recreate(problem, work, count, 0 if dice < 0.6 else (1 if dice < 0.85 else 2), power, scale, draw(work.random) < NEAR_SHARE)
        now_missed, now_cost = np.inf, np.inf
        if _is_whole(problem, work):
            now_missed, now_cost = cost_of(problem, plan, power, scale)
        if now_missed < missed or (now_missed == missed and now_cost < cost - temperature * math.log(1.0 - draw(work.random))):
            missed, cost = now_missed, now_cost
            if (problem.is_makespan or missed < best_missed or cost < best_total_m) and is_better(problem, plan, work.best):
                copy_plan(plan, work.best)
                best_missed, best_total_m, _ = values(problem, plan)
        else:
            for place in range(count):
                plan.uav_of[work.waiting[place]] = -1
            for uav in range(len(plan.size)):
                if work.is_saved[uav]:
                    _take_back(problem, work, uav)


@njit(cache=True, nogil=True)
def _take_back(problem: ProblemArrays, work: Workspace, uav: int) -> None:
    """The route as it was saved."""
    plan = work.plan
    copy_route(work.saved, plan, uav)
    for place in range(plan.size[uav]):
        target = problem.target[plan.visit[uav, place]]
        plan.uav_of[target], plan.place[target] = uav, place


@njit(cache=True, nogil=True)
def _is_whole(problem: ProblemArrays, work: Workspace) -> bool:
    """Whether the changed routes, measured anew, keep their limits."""
    for uav in range(len(work.is_saved)):
        if work.is_saved[uav]:
            settle(problem, work.plan, uav)
            if work.plan.length_m[uav] > problem.limit_m[uav] or work.plan.done[uav] > problem.most[uav]:
                return False
            if problem.is_limited and not keeps_further_limits(problem, work.plan, uav):
                return False
            for place in range(work.plan.size[uav]):
                if not problem.usable[uav, work.plan.visit[uav, place]]:
                    return False
    return True


@njit(cache=True, nogil=True)
def _ruin(problem: ProblemArrays, work: Workspace) -> int:
    """Take strings out around one target; returns how many targets wait now."""
    plan, random = work.plan, work.random
    targets, uavs = len(plan.uav_of), len(plan.size)
    flown, flying = 0, 0
    for uav in range(uavs):
        flown += plan.size[uav]
        flying += 1 if plan.size[uav] else 0
    if not flown:
        return 0
    longest_string = min(MAX_STRING_LENGTH, flown / flying)
    most_strings = 4.0 * MEAN_REMOVED / (1.0 + longest_string) - 1.0
    strings = int(draw(random) * most_strings + 1.0)
    seed = draw_below(random, targets)
    if problem.is_makespan and draw(random) < AROUND_MAX_SHARE:
        longest = longest_of(problem, plan)
        seed = problem.target[plan.visit[longest, draw_below(random, plan.size[longest])]]
    waiting = 0
    for number in range(problem.near.shape[1]):
        if strings == 0:
            break
        target = problem.near[seed, number]
        uav = plan.uav_of[target]
        if uav < 0 or work.is_removed[target]:
            continue
        count = plan.size[uav]
        length = int(draw(random) * min(float(count), longest_string) + 1.0)
        kept = 0
        if length > 1 and draw(random) < SPLIT_SHARE:
            while length + kept < count and draw(random) > KEEP_SHARE:
                kept += 1
                if draw(random) < 0.5:
                    break
        whole = min(count, length + kept)
        place = plan.place[target]
        earliest, latest = max(0, place - whole + 1), min(place, count - whole)
        begin = earliest + draw_below(random, latest - earliest + 1)
        kept_from = begin + 1 + draw_below(random, length - 1) if kept else -1
        for at in range(begin, begin + whole):
            if kept and kept_from <= at < kept_from + kept:
                continue
            out = problem.target[plan.visit[uav, at]]
            if not work.is_removed[out]:
                work.is_removed[out] = True
                work.waiting[waiting] = out
                waiting += 1
        save(work, uav)
        strings -= 1
    for uav in range(uavs):
        if work.is_saved[uav]:
            stay = 0
            for at in range(plan.size[uav]):
                visit = plan.visit[uav, at]
                if not work.is_removed[problem.target[visit]]:
                    plan.visit[uav, stay] = visit
                    stay += 1
            plan.size[uav] = stay
            settle(problem, plan, uav)
    for number in range(waiting):
        plan.uav_of[work.waiting[number]] = -1
    return waiting
