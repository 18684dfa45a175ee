"""What a plan costs while it is searched for, and which changes of it are accepted."""

import math

from numba import njit

from planning.solver.exchanges import Measured, Move, added_m, measured
from planning.solver.plan_state import PlanState, RandomState, done_on_other_sorties, draw, duration_s, values
from planning.solver.problem_arrays import ProblemArrays

HAIR_M = 1e-4  # by which a move stays within the limits: its metres are sums and differences
EVENNESS = 1e-3  # what the mean route weighs beside the longest


@njit(cache=True, nogil=True)
def is_better(problem: ProblemArrays, plan: PlanState, best: PlanState) -> bool:
    missed, total_m, longest_s = values(problem, plan)
    best_missed, best_total_m, best_longest_s = values(problem, best)
    if missed != best_missed:
        return missed < best_missed
    if problem.is_makespan:
        return longest_s < best_longest_s - 1e-9 or (longest_s <= best_longest_s and total_m < best_total_m - 1e-6)
    return total_m < best_total_m - 1e-6


@njit(cache=True, nogil=True)
def cost_of(problem: ProblemArrays, plan: PlanState, power: int, scale: float) -> tuple[float, float]:
    """What is left out by weight; the total [m], or a mean of the routes [s] that follows the longest the more the higher the power.

    The power is that of 2 that all durations are raised to.
    """
    missed = 0.0
    for target in range(len(plan.uav_of)):
        if plan.uav_of[target] < 0:
            missed += problem.weight[target]
    return missed, cost_of_routes(problem, plan, power, scale)


@njit(cache=True, nogil=True)
def cost_of_routes(problem: ProblemArrays, plan: PlanState, power: int, scale: float) -> float:
    total = 0.0
    if not problem.is_makespan:
        for uav in range(len(plan.size)):
            total += plan.length_m[uav]
        return total
    raised, own_s = 0.0, 0.0
    for uav in range(len(plan.size)):
        if uav == problem.first_of[uav]:
            own_s = duration_s(plan.length_m[uav], problem.speed_mps[uav], plan.service_s[uav])
        elif plan.size[uav]:
            own_s += duration_s(plan.length_m[uav], problem.speed_mps[uav], plan.service_s[uav])
        if uav + 1 == problem.end_of[uav]:
            total += own_s
            raised += raised_to(own_s / scale, power)
    return _mean_s(len(plan.size), raised, total, power, scale)


@njit(cache=True, nogil=True)
def is_wanted(
    problem: ProblemArrays, plan: PlanState, move: Move, cost: float, temperature: float, power: int, scale: float, random: RandomState
) -> bool:
    """Whether a move keeps the limits, and is accepted at this temperature."""
    uav, other_uav = move.uav, move.other_uav
    most_cost = cost - temperature * math.log(1.0 - draw(random))
    if not problem.is_makespan and cost + added_m(problem, plan, move) >= most_cost:
        return False
    new = measured(problem, plan, move)
    if new.length_m > problem.limit_m[uav] - HAIR_M or new.other_length_m > problem.limit_m[other_uav] - HAIR_M:
        return False
    if new.done > problem.most[uav] or new.other_done > problem.most[other_uav]:
        return False
    if problem.has_sorties and _do_too_many(problem, plan, move, new):
        return False
    if not problem.is_makespan:
        return True
    raised, total_s, own_s = 0.0, 0.0, 0.0
    for number in range(len(plan.size)):
        done = plan.done[number]
        if number == uav:
            sortie_s, done = duration_s(new.length_m, problem.speed_mps[uav], new.service_s), new.done
        elif number == other_uav:
            sortie_s, done = duration_s(new.other_length_m, problem.speed_mps[other_uav], new.other_service_s), new.other_done
        else:
            sortie_s = duration_s(plan.length_m[number], problem.speed_mps[number], plan.service_s[number])
        if number == problem.first_of[number]:
            own_s = sortie_s
        elif done:
            own_s += sortie_s
        if number + 1 == problem.end_of[number]:
            total_s += own_s
            raised += raised_to(own_s / scale, power)
    return _mean_s(len(plan.size), raised, total_s, power, scale) < most_cost


@njit(cache=True, nogil=True)
def _do_too_many(problem: ProblemArrays, plan: PlanState, move: Move, new: Measured) -> bool:
    """Whether a UAV would do more targets than it may on all its sorties."""
    uav, other_uav = move.uav, move.other_uav
    if problem.first_of[uav] == problem.first_of[other_uav]:
        return False
    own, others = done_on_other_sorties(problem, plan, uav), done_on_other_sorties(problem, plan, other_uav)
    return bool(new.done + own > problem.most[uav] or new.other_done + others > problem.most[other_uav])


@njit(cache=True, nogil=True)
def _mean_s(uavs: int, raised: float, total_s: float, power: int, scale: float) -> float:
    """From the sums of the durations, raised and not: what follows the longest the more the higher the power."""
    return float(scale * raised ** (1.0 / (1 << power)) + EVENNESS * total_s / uavs)


@njit(cache=True, nogil=True)
def raised_to(share: float, power: int) -> float:
    for _ in range(power):
        share *= share
    return share


@njit(cache=True, nogil=True)
def longest_of(problem: ProblemArrays, plan: PlanState) -> int:
    """The UAV that flies longest; of its sorties the last."""
    longest, longest_s, own_s = 0, -1.0, 0.0
    for uav in range(len(plan.size)):
        if uav == problem.first_of[uav]:
            own_s = 0.0
        if plan.size[uav]:
            own_s += duration_s(plan.length_m[uav], problem.speed_mps[uav], plan.service_s[uav])
            if own_s > longest_s:
                longest, longest_s = uav, own_s
    return longest
