"""The best plan of a small problem, proven, by dynamic programming over sets of targets."""

from typing import NamedTuple

import numpy as np
from numba import njit

from planning.problem import BoolArray, FloatArray, IntArray, Problem, Routes
from planning.solver.plan_state import ABSENT
from planning.solver.problem_arrays import Arcs
from planning.solver.tours import TourLimits, Tours, UavArcs, limited_tours, settled_tours, shortest_tours, walk_back

MAX_TARGETS = 12  # 4,096 sets and 531,441 pairs of a set and a part of it: about a millisecond per UAV
MAX_REACH_BYTES = 64_000_000  # beyond, the tours of one kind of UAV are in memory at a time, and those that are flown are found again


def best_plan(problem: Problem) -> Routes:
    """The plan that leaves out least by weight and, among these, is best by the objective, then by the other length.

    Held and Karp's recursion (1962) gives each UAV's shortest route over every set of targets; the sets are then shared out among the
    UAVs, each share the best of all parts of a set. For the longest route this is done twice: for its least duration, then for the
    least total among the plans that are not slower. The alternatives of a target must take equally long to serve. Where more is limited
    than what the objective counts, see `tours.py`; where UAVs fly several sorties, each set is first shared out among these.
    """
    return best_routes(Arcs.of(problem))


def best_routes(arcs: Arcs) -> Routes:
    return proven_routes(arcs)[0]


def proven_routes(arcs: Arcs) -> tuple[Routes, bool]:
    """The best routes, and whether that is proven: not if too many tours would have had to be weighed."""
    uavs = len(arcs.first_m)
    if not uavs or not len(arcs.target):
        return ((),) * uavs, True
    if arcs.has_sorties:
        return _best_of_limited(arcs)
    burden = arcs.burden
    is_settled, length, order = _best(
        Matrices(arcs.first_m, arcs.onward_m, arcs.end_m),
        Fleet(arcs.limit_m, arcs.speed_mps, arcs.ready_s, arcs.most, arcs.allowed, arcs.class_of),
        Services(arcs.target, arcs.service_s, arcs.done),
        Limited(burden.first, burden.onward, burden.end, burden.limit),
        arcs.weight,
        arcs.is_makespan,
    )
    if not is_settled:
        return _best_of_limited(arcs)
    return tuple(tuple(route[:count]) for route, count in zip(order.tolist(), length.tolist(), strict=True)), True


def _best_of_limited(arcs: Arcs) -> tuple[Routes, bool]:
    """The same with a burden or with sorties: each kind of UAV has its own tours, and its sets shared out among its sorties."""
    targets = len(arcs.weight)
    rows = np.flatnonzero(np.diff(arcs.owner, prepend=arcs.owner[0] - 1))  # the first sortie of each UAV
    sorties = np.diff(rows, append=len(arcs.owner))
    counts, services_s = _sums(arcs.done, arcs.target, targets), _sums_s(arcs.service_s, arcs.target, targets)
    number: dict[tuple[object, ...], int] = {}
    kind = np.zeros(len(rows), dtype=np.int64)
    tours: list[Tours] = []
    length_m, duration_s = [], []
    for uav, (row, most) in enumerate(zip(rows.tolist(), sorties.tolist(), strict=True)):
        kind[uav] = number.setdefault((most, *likeness(arcs, row)), len(tours))
        if kind[uav] < len(tours):
            continue
        own = limited_tours(arcs, row, counts)
        tours.append(own)
        own_m = _shared_among_sorties(own.length_m, float(arcs.again_m[row]), most, int(sorties.max()))
        own_m[:, counts > arcs.most[row]] = np.inf
        flights = np.arange(1, len(own_m) + 1)[:, None]
        own_s = own_m / arcs.speed_mps[row] + services_s + arcs.ready_s[row] * flights + arcs.turnaround_s[row] * (flights - 1)
        own_s[:, 0] = 0.0
        length_m.append(own_m)
        duration_s.append(own_s)
    weights = _sums_s(arcs.weight, np.arange(targets), targets)
    sets, flown = _shared_out(kind, np.stack(length_m), np.stack(duration_s), weights, targets, arcs.is_makespan)
    routes: list[tuple[int, ...]] = []
    for uav, most in enumerate(sorties.tolist()):
        own, again_m = tours[kind[uav]], float(arcs.again_m[rows[uav]])
        parts = _parts(int(sets[uav]), int(flown[uav]), own.length_m, length_m[kind[uav]], again_m).tolist()
        routes += [*(own.route(part) for part in parts), *((),) * (most - len(parts))]
    return tuple(routes), all(own.is_whole for own in tours)


def likeness(arcs: Arcs, uav: int) -> tuple[object, ...]:
    """UAVs that are alike in everything have the same."""
    of_uav = (arcs.first_m, arcs.end_m, arcs.limit_m, arcs.speed_mps, arcs.ready_s, arcs.most, arcs.allowed, arcs.class_of)
    more = (arcs.turnaround_s, arcs.again_m, *arcs.burden.first, *arcs.burden.end, *arcs.burden.limit)
    return tuple(np.asarray(values[uav]).tobytes() for values in (*of_uav, *more))


@njit(cache=True, nogil=True)
def _shared_among_sorties(single_m: FloatArray, again_m: float, most: int, rows: int) -> FloatArray:
    """The least of each set in just so many sorties, (rows, sets): one in the first row; inf beyond the most."""
    sets = len(single_m)
    shared_m = np.full((rows, sets), np.inf)
    shared_m[0] = single_m
    for number in range(1, most):
        for members in range(1, sets):
            lowest = members & -members
            others = members ^ lowest
            least_m, part = np.inf, others
            while part:  # the rest flies later; the sortie with the lowest target comes first
                least_m = min(least_m, single_m[members ^ part] + shared_m[number - 1, part])
                part = (part - 1) & others
            shared_m[number, members] = least_m + again_m
    return shared_m


@njit(cache=True, nogil=True)
def _parts(members: int, flown: int, single_m: FloatArray, shared_m: FloatArray, again_m: float) -> IntArray:
    """The set of each of so many sorties in the best share."""
    parts = np.zeros(flown, dtype=np.int64)
    for number in range(flown - 1, 0, -1):
        others = members ^ (members & -members)
        rest, least_m, part = 0, np.inf, others
        while part:
            here_m = single_m[members ^ part] + shared_m[number - 1, part]
            if here_m < least_m:
                rest, least_m = part, here_m
            part = (part - 1) & others
        parts[flown - 1 - number] = members ^ rest
        members = rest
    if flown:
        parts[flown - 1] = members
    return parts


class Matrices(NamedTuple):
    """As in Arcs."""

    first_m: FloatArray
    onward_m: FloatArray
    end_m: FloatArray


class Fleet(NamedTuple):
    """Of each UAV, as in Arcs."""

    limit_m: FloatArray
    speed_mps: FloatArray
    ready_s: FloatArray
    most: IntArray
    allowed: BoolArray
    class_of: IntArray


class Services(NamedTuple):
    """Of each visit, as in Arcs."""

    target: IntArray
    service_s: FloatArray
    done: IntArray


class Limited(NamedTuple):
    """As in Burden."""

    first: FloatArray
    onward: FloatArray
    end: FloatArray
    limit: FloatArray


@njit(cache=True, nogil=True)
def _best(
    matrices: Matrices, fleet: Fleet, services: Services, more: Limited, weight: FloatArray, is_makespan: bool
) -> tuple[bool, IntArray, IntArray]:
    """Visits in order of each UAV (u, t), and how many they are (u,); False first if a set of targets is contested."""
    first_m, end_m, target = matrices.first_m, matrices.end_m, services.target
    uavs, targets = len(first_m), len(weight)
    sets = 1 << targets
    back_m = _turned(matrices.onward_m)
    back = np.empty((len(back_m), len(more.limit), len(target), len(target)))
    for at in range(len(more.limit)):
        back[:, at] = _turned(more.onward[at])
    kind = _kinds(matrices, fleet, more)
    kinds = kind.max() + 1
    keeps_reach = kinds * sets * len(target) * 8 <= MAX_REACH_BYTES
    reach_m = np.empty((kinds if keeps_reach else 1, sets, len(target)))
    length_m = np.empty((kinds, 1, sets))
    duration_s = np.empty((kinds, 1, sets))
    is_contested = np.zeros(sets, dtype=np.bool_)
    order = np.empty((uavs, targets), dtype=np.int64)
    length = np.zeros(uavs, dtype=np.int64)
    counts = _sums(services.done, target, targets)
    services_s = _sums_s(services.service_s, target, targets)
    for uav in range(uavs):
        number, flying = kind[uav], fleet.class_of[uav]
        if uav > 0 and number <= kind[:uav].max():
            continue
        own_m, own_s = length_m[number, 0], duration_s[number, 0]
        arcs = UavArcs(first_m[uav], back_m[flying], end_m[uav], target, fleet.allowed[uav])
        first, end, limit = more.first[:, uav].copy(), more.end[:, uav].copy(), more.limit[:, uav].copy()
        limits = TourLimits(fleet.limit_m[uav], fleet.most[uav], counts, first, back[flying], end, limit)
        if settled_tours(arcs, limits, reach_m[number if keeps_reach else 0], own_m, is_contested):
            return False, length, order
        for members in range(sets):
            own_s[members] = own_m[members] / fleet.speed_mps[uav] + services_s[members] + fleet.ready_s[uav]
        own_s[0] = 0.0

    share, _ = _shared_out(kind, length_m, duration_s, _sums_s(weight, np.arange(targets), targets), targets, is_makespan)
    present = -1
    for uav in range(uavs):
        number = kind[uav]
        arcs = UavArcs(first_m[uav], back_m[fleet.class_of[uav]], end_m[uav], target, fleet.allowed[uav])
        if not keeps_reach and share[uav] and number != present:
            shortest_tours(arcs, reach_m[0], duration_s[number, 0])  # durations are no longer needed
            present = number
        length[uav] = walk_back(share[uav], reach_m[number if keeps_reach else 0], arcs, order[uav])
    return True, length, order


@njit(cache=True, nogil=True)
def _turned(onward_m: FloatArray) -> FloatArray:
    """The arcs that lead to a visit lie in a row."""
    back_m = np.empty(onward_m.shape)
    for number in range(len(onward_m)):
        back_m[number] = onward_m[number].T
    return back_m


@njit(cache=True, nogil=True)
def _shared_out(
    kind: IntArray, length_m: FloatArray, duration_s: FloatArray, weights: FloatArray, targets: int, is_makespan: bool
) -> tuple[IntArray, IntArray]:
    """The set of each UAV, (u,), and in how many sorties, (u,), from length and duration of each (kinds, sorties - 1, sets)."""
    kinds, _, sets = length_m.shape
    flying = _flying(kind, targets)
    last = len(flying)
    total_m = np.empty((last, sets))
    longest_s = np.empty((last, sets))
    own_m, own_s = np.empty((kinds, sets)), np.empty((kinds, sets))
    flown = np.ones((kinds, sets), dtype=np.int64)
    if is_makespan:
        _choose(duration_s, duration_s, np.inf, own_m, own_s, flown)
        _share_by_longest(flying, kind, own_s, longest_s)
        members = _heaviest(weights, longest_s[last - 1], longest_s[last - 1])
        _choose(length_m, duration_s, longest_s[last - 1, members], own_m, own_s, flown)
        _share_by_total(flying, kind, own_m, own_s, members if members == sets - 1 else ABSENT, total_m, longest_s)
    else:
        _choose(length_m, duration_s, np.inf, own_m, own_s, flown)
        _share_by_total(flying, kind, own_m, own_s, ABSENT, total_m, longest_s)
        members = sets - 1
    if not np.isfinite(total_m[last - 1, members]) or members < sets - 1:  # of several sets that weigh the same the one of the least total
        members = _heaviest(weights, total_m[last - 1], longest_s[last - 1])

    of_uav = np.zeros(len(kind), dtype=np.int64)
    sorties = np.zeros(len(kind), dtype=np.int64)
    for place in range(last - 1, -1, -1):
        uav = flying[place]
        own = members
        if place > 0:
            own = _own_part(members, total_m[place - 1], longest_s[place - 1], own_m[kind[uav]], own_s[kind[uav]])
        of_uav[uav] = own
        sorties[uav] = flown[kind[uav], own] if own else 0
        members ^= own
    return of_uav, sorties


@njit(cache=True, nogil=True)
def _choose(least: FloatArray, duration_s: FloatArray, most_s: float, own_m: FloatArray, own_s: FloatArray, flown: IntArray) -> None:
    """Fill in the least of each kind and set that takes no longer, over all numbers of sorties, the fewer first; inf if there is none."""
    kinds, rows, sets = least.shape
    for number in range(kinds):
        for members in range(sets):
            best_m, best_s, sorties = np.inf, duration_s[number, 0, members], 1
            for row in range(rows):
                if duration_s[number, row, members] <= most_s and least[number, row, members] < best_m:
                    best_m, best_s, sorties = least[number, row, members], duration_s[number, row, members], row + 1
            own_m[number, members], own_s[number, members], flown[number, members] = best_m, best_s, sorties


@njit(cache=True, nogil=True)
def _kinds(matrices: Matrices, fleet: Fleet, more: Limited) -> IntArray:
    """UAVs that are alike in everything have the same number."""
    first_m, end_m = matrices.first_m, matrices.end_m
    kind = np.empty(len(first_m), dtype=np.int64)
    kinds = 0
    for uav in range(len(first_m)):
        kind[uav] = kinds
        for other in range(uav):
            if (
                fleet.limit_m[uav] == fleet.limit_m[other]
                and fleet.speed_mps[uav] == fleet.speed_mps[other]
                and fleet.ready_s[uav] == fleet.ready_s[other]
                and fleet.most[uav] == fleet.most[other]
                and fleet.class_of[uav] == fleet.class_of[other]
                and np.array_equal(first_m[uav], first_m[other])
                and np.array_equal(end_m[uav], end_m[other])
                and np.array_equal(fleet.allowed[uav], fleet.allowed[other])
                and np.array_equal(more.first[:, uav], more.first[:, other])
                and np.array_equal(more.end[:, uav], more.end[:, other])
                and np.array_equal(more.limit[:, uav], more.limit[:, other])
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
