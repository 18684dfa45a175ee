"""Plans improved by taking strings of targets out and putting them back, worse ones accepted as in annealing.

Slack induction by string removals: J. Christiaens, G. Vanden Berghe, Transportation Science 54 (2020). Here several strings may come
from one route, which helps where few UAVs fly many targets, and for the longest route the strings lie around it.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from missions.routing.arcs import IntArray
from missions.routing.crossing import NONE, Move, added_m, draw_move, make, measured
from missions.routing.plan_state import (
    NO_LIMIT_M,
    Ground,
    Plan,
    RandomState,
    copy_plan,
    copy_route,
    draw,
    draw_below,
    empty_plan,
    settle,
    values,
)
from missions.routing.problem import BoolArray, FloatArray
from missions.routing.unowned import unowned

MEAN_REMOVED = 10.0
LONGEST_STRING = 10.0
SPLIT_SHARE = 0.5  # how often a string keeps some targets in its middle
KEEP_SHARE = 0.01  # how often one more of them is let go
BLINK_SHARE = 0.01  # how often a place is overlooked
AROUND_LONGEST_SHARE = 0.5
MOVES = 20  # in each round
HAIR_M = 1e-4  # by which a move stays within the limits: its metres are sums and differences
INSERTION_NEIGHBOURS = 20  # beside which a place is looked for
NEAR_SHARE = 0.9  # how often a place is looked for there and at the ends of routes alone
EVENNESS = 1e-3  # what the mean route weighs beside the longest


class Workspace(NamedTuple):
    """The current plan, the best one, and room to work in."""

    plan: Plan
    best: Plan
    saved: Plan
    is_saved: BoolArray  # (u,)
    is_removed: BoolArray  # (t,)
    waiting: IntArray  # (t,) targets to be put in
    key: FloatArray  # (t,) their order
    random: RandomState


def workspace(uavs: int, targets: int, seed: int) -> Workspace:
    return Workspace(
        empty_plan(uavs, targets),
        empty_plan(uavs, targets),
        empty_plan(uavs, targets),
        np.zeros(uavs, dtype=np.bool_),
        np.zeros(targets, dtype=np.bool_),
        np.zeros(targets, dtype=np.int64),
        np.zeros(targets),
        np.array([(seed * 2 + 1) * 0x9E3779B97F4A7C15 & 0xFFFFFFFFFFFFFFFF], dtype=np.uint64),
    )


@njit(cache=True, nogil=True)
def construct(ground: Ground, work: Workspace, power: int, tries: int) -> None:
    """Fill the empty plan from several orders of insertion; the best stays, as the current and the best plan."""
    scale = 1e-9
    for visit in range(len(ground.target)):
        for uav in range(len(ground.usable)):
            if ground.usable[uav, visit]:
                scale = max(scale, min(ground.far_m[ground.target[visit]], NO_LIMIT_M) / ground.speed_mps[uav])
    plan = work.plan
    for number in range(tries):
        for uav in range(len(plan.size)):
            plan.size[uav] = 0
            settle(ground, plan, uav)
        plan.uav_of[:] = -1
        for target in range(len(plan.uav_of)):
            work.waiting[target] = target
        work.is_saved[:] = True
        _recreate(ground, work, len(plan.uav_of), number % 3, power, scale, False)
        for uav in range(len(plan.size)):
            settle(ground, plan, uav)
        if number == 0 or _is_better(ground, plan, work.best):
            copy_plan(plan, work.best)
    copy_plan(work.best, work.plan)


@njit(cache=True, nogil=True)
def anneal(ground: Ground, work: Workspace, rounds: int, warm: float, cold: float, power: int) -> None:
    """So many rounds of moves, taking out and putting back, the temperature falling from warm to cold, in units of the cost."""
    ground, work = unowned(ground), unowned(work)
    plan = work.plan
    scale = max(1e-9, values(ground, work.best)[2])
    missed, cost = _cost(ground, plan, power, scale)
    best_missed, best_total_m, _ = values(ground, work.best)
    cooling = math.exp(math.log(cold / warm) / rounds) if rounds else 1.0
    temperature = warm
    for _ in range(rounds):
        temperature *= cooling
        for _ in range(MOVES):
            longest = -1
            if ground.is_makespan and draw(work.random) < AROUND_LONGEST_SHARE:
                longest = _longest(ground, plan)
            if longest >= 0 and plan.size[longest] == 0:
                break
            move = draw_move(ground, plan, work.random, longest)
            if move.kind == NONE or not _is_wanted(ground, plan, move, cost, temperature, power, scale, work.random):
                continue
            copy_route(plan, work.saved, move.uav)
            copy_route(plan, work.saved, move.other_uav)
            make(ground, plan, work.saved, move)
            settle(ground, plan, move.uav)
            settle(ground, plan, move.other_uav)
            cost = _cost_of_routes(ground, plan, power, scale)
            if (ground.is_makespan or missed < best_missed or cost < best_total_m) and _is_better(ground, plan, work.best):
                copy_plan(plan, work.best)
                best_missed, best_total_m, _ = values(ground, plan)
        work.is_saved[:] = False
        count = _ruin(ground, work)
        left_out = count
        for target in range(len(plan.uav_of)):
            if plan.uav_of[target] < 0 and not work.is_removed[target]:
                work.waiting[count] = target
                count += 1
        for place in range(left_out):
            work.is_removed[work.waiting[place]] = False
        dice = draw(work.random)
        _recreate(ground, work, count, 0 if dice < 0.6 else (1 if dice < 0.85 else 2), power, scale, draw(work.random) < NEAR_SHARE)
        now_missed, now_cost = np.inf, np.inf
        if _is_whole(ground, work):
            now_missed, now_cost = _cost(ground, plan, power, scale)
        if now_missed < missed or (now_missed == missed and now_cost < cost - temperature * math.log(1.0 - draw(work.random))):
            missed, cost = now_missed, now_cost
            if (ground.is_makespan or missed < best_missed or cost < best_total_m) and _is_better(ground, plan, work.best):
                copy_plan(plan, work.best)
                best_missed, best_total_m, _ = values(ground, plan)
        else:
            for place in range(count):
                plan.uav_of[work.waiting[place]] = -1
            for uav in range(len(plan.size)):
                if work.is_saved[uav]:
                    copy_route(work.saved, plan, uav)
                    for place in range(plan.size[uav]):
                        target = ground.target[plan.visit[uav, place]]
                        plan.uav_of[target], plan.place[target] = uav, place


@njit(cache=True, nogil=True)
def _is_wanted(
    ground: Ground, plan: Plan, move: Move, cost: float, temperature: float, power: int, scale: float, random: RandomState
) -> bool:
    """Whether a move keeps the limits, and is accepted at this temperature."""
    uav, other_uav = move.uav, move.other_uav
    most_cost = cost - temperature * math.log(1.0 - draw(random))
    if not ground.is_makespan and cost + added_m(ground, plan, move) >= most_cost:
        return False
    new = measured(ground, plan, move)
    if new.length_m > ground.limit_m[uav] - HAIR_M or new.other_length_m > ground.limit_m[other_uav] - HAIR_M:
        return False
    if new.done > ground.most[uav] or new.other_done > ground.most[other_uav]:
        return False
    if not ground.is_makespan:
        return True
    raised, total_s = 0.0, 0.0
    for number in range(len(plan.size)):
        if number == uav:
            duration_s = new.length_m / ground.speed_mps[uav] + new.service_s
        elif number == other_uav:
            duration_s = new.other_length_m / ground.speed_mps[other_uav] + new.other_service_s
        else:
            duration_s = plan.length_m[number] / ground.speed_mps[number] + plan.service_s[number]
        total_s += duration_s
        raised += _raised(duration_s / scale, power)
    return scale * raised ** (1.0 / (1 << power)) + EVENNESS * total_s / len(plan.size) < most_cost


@njit(cache=True, nogil=True)
def _is_better(ground: Ground, plan: Plan, best: Plan) -> bool:
    missed, total_m, longest_s = values(ground, plan)
    best_missed, best_total_m, best_longest_s = values(ground, best)
    if missed != best_missed:
        return missed < best_missed
    if ground.is_makespan:
        return longest_s < best_longest_s - 1e-9 or (longest_s <= best_longest_s and total_m < best_total_m - 1e-6)
    return total_m < best_total_m - 1e-6


@njit(cache=True, nogil=True)
def _cost(ground: Ground, plan: Plan, power: int, scale: float) -> tuple[float, float]:
    """What is left out by weight; the total [m], or a mean of the routes [s] that follows the longest the more the higher the power.

    The power is that of 2 that all durations are raised to.
    """
    missed = 0.0
    for target in range(len(plan.uav_of)):
        if plan.uav_of[target] < 0:
            missed += ground.weight[target]
    return missed, _cost_of_routes(ground, plan, power, scale)


@njit(cache=True, nogil=True)
def _cost_of_routes(ground: Ground, plan: Plan, power: int, scale: float) -> float:
    total = 0.0
    if not ground.is_makespan:
        for uav in range(len(plan.size)):
            total += plan.length_m[uav]
        return total
    raised = 0.0
    for uav in range(len(plan.size)):
        duration = plan.length_m[uav] / ground.speed_mps[uav] + plan.service_s[uav]
        total += duration
        raised += _raised(duration / scale, power)
    return scale * raised ** (1.0 / (1 << power)) + EVENNESS * total / len(plan.size)


@njit(cache=True, nogil=True)
def _raised(share: float, power: int) -> float:
    for _ in range(power):
        share *= share
    return share


@njit(cache=True, nogil=True)
def _is_whole(ground: Ground, work: Workspace) -> bool:
    """Whether the changed routes, measured anew, keep their limits."""
    for uav in range(len(work.is_saved)):
        if work.is_saved[uav]:
            settle(ground, work.plan, uav)
            if work.plan.length_m[uav] > ground.limit_m[uav] or work.plan.done[uav] > ground.most[uav]:
                return False
            for place in range(work.plan.size[uav]):
                if not ground.usable[uav, work.plan.visit[uav, place]]:
                    return False
    return True


@njit(cache=True, nogil=True)
def _save(work: Workspace, uav: int) -> None:
    if not work.is_saved[uav]:
        work.is_saved[uav] = True
        copy_route(work.plan, work.saved, uav)


@njit(cache=True, nogil=True)
def _longest(ground: Ground, plan: Plan) -> int:
    """The UAV that flies longest."""
    longest, longest_s = 0, -1.0
    for uav in range(len(plan.size)):
        duration_s = plan.length_m[uav] / ground.speed_mps[uav] + plan.service_s[uav]
        if duration_s > longest_s and plan.size[uav]:
            longest, longest_s = uav, duration_s
    return longest


@njit(cache=True, nogil=True)
def _ruin(ground: Ground, work: Workspace) -> int:
    """Take strings out around one target; returns how many targets wait now."""
    plan, random = work.plan, work.random
    targets, uavs = len(plan.uav_of), len(plan.size)
    flown, flying = 0, 0
    for uav in range(uavs):
        flown += plan.size[uav]
        flying += 1 if plan.size[uav] else 0
    if not flown:
        return 0
    longest_string = min(LONGEST_STRING, flown / flying)
    most_strings = 4.0 * MEAN_REMOVED / (1.0 + longest_string) - 1.0
    strings = int(draw(random) * most_strings + 1.0)
    seed = draw_below(random, targets)
    if ground.is_makespan and draw(random) < AROUND_LONGEST_SHARE:
        longest = _longest(ground, plan)
        seed = ground.target[plan.visit[longest, draw_below(random, plan.size[longest])]]
    waiting = 0
    for number in range(ground.near.shape[1]):
        if strings == 0:
            break
        target = ground.near[seed, number]
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
            out = ground.target[plan.visit[uav, at]]
            if not work.is_removed[out]:
                work.is_removed[out] = True
                work.waiting[waiting] = out
                waiting += 1
        _save(work, uav)
        strings -= 1
    for uav in range(uavs):
        if work.is_saved[uav]:
            stay = 0
            for at in range(plan.size[uav]):
                visit = plan.visit[uav, at]
                if not work.is_removed[ground.target[visit]]:
                    plan.visit[uav, stay] = visit
                    stay += 1
            plan.size[uav] = stay
            settle(ground, plan, uav)
    for number in range(waiting):
        plan.uav_of[work.waiting[number]] = -1
    return waiting


@njit(cache=True, nogil=True)
def _recreate(ground: Ground, work: Workspace, waiting: int, kind: int, power: int, scale: float, is_near: bool) -> None:
    """Put in what waits where it costs least: the heavy first, else at random, the far first or the near first."""
    plan = work.plan
    for number in range(waiting):
        target = work.waiting[number]
        if kind == 0:
            work.key[number] = draw(work.random)
        elif kind == 1:
            work.key[number] = -ground.far_m[target]
        else:
            work.key[number] = ground.far_m[target]
    for number in range(1, waiting):
        target, key = work.waiting[number], work.key[number]
        weight = ground.weight[target]
        place = number
        while place > 0:
            other = ground.weight[work.waiting[place - 1]]
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
                if (is_near and _insert(ground, work, target, power, scale, True)) or _insert(ground, work, target, power, scale, False):
                    again = again or not is_first
                else:
                    is_first = False


@njit(cache=True, nogil=True)
def _insert(ground: Ground, work: Workspace, target: int, power: int, scale: float, is_near: bool) -> bool:
    """Put a target in where it costs least: beside its neighbours and at the ends of routes, or anywhere."""
    plan = work.plan
    least, least_m, at_uav, at_place, at_visit = np.inf, 0.0, -1, 0, 0
    blink = int(-math.log(1.0 - draw(work.random)) / BLINK_SHARE)
    for index in range(ground.option_from[target], ground.option_from[target + 1]):
        visit = ground.option[index]
        onward_m, back_m = ground.onward_m[visit], ground.back_m[visit]
        for uav in range(len(plan.size)):
            if not ground.usable[uav, visit] or plan.done[uav] + ground.done[visit] > ground.most[uav]:
                continue
            count = plan.size[uav]
            if count == 0:
                added_m, best_place = ground.first_m[uav, visit] + ground.end_m[uav, visit], 0
            else:
                added_m = ground.first_m[uav, visit] + onward_m[plan.visit[uav, 0]] - plan.gap_m[uav, 0]
                best_place = 0
                last_m = back_m[plan.visit[uav, count - 1]] + ground.end_m[uav, visit] - plan.gap_m[uav, count]
                if last_m < added_m:
                    added_m, best_place = last_m, count
                for place in range(1, 1 if is_near else count):
                    here_m = back_m[plan.visit[uav, place - 1]] + onward_m[plan.visit[uav, place]] - plan.gap_m[uav, place]
                    if here_m < added_m:
                        if blink == 0:
                            blink = int(-math.log(1.0 - draw(work.random)) / BLINK_SHARE)
                        else:
                            added_m, best_place = here_m, place
                            blink -= 1
            if added_m >= least and not ground.is_makespan:
                continue
            price = _price(
                plan.length_m[uav],
                plan.service_s[uav],
                added_m,
                ground.service_s[visit],
                ground.limit_m[uav],
                ground.speed_mps[uav],
                ground.is_makespan,
                power,
                scale,
            )
            if price < least:
                least, least_m, at_uav, at_place, at_visit = price, added_m, uav, best_place, visit
        for number in range(1, min(ground.near.shape[1], INSERTION_NEIGHBOURS + 1) if is_near else 1):
            other = ground.near[target, number]
            uav = plan.uav_of[other]
            if uav < 0:
                continue
            for place in range(max(1, plan.place[other]), min(plan.size[uav], plan.place[other] + 2)):
                added_m = back_m[plan.visit[uav, place - 1]] + onward_m[plan.visit[uav, place]] - plan.gap_m[uav, place]
                if added_m >= least and not ground.is_makespan:
                    continue
                if not ground.usable[uav, visit] or plan.done[uav] + ground.done[visit] > ground.most[uav]:
                    break
                price = _price(
                    plan.length_m[uav],
                    plan.service_s[uav],
                    added_m,
                    ground.service_s[visit],
                    ground.limit_m[uav],
                    ground.speed_mps[uav],
                    ground.is_makespan,
                    power,
                    scale,
                )
                if price < least:
                    if blink == 0:
                        blink = int(-math.log(1.0 - draw(work.random)) / BLINK_SHARE)
                    else:
                        least, least_m, at_uav, at_place, at_visit = price, added_m, uav, place, visit
                        blink -= 1
    if at_uav < 0 or (least_m > NO_LIMIT_M):
        return False
    _save(work, at_uav)
    _put(ground, plan, at_uav, at_place, at_visit, least_m)
    return True


@njit(cache=True, nogil=True)
def _price(
    length_m: float,
    work_s: float,
    added_m: float,
    service_s: float,
    limit_m: float,
    speed_mps: float,
    is_makespan: bool,
    power: int,
    scale: float,
) -> float:
    """What a visit costs that makes a route so much longer; inf if the UAV cannot fly as far."""
    if length_m + added_m > limit_m and not (length_m > NO_LIMIT_M and added_m < 0.0):
        return np.inf
    if not is_makespan:
        return added_m
    now_s = length_m / speed_mps + work_s
    later_s = now_s + added_m / speed_mps + service_s
    return _raised(later_s / scale, power) - _raised(now_s / scale, power) + 1e-7 * (later_s - now_s) / scale


@njit(cache=True, nogil=True)
def _put(ground: Ground, plan: Plan, uav: int, place: int, visit: int, added_m: float) -> None:
    count, route, gap_m = plan.size[uav], plan.visit[uav], plan.gap_m[uav]
    gap_m[count + 1] = gap_m[count]
    for at in range(count, place, -1):
        route[at], gap_m[at] = route[at - 1], gap_m[at - 1]
        plan.place[ground.target[route[at]]] = at
    route[place] = visit
    plan.place[ground.target[visit]] = place
    gap_m[place] = ground.first_m[uav, visit] if place == 0 else ground.onward_m[route[place - 1], visit]
    gap_m[place + 1] = ground.end_m[uav, visit] if place == count else ground.onward_m[visit, route[place + 1]]
    plan.size[uav] = count + 1
    plan.length_m[uav] += added_m
    plan.service_s[uav] += ground.service_s[visit]
    plan.done[uav] += ground.done[visit]
    plan.uav_of[ground.target[visit]] = uav
