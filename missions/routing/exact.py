"""The best plan of a small problem, proven, by dynamic programming over sets of targets."""

import numpy as np
from numba import njit

from missions.routing.arcs import NO_WAY_M, Arcs, IntArray
from missions.routing.problem import BoolArray, FloatArray, Problem, Routes

MAX_TARGETS = 12  # 4,096 sets and 531,441 pairs of a set and a part of it: about a millisecond per UAV


def best_plan(problem: Problem) -> Routes:
    """The plan that leaves out least by weight and, among these, is best by the objective, then by the other length.

    Held and Karp's recursion (1962) gives each UAV's shortest route over every set of targets; the sets are then shared out among the
    UAVs, each share the best of all parts of a set. For the longest route this is done twice: for its least duration, then for the
    least total among the plans that are not slower. The alternatives of a target must take equally long to serve.
    """
    return best_routes(Arcs.of(problem))


def best_routes(arcs: Arcs) -> Routes:
    uavs = len(arcs.first_m)
    if not uavs or not len(arcs.target):
        return ((),) * uavs
    length, order = _best(
        arcs.first_m,
        arcs.onward_m,
        arcs.end_m,
        arcs.target,
        arcs.service_s,
        arcs.done,
        arcs.limit_m,
        arcs.speed_mps,
        arcs.ready_s,
        arcs.most,
        arcs.allowed,
        arcs.weight,
        arcs.is_makespan,
    )
    return tuple(tuple(route[:count]) for route, count in zip(order.tolist(), length.tolist(), strict=True))


@njit(cache=True, nogil=True)
def _best(
    first_m: FloatArray,
    onward_m: FloatArray,
    end_m: FloatArray,
    target: IntArray,
    service_s: FloatArray,
    done: IntArray,
    limit_m: FloatArray,
    speed_mps: FloatArray,
    ready_s: FloatArray,
    most: IntArray,
    allowed: BoolArray,
    weight: FloatArray,
    is_makespan: bool,
) -> tuple[IntArray, IntArray]:
    """Visits in order of each UAV (u, t), and how many they are (u,)."""
    uavs, targets = len(first_m), len(weight)
    sets = 1 << targets
    back_m = np.ascontiguousarray(onward_m.T)  # the arcs that lead to a visit lie in a row
    kind = _kinds(first_m, end_m, limit_m, speed_mps, ready_s, most, allowed)
    kinds = kind.max() + 1
    reach_m = np.empty((kinds, sets, len(target)))
    length_m = np.empty((kinds, sets))
    duration_s = np.empty((kinds, sets))
    counts = _sums(done, target, targets)
    services_s = _sums_s(service_s, target, targets)
    for uav in range(uavs):
        number = kind[uav]
        if uav > 0 and number <= kind[:uav].max():
            continue
        _tours(first_m[uav], back_m, end_m[uav], target, allowed[uav], reach_m[number], length_m[number])
        for members in range(sets):
            if length_m[number, members] > limit_m[uav] or counts[members] > most[uav]:
                length_m[number, members] = np.inf
            duration_s[number, members] = length_m[number, members] / speed_mps[uav] + services_s[members] + ready_s[uav]
        duration_s[number, 0] = 0.0

    flying = _flying(kind, targets)
    last = len(flying)
    weights = _sums_s(weight, np.arange(targets), targets)
    total_m = np.empty((last, sets))
    longest_s = np.empty((last, sets))
    if is_makespan:
        _share_by_longest(flying, kind, duration_s, longest_s)
        members = _heaviest(weights, longest_s[last - 1], longest_s[last - 1])
        cap_s = longest_s[last - 1, members]
        for number in range(kinds):
            for part in range(sets):
                if duration_s[number, part] > cap_s:
                    length_m[number, part] = np.inf
        _share_by_total(flying, kind, length_m, duration_s, members if members == sets - 1 else -1, total_m, longest_s)
    else:
        _share_by_total(flying, kind, length_m, duration_s, -1, total_m, longest_s)
        members = sets - 1
    if not np.isfinite(total_m[last - 1, members]) or members < sets - 1:  # of several sets that weigh the same the one of the least total
        members = _heaviest(weights, total_m[last - 1], longest_s[last - 1])

    order = np.empty((uavs, targets), dtype=np.int64)
    length = np.zeros(uavs, dtype=np.int64)
    for place in range(last - 1, -1, -1):
        uav = flying[place]
        own = members
        if place > 0:
            own = _own_part(members, total_m[place - 1], longest_s[place - 1], length_m[kind[uav]], duration_s[kind[uav]])
        length[uav] = _walk_back(own, reach_m[kind[uav]], first_m[uav], back_m, end_m[uav], target, allowed[uav], order[uav])
        members ^= own
    return length, order


@njit(cache=True, nogil=True)
def _kinds(
    first_m: FloatArray,
    end_m: FloatArray,
    limit_m: FloatArray,
    speed_mps: FloatArray,
    ready_s: FloatArray,
    most: IntArray,
    allowed: BoolArray,
) -> IntArray:
    """UAVs that are alike in everything have the same number."""
    kind = np.empty(len(first_m), dtype=np.int64)
    kinds = 0
    for uav in range(len(first_m)):
        kind[uav] = kinds
        for other in range(uav):
            if (
                limit_m[uav] == limit_m[other]
                and speed_mps[uav] == speed_mps[other]
                and ready_s[uav] == ready_s[other]
                and most[uav] == most[other]
                and np.array_equal(first_m[uav], first_m[other])
                and np.array_equal(end_m[uav], end_m[other])
                and np.array_equal(allowed[uav], allowed[other])
            ):
                kind[uav] = kind[other]
                break
        if kind[uav] == kinds:
            kinds += 1
    return kind


@njit(cache=True, nogil=True)
def _flying(kind: IntArray, targets: int) -> IntArray:
    """The UAVs that can be of use, those of a kind one after another: of a kind not more than there are targets."""
    flying = np.empty(len(kind), dtype=np.int64)
    count = 0
    for number in range(kind.max() + 1):
        taken = 0
        for uav in range(len(kind)):
            if kind[uav] == number and taken < targets:
                flying[count] = uav
                count += 1
                taken += 1
    return flying[:count]


@njit(cache=True, nogil=True)
def _sums(of_visit: IntArray, target: IntArray, targets: int) -> IntArray:
    of_target = np.zeros(targets, dtype=np.int64)
    for visit in range(len(target)):
        of_target[target[visit]] = of_visit[visit]
    sums = np.zeros(1 << targets, dtype=np.int64)
    for number in range(targets):
        for rest in range(1 << number):
            sums[rest | 1 << number] = sums[rest] + of_target[number]
    return sums


@njit(cache=True, nogil=True)
def _sums_s(of_visit: FloatArray, target: IntArray, targets: int) -> FloatArray:
    of_target = np.zeros(targets)
    for visit in range(len(target)):
        of_target[target[visit]] = of_visit[visit]
    sums = np.zeros(1 << targets)
    for number in range(targets):
        for rest in range(1 << number):
            sums[rest | 1 << number] = sums[rest] + of_target[number]
    return sums


@njit(cache=True, nogil=True)
def _tours(
    first_m: FloatArray,
    back_m: FloatArray,
    end_m: FloatArray,
    target: IntArray,
    allowed: BoolArray,
    reach_m: FloatArray,
    length_m: FloatArray,
) -> None:
    """Fill in one UAV's shortest routes: over a set, ending with a visit (sets, v), and over a set (sets,)."""
    visits = len(target)
    length_m[0] = 0.0
    reach_m[0] = np.inf
    for members in range(1, len(length_m)):
        row = reach_m[members]
        closed_m = np.inf
        for visit in range(visits):
            row[visit] = np.inf
            bit = 1 << target[visit]
            if members & bit == 0 or not allowed[visit]:
                continue
            rest = members ^ bit
            if rest == 0:
                least_m = first_m[visit]
            else:
                least_m = np.inf
                before, arc_m = reach_m[rest], back_m[visit]
                for other in range(visits):
                    least_m = min(least_m, before[other] + arc_m[other])
            if least_m < NO_WAY_M:
                row[visit] = least_m
                closed_m = min(closed_m, least_m + end_m[visit])
        length_m[members] = closed_m if closed_m < NO_WAY_M else np.inf


@njit(cache=True, nogil=True)
def _share_by_longest(flying: IntArray, kind: IntArray, duration_s: FloatArray, longest_s: FloatArray) -> None:
    """Fill in the least longest duration with which the first so many UAVs do each set."""
    longest_s[0] = duration_s[kind[flying[0]]]
    sets = longest_s.shape[1]
    for place in range(1, len(flying)):
        own_s, others_s = duration_s[kind[flying[place]]], longest_s[place - 1]
        for members in range(sets):
            least_s = others_s[members]
            part = members
            while part:
                least_s = min(least_s, max(own_s[part], others_s[members ^ part]))
                part = (part - 1) & members
            longest_s[place, members] = least_s


@njit(cache=True, nogil=True)
def _share_by_total(
    flying: IntArray,
    kind: IntArray,
    length_m: FloatArray,
    duration_s: FloatArray,
    wanted: int,
    total_m: FloatArray,
    longest_s: FloatArray,
) -> None:
    """Fill in the least total with which the first so many UAVs do each set, then the least longest duration.

    Of the last UAV only the wanted set is asked, or the whole one and, if that cannot be done, all.
    """
    total_m[0] = length_m[kind[flying[0]]]
    longest_s[0] = duration_s[kind[flying[0]]]
    sets = total_m.shape[1]
    asked = wanted if wanted >= 0 else sets - 1
    for place in range(1, len(flying)):
        own = kind[flying[place]]
        if place == len(flying) - 1:
            _share_one(asked, length_m[own], duration_s[own], total_m, longest_s, place)
            if wanted >= 0 or np.isfinite(total_m[place, asked]):
                return
        for members in range(sets):
            _share_one(members, length_m[own], duration_s[own], total_m, longest_s, place)


@njit(cache=True, nogil=True)
def _share_one(members: int, length_m: FloatArray, duration_s: FloatArray, total_m: FloatArray, longest_s: FloatArray, place: int) -> None:
    others_m, others_s = total_m[place - 1], longest_s[place - 1]
    least_m, least_s = others_m[members], others_s[members]
    part = members
    while part:
        sum_m = others_m[members ^ part] + length_m[part]
        if sum_m <= least_m:
            span_s = max(others_s[members ^ part], duration_s[part])
            if sum_m < least_m or span_s < least_s:
                least_m, least_s = sum_m, span_s
        part = (part - 1) & members
    total_m[place, members] = least_m
    longest_s[place, members] = least_s


@njit(cache=True, nogil=True)
def _own_part(members: int, others_m: FloatArray, others_s: FloatArray, length_m: FloatArray, duration_s: FloatArray) -> int:
    """The part of a set that the last of the UAVs does in the best share."""
    best, least_m, least_s = 0, others_m[members], others_s[members]
    part = members
    while part:
        sum_m = others_m[members ^ part] + length_m[part]
        if sum_m <= least_m:
            span_s = max(others_s[members ^ part], duration_s[part])
            if sum_m < least_m or span_s < least_s:
                best, least_m, least_s = part, sum_m, span_s
        part = (part - 1) & members
    return best


@njit(cache=True, nogil=True)
def _heaviest(weights: FloatArray, first: FloatArray, second: FloatArray) -> int:
    """The set of the greatest weight that can be done at all; among equals the least by the two measures."""
    best = 0
    for members in range(1, len(weights)):
        if not np.isfinite(first[members]) or weights[members] < weights[best]:
            continue
        if (
            weights[members] > weights[best]
            or first[members] < first[best]
            or (first[members] == first[best] and second[members] < second[best])
        ):
            best = members
    return best


@njit(cache=True, nogil=True)
def _walk_back(
    members: int,
    reach_m: FloatArray,
    first_m: FloatArray,
    back_m: FloatArray,
    end_m: FloatArray,
    target: IntArray,
    allowed: BoolArray,
    order: IntArray,
) -> int:
    """Write one UAV's shortest route over the set; returns how many visits it has."""
    if members == 0:
        return 0
    visits = len(target)
    last, least_m = 0, np.inf
    for visit in range(visits):
        if reach_m[members, visit] + end_m[visit] < least_m:
            last, least_m = visit, reach_m[members, visit] + end_m[visit]
    count = 0
    for number in range(len(order)):
        if members >> number & 1:
            count += 1
    for place in range(count - 1, -1, -1):
        order[place] = last
        members ^= 1 << target[last]
        before, least_m = 0, np.inf
        for other in range(visits):
            if reach_m[members, other] + back_m[last, other] < least_m:
                before, least_m = other, reach_m[members, other] + back_m[last, other]
        last = before
    return count
