"""Lower bounds: what no plan can do better than, if it leaves out as little as the best one does."""

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numba import njit

from planning.problem import BoolArray, FloatArray, IntArray, Objective, Problem, Routes
from planning.solver import exact
from planning.solver.cost_matrices import NO_PATH_M
from planning.solver.problem_arrays import Arcs, no_burden
from planning.solver.reach import least_paths

SUBSET_TARGETS = 9
SUBSET_TRIALS = 60
ARC_LOOKS = 60_000_000  # how many arcs an ascent may look at, some tenths of a second
MIN_STEPS, MAX_STEPS = 100, 1_500
TIMEOUT = 20  # steps without a better bound before the steps get shorter
HAIR = 1e-9  # the share by which rounding could lift a bound


@dataclass(frozen=True)
class Subsets:
    """The plans for a few targets alone that raise a bound: of how many targets, how many such plans at most, and what ends it earlier."""

    targets: int = SUBSET_TARGETS
    trials: int = SUBSET_TRIALS
    stop: Callable[[], bool] = lambda: False


def lower_bound(
    problem: Problem, usable: BoolArray, needed_m: FloatArray, routes: Routes, *, seed: int, subsets: Subsets = Subsets()
) -> float:
    """In the unit of the objective; the routes are any plan that keeps the limits, needed_m (u, v) as of `needed_range_m`.

    The best plan leaves out no more by weight than this one: a target that weighs more than what this plan leaves out of the usable ones
    is certain to be in it. Over those targets, at metres measured over all others if that is shorter:

    - some route leads to the farthest one;
    - the total is not less than that of a spanning forest whose starts, ends and arcs at each target are counted right on average
      (Held and Karp 1970, here with ends of their own for each UAV);
    - the longest route takes at least the mean, and at least as long as in the best plan for a few of the targets alone.
    """
    arcs = Arcs.of(problem)
    ready_s = float(arcs.ready_s.min(initial=np.inf)) if arcs.is_makespan and len(arcs.ready_s) else 0.0
    arcs = replace(arcs, ready_s=np.zeros(len(arcs.ready_s)))  # whatever the longest route is without it, it takes as much more
    can_be_done = np.zeros(problem.target_count, dtype=bool)
    can_be_done[arcs.target[usable.any(axis=0)]] = True
    visited = {problem.visits[visit].target for route in routes for visit in route}
    missed = float(sum(arcs.weight[target] for target in np.flatnonzero(can_be_done).tolist() if target not in visited))
    if problem.objective is not Objective.TOTAL and (not arcs.is_makespan or problem.seconds is not None):
        needed_m = _needed(arcs)
    alone = _alone(arcs, usable, needed_m)
    bound = _farthest(alone, arcs.weight, can_be_done, missed)
    certain = np.flatnonzero(can_be_done & (arcs.weight > missed))
    if not len(certain):
        return (bound + ready_s if bound else 0.0) * (1.0 - HAIR)
    closed = _over_others(arcs)
    ways = arcs if missed == 0 and can_be_done.all() else closed
    is_plain = problem.seconds is None and problem.wh is None
    shift_m = arcs.along_m / 2 if is_plain else np.stack([_shift(onward_m) for onward_m in ways.onward_m])
    total_m = sum(problem.route_length_m(uav, route) for uav, route in enumerate(routes)) if is_plain else _total_m(arcs, routes)
    bound = max(bound, _by_forest(ways, shift_m, usable, certain, total_m))
    if arcs.is_makespan:
        value = max(problem.durations_s(routes))
        bound = _by_subsets(closed, usable, certain, alone, bound, value - ready_s, seed, subsets)
    return (bound + ready_s) * (1.0 - HAIR)


def _alone(arcs: Arcs, usable: BoolArray, needed_m: FloatArray) -> FloatArray:
    """The least metres or seconds (t,) of a route with the target; inf if none can be flown."""
    value = np.where(usable, needed_m, np.inf)
    if arcs.is_makespan:
        value = value / arcs.speed_mps[:, None] + arcs.service_s
    alone = np.full(len(arcs.weight), np.inf)
    np.minimum.at(alone, arcs.target, value.min(axis=0))
    return alone


def _needed(arcs: Arcs) -> FloatArray:
    """The least that a route with each visit takes in the unit of the arcs, (u, v)."""
    over = _over_others(arcs)
    return np.asarray(over.first_m + over.end_m, dtype=np.float64)


def _total_m(arcs: Arcs, routes: Routes) -> float:
    return float(sum(_length_m(arcs, uav, route) for uav, route in enumerate(routes)))


def _length_m(arcs: Arcs, uav: int, route: Sequence[int]) -> float:
    if not route:
        return 0.0
    onward_m = arcs.onward_m[arcs.class_of[uav]]
    length_m = arcs.first_m[uav, route[0]] + arcs.end_m[uav, route[-1]] + sum(onward_m[left, right] for left, right in pairwise(route))
    return float(length_m)


def _shift(onward_m: FloatArray) -> FloatArray:
    """What to move of the arcs to each visit to those from it, (v,), so that there and back come to be as alike as can be.

    A route keeps its length, whatever is moved. Half of what lies along a stretch is moved so, and most of what an even wind does: by
    that a way differs from its reverse by what lies between its ends in the wind's direction. The least squares over all pairs.
    """
    both = (onward_m < NO_PATH_M) & (onward_m.T < NO_PATH_M)
    uneven_m = np.where(both, onward_m - onward_m.T, 0.0)
    return np.asarray(-uneven_m.sum(axis=1) / (2 * np.maximum(both.sum(axis=1), 1)), dtype=np.float64)


def _farthest(alone: FloatArray, weight: FloatArray, can_be_done: BoolArray, missed: float) -> float:
    """The farthest first: as soon as they weigh more than what may be left out, one of them is visited."""
    left_out = 0.0
    for target in np.argsort(-alone, kind="stable"):
        if can_be_done[target]:
            left_out += float(weight[target])
            if left_out > missed:
                return float(alone[target])
    return 0.0


def _over_others(arcs: Arcs) -> Arcs:
    """The same with the least metres between all visits, over others if that is shorter."""
    onward_m = np.stack([np.minimum(least_paths(np.where(paths_m < NO_PATH_M, paths_m, np.inf)), NO_PATH_M) for paths_m in arcs.onward_m])
    class_of = arcs.class_of.tolist()
    return replace(
        arcs,
        first_m=np.stack([(row[:, None] + onward_m[number]).min(axis=0) for number, row in zip(class_of, arcs.first_m, strict=True)]),
        onward_m=onward_m,
        end_m=np.stack([(onward_m[number] + row[None, :]).min(axis=1) for number, row in zip(class_of, arcs.end_m, strict=True)]),
    )


def _by_forest(arcs: Arcs, shift_m: FloatArray, usable: BoolArray, certain: IntArray, total_m: float) -> float:
    """The bound from spanning forests over the certain targets; total_m is that of a plan, shift_m (c, v) see `_between_targets`."""
    apart_m, start_m, end_m, service_s = _between_targets(arcs, shift_m, usable, certain)
    steps = int(np.clip(ARC_LOOKS // (len(certain) ** 2 + 1), MIN_STEPS, MAX_STEPS))
    free_m, _ = _ascent(apart_m, start_m, end_m, max(total_m, 1.0), steps, False, arcs.speed_mps)
    if not arcs.is_makespan:
        return float(free_m)
    is_first = np.diff(arcs.owner, prepend=arcs.owner[0] - 1) > 0
    speed_mps, slowest_mps = float(arcs.speed_mps[is_first].sum()), float(arcs.speed_mps.min())
    work_m = slowest_mps * float(service_s.sum())
    mean_s = (free_m + work_m) / speed_mps
    if arcs.has_sorties:
        return mean_s
    all_m, reward_s = _ascent(apart_m, start_m, end_m, max(total_m, 1.0) * 1.2, steps, True, arcs.speed_mps)
    rest_m = all_m + work_m - reward_s * speed_mps
    all_s = (all_m + work_m) / speed_mps if rest_m >= 0 else reward_s + rest_m / slowest_mps
    # The end of a UAV that can do nothing is as far as no way: taken away again it leaves its rounding behind.
    rounding_m = 16 * np.finfo(np.float64).eps * (abs(all_m) + abs(reward_s) * speed_mps)
    return float(max(mean_s, all_s - rounding_m / slowest_mps))


def _between_targets(
    arcs: Arcs, shift_m: FloatArray, usable: BoolArray, certain: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Least metres between the certain targets either way round (n, n), from starts and to ends (u, n), and the service of each (n,).

    An arc of `arcs` contains the way along the visit that it leads to; here shift_m (c, v), of it or more, goes to the arcs behind it.
    """
    number = np.full(len(arcs.weight), -1)
    number[certain] = np.arange(len(certain))
    visits = np.flatnonzero(number[arcs.target] >= 0)
    of = number[arcs.target[visits]]
    n, uavs = len(certain), len(arcs.first_m)
    apart_m, start_m, end_m = np.full((n, n), NO_PATH_M), np.full((uavs, n), NO_PATH_M), np.full((uavs, n), NO_PATH_M)
    moved_m = shift_m[:, visits]
    for onward_m, out_m in zip(arcs.onward_m, moved_m, strict=True):
        np.minimum.at(apart_m, (of[:, None], of[None, :]), onward_m[np.ix_(visits, visits)] + out_m[:, None] - out_m[None, :])
    for uav, number in enumerate(arcs.class_of.tolist()):
        out_m = moved_m[number]
        np.minimum.at(start_m[uav], of, np.where(usable[uav, visits], arcs.first_m[uav, visits] - out_m, NO_PATH_M))
        np.minimum.at(end_m[uav], of, np.where(usable[uav, visits], arcs.end_m[uav, visits] + out_m, NO_PATH_M))
    apart_m = np.minimum(apart_m, apart_m.T)
    service_s = np.full(n, np.inf)
    np.minimum.at(service_s, of, arcs.service_s[visits])
    return apart_m, start_m, end_m, service_s


@njit(cache=True, nogil=True)
def _end_prices(end_m: FloatArray, price: FloatArray, fare: FloatArray, end_price: FloatArray, end_at: IntArray) -> None:
    """Fill in the least price of each UAV's end, and at which target that is."""
    for uav in range(len(end_price)):
        end_price[uav] = np.inf
        for target in range(len(price)):
            here_m = end_m[uav, target] + price[target] - fare[uav]
            if here_m < end_price[uav]:
                end_price[uav], end_at[uav] = here_m, target


@njit(cache=True, nogil=True)
def _ascent(
    apart_m: FloatArray, start_m: FloatArray, end_m: FloatArray, aim_m: float, steps: int, all_fly: bool, speed_mps: FloatArray
) -> tuple[float, float]:
    """The best bound [m] of so many steps along subgradients, and the greatest price of a UAV's end per its speed there.

    Prices are put on the targets, so that each comes to have two arcs or ends, and on the UAVs, so that each that starts also ends.
    """
    n, uavs = len(apart_m), len(start_m)
    price = np.zeros(n)
    fare = np.zeros(uavs)
    degree = np.zeros(n)
    balance = np.zeros(uavs)
    key = np.empty(n)
    parent = np.empty(n, dtype=np.int64)
    by = np.empty(n, dtype=np.int64)
    end_price = np.empty(uavs)
    end_at = np.empty(uavs, dtype=np.int64)
    best, best_reward = -np.inf, 0.0
    step_size, waited = 2.0, 0
    for _ in range(steps):
        degree[:] = -2.0
        balance[:] = 0.0
        value = -2.0 * price.sum()
        for target in range(n):
            key[target] = np.inf
            for uav in range(uavs):
                here_m = start_m[uav, target] + fare[uav] + price[target]
                if here_m < key[target]:
                    key[target], by[target] = here_m, uav
            parent[target] = -1
        for _ in range(n):
            nearest, least_m = -1, np.inf
            for target in range(n):
                if by[target] >= 0 and key[target] < least_m:
                    nearest, least_m = target, key[target]
            if nearest < 0:
                return best, best_reward
            value += least_m
            degree[nearest] += 1.0
            if parent[nearest] >= 0:
                degree[parent[nearest]] += 1.0
            else:
                balance[by[nearest]] += 1.0
            by[nearest] = -1
            row = apart_m[nearest]
            for target in range(n):
                here_m = row[target] + price[nearest] + price[target]
                if by[target] >= 0 and here_m < key[target]:
                    key[target], parent[target] = here_m, nearest
        _end_prices(end_m, price, fare, end_price, end_at)
        reward, cheapest, flying = (end_price / speed_mps).max(), end_price.argmin(), 0
        for uav in range(uavs):
            if all_fly or end_price[uav] < 0.0:
                value += end_price[uav]
                degree[end_at[uav]] += 1.0
                balance[uav] -= 1.0
                flying += 1
        if not flying:
            value += end_price[cheapest]
            degree[end_at[cheapest]] += 1.0
            balance[cheapest] -= 1.0
        waited += 1
        if value > best:
            if value > best + 1e-5 * abs(best):
                waited = 0
            best, best_reward = value, reward
        if waited >= TIMEOUT:
            step_size, waited = step_size / 2.0, 0
        square = (degree * degree).sum() + (balance * balance).sum()
        if square == 0.0 or step_size < 1e-4:
            break
        length_m = step_size * max(aim_m - value, 1e-4 * aim_m) / square
        for target in range(n):
            price[target] += length_m * degree[target]
        for uav in range(uavs):
            fare[uav] += length_m * balance[uav]
    return best, best_reward


def _by_subsets(
    arcs: Arcs, usable: BoolArray, certain: IntArray, alone: FloatArray, bound: float, value: float, seed: int, subsets: Subsets
) -> float:
    """The bound raised by the best plans for a few certain targets: the farthest, then others drawn for one of them."""
    shuffler = random.Random(seed)
    farthest = certain[np.argsort(-alone[certain], kind="stable")]
    chosen = farthest[: subsets.targets].tolist()
    best = _longest_s(arcs, usable, chosen)
    others = farthest[: 4 * subsets.targets].tolist()
    for _ in range(subsets.trials if len(others) > len(chosen) else 0):
        if best >= value * (1.0 - HAIR) or subsets.stop():
            break
        trial = list(chosen)
        trial[shuffler.randrange(len(trial))] = shuffler.choice([target for target in others if target not in chosen])
        tried = _longest_s(arcs, usable, trial)
        if tried >= best:
            chosen, best = trial, tried
    return max(bound, best)


def _longest_s(arcs: Arcs, usable: BoolArray, targets: list[int]) -> float:
    """Seconds of the longest route of the best plan for these targets alone; 0 if they cannot all be done."""
    number = np.full(len(arcs.weight), -1)
    number[targets] = np.arange(len(targets))
    visits = np.flatnonzero(number[arcs.target] >= 0)
    few = replace(
        arcs,
        first_m=np.ascontiguousarray(arcs.first_m[:, visits]),
        onward_m=np.ascontiguousarray(arcs.onward_m[:, visits][:, :, visits]),
        end_m=np.ascontiguousarray(arcs.end_m[:, visits]),
        target=number[arcs.target[visits]],
        service_s=arcs.service_s[visits],
        done=arcs.done[visits],
        allowed=np.ascontiguousarray(usable[:, visits]),
        weight=np.ones(len(targets)),
        along_m=arcs.along_m[:, visits],
        burden=no_burden(len(arcs.first_m), len(visits)),  # without it no plan gets longer
    )
    routes = exact.best_routes(few)
    if sum(len(route) for route in routes) < len(targets):
        return 0.0
    longest_s = own_s = 0.0
    for uav, route in enumerate(routes):
        is_later = uav > 0 and few.owner[uav] == few.owner[uav - 1]
        if not is_later:
            own_s = 0.0
        if route:
            flown_s = _length_m(few, uav, route) / float(few.speed_mps[uav]) + float(few.service_s[list(route)].sum())
            own_s += flown_s + (float(few.turnaround_s[uav]) if is_later else 0.0)
            longest_s = max(longest_s, own_s)
    return longest_s
