"""A problem as plain arrays, the shape that the compiled solvers read."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from cffi import FFI
from numba import carray, njit

from planning.problem import BoolArray, FloatArray, IntArray, InvalidProblem, Objective, Problem
from planning.solver.cost_matrices import NO_LIMIT, NO_PATH_M, Quantities, QuantityKind, classes_of, quantities_of

MAX_NEIGHBOURS = 60
MAX_JOINED = 12
ALIKE_M = 1e-7  # what arcs may differ by and count as the same: rounding
_ffi = FFI()


@dataclass(frozen=True, eq=False)
class Burden:
    """What else is limited of a route beside what the objective counts: r of metres and Wh, in the classes of the arcs.

    first (r, u, v), onward (r, c, v, v), end (r, u, v), limit (r, u). Where the objective's arcs have no way, these have none.
    """

    first: FloatArray
    onward: FloatArray
    end: FloatArray
    limit: FloatArray

    def __len__(self) -> int:
        return len(self.limit)

    def of_uavs(self, uavs: IntArray) -> "Burden":
        return Burden(self.first[:, uavs], self.onward, self.end[:, uavs], self.limit[:, uavs])


@lru_cache(maxsize=64)
def no_burden(uavs: int, visits: int) -> Burden:
    return Burden(np.zeros((0, uavs, visits)), np.zeros((0, 1, visits, visits)), np.zeros((0, uavs, visits)), np.zeros((0, uavs)))


@dataclass(frozen=True, eq=False)
class Arcs:
    """u UAVs in c classes, v visits, t targets. An arc contains the way along the visit that it leads to; NO_WAY_M where there is no way.

    The arcs are in the unit that the objective counts. For the total that is metres. For the longest route it is metres, too, flown at
    `speed_mps`, or if the problem has its own seconds these, at a speed of 1. For the time and the energy all that a route takes is in
    its arcs, take-off and service with it; then speed is 1, and there is no other service.

    first_m (u, v) from each start; onward_m (c, v, v) from the row's visit; end_m (u, v) on to where the UAV ends;
    target (v,), service_s (v,), done (v,); limit_m (u,), speed_mps (u,), ready_s (u,), most (u,); allowed (u, v); weight (t,).
    class_of (u,); along_m (c, v) what of an arc lies on the visit it leads to; owner (u,) neighbours of one number are sorties of one
    UAV, before each of which but the first lie turnaround_s (u,). These count again_m (u,) in the unit of the arcs, and are in first_m.
    """

    first_m: FloatArray
    onward_m: FloatArray
    end_m: FloatArray
    target: IntArray
    service_s: FloatArray
    done: IntArray
    limit_m: FloatArray
    speed_mps: FloatArray
    ready_s: FloatArray
    most: IntArray
    allowed: BoolArray
    weight: FloatArray
    is_makespan: bool
    class_of: IntArray
    along_m: FloatArray
    owner: IntArray
    turnaround_s: FloatArray
    again_m: FloatArray
    burden: Burden
    has_sorties: bool  # whether any owner has several

    @classmethod
    def of(cls, problem: Problem) -> "Arcs":
        uavs, visits, objective = problem.uavs, problem.visits, problem.objective
        shape = (len(uavs), len(visits))
        if not all(uav.speed_mps > 0 for uav in uavs):
            raise InvalidProblem("a UAV's speed must be above 0")
        classes = classes_of(problem)
        counted, *limited = _kinds(problem)
        found = quantities_of(problem, classes, (counted, *limited))
        first = _with_again(found.first[0], problem) if objective is Objective.TIME else found.first[0]
        is_whole = objective in (Objective.TIME, Objective.ENERGY)
        nothing = np.zeros(len(uavs))
        turnaround_s = np.array([uav.turnaround_s for uav in uavs], dtype=np.float64)
        return cls(
            first_m=first,
            onward_m=found.onward[0],
            end_m=found.end[0],
            target=np.array([visit.target for visit in visits], dtype=np.int64),
            service_s=np.zeros(len(visits)) if is_whole else np.array([visit.service_s for visit in visits], dtype=np.float64),
            done=np.array([visit.done for visit in visits], dtype=np.int64),
            limit_m=found.limit[0],
            speed_mps=np.array([uav.speed_mps if counted is QuantityKind.METRES else 1.0 for uav in uavs], dtype=np.float64),
            ready_s=nothing if is_whole else np.array([uav.ready_s for uav in uavs], dtype=np.float64),
            most=np.array([uav.most for uav in uavs], dtype=np.int64),
            allowed=np.ones(shape, dtype=np.bool_) if problem.allowed is None else np.ascontiguousarray(problem.allowed, dtype=np.bool_),
            weight=np.asarray(problem.left_out_weights, dtype=np.float64),
            is_makespan=objective is Objective.MAKESPAN,
            class_of=classes.of_uav,
            along_m=found.along[0],
            owner=np.array(problem.owner, dtype=np.int64) if problem.owner else np.arange(len(uavs)),
            turnaround_s=nothing if is_whole else turnaround_s,
            again_m=turnaround_s if objective is Objective.TIME else nothing,
            burden=_burden(found, len(limited)),
            has_sorties=len(set(problem.owner)) < len(problem.owner),
        )

    @cached_property
    def visits_of_target(self) -> tuple[IntArray, IntArray]:
        """The visits of each target one after another, and where each target's begin: (v,) and (t + 1,)."""
        order = np.argsort(self.target, kind="stable")
        return order, np.searchsorted(self.target[order], np.arange(len(self.weight) + 1))


class ProblemArrays(NamedTuple):
    """A problem as the search reads it; it does not change. The first arrays are those of Arcs.

    back_m   (c, v, v) the arcs that lead to a visit in one row
    reversed_visit (v,) the same target the other way round; a visit that has none is its own
    is_alike whether an arc is as long as its reverse, and no visit has a reversed one
    class_of (u,) the class of each UAV, of which the arcs are its own
    more_*   what else is limited, as in Burden
    first_of, end_of  (u,) the first of the sorties of the same UAV, and one past its last: a row of the plan is one sortie
    option   (v,) the visits of each target one after another, option_from (t + 1,) where each target's begin
    usable   (u, v) whether the UAV can and may fly the visit at all
    near     (t, k) the nearest targets of each, itself first
    joined   (t, k) those that a tree of the least metres joins it to, or would at the least detour, itself first
    far_m    (t,) from the nearest start
    """

    first_m: FloatArray
    onward_m: FloatArray
    end_m: FloatArray
    target: IntArray
    service_s: FloatArray
    done: IntArray
    limit_m: FloatArray
    speed_mps: FloatArray
    ready_s: FloatArray
    most: IntArray
    weight: FloatArray
    is_makespan: bool
    back_m: FloatArray
    reversed_visit: IntArray
    is_alike: bool
    option: IntArray
    option_from: IntArray
    usable: BoolArray
    near: IntArray
    joined: IntArray
    far_m: FloatArray
    class_of: IntArray
    is_limited: bool
    more_first: FloatArray
    more_onward: FloatArray
    more_end: FloatArray
    more_limit: FloatArray
    has_sorties: bool
    first_of: IntArray
    end_of: IntArray


@njit(cache=True, nogil=True)
def raw_view(array: Any) -> Any:
    """Return the same elements as memory that the caller owns: no references are counted for it.

    numba counts them atomically, for each array of a tuple in each call that is handed the tuple: a search takes 1.8 to 3.2 times as long.
    The view is valid as long as the caller keeps the array.
    """
    return carray(_ffi.from_buffer(array), array.shape)


@njit(cache=True, nogil=True)
def raw_problem(problem: ProblemArrays) -> ProblemArrays:
    """Return raw views of all arrays."""
    return ProblemArrays(
        raw_view(problem.first_m),
        raw_view(problem.onward_m),
        raw_view(problem.end_m),
        raw_view(problem.target),
        raw_view(problem.service_s),
        raw_view(problem.done),
        raw_view(problem.limit_m),
        raw_view(problem.speed_mps),
        raw_view(problem.ready_s),
        raw_view(problem.most),
        raw_view(problem.weight),
        problem.is_makespan,
        raw_view(problem.back_m),
        raw_view(problem.reversed_visit),
        problem.is_alike,
        raw_view(problem.option),
        raw_view(problem.option_from),
        raw_view(problem.usable),
        raw_view(problem.near),
        raw_view(problem.joined),
        raw_view(problem.far_m),
        raw_view(problem.class_of),
        problem.is_limited,
        raw_view(problem.more_first),
        raw_view(problem.more_onward),
        raw_view(problem.more_end),
        raw_view(problem.more_limit),
        problem.has_sorties,
        raw_view(problem.first_of),
        raw_view(problem.end_of),
    )


def problem_arrays_of(problem: Problem, arcs: Arcs, usable: BoolArray) -> ProblemArrays:
    option, option_from = arcs.visits_of_target
    apart_m = _apart_m(arcs)
    near = np.argsort(apart_m, axis=1, kind="stable")[:, : MAX_NEIGHBOURS + 1]
    far_m = np.full(len(arcs.weight), NO_PATH_M)
    reversed_visit = _reversed_visits(problem)
    turned_m = arcs.onward_m.transpose(0, 2, 1)
    is_alike = np.allclose(arcs.onward_m, turned_m, rtol=0.0, atol=ALIKE_M)
    first_of, end_of = np.searchsorted(arcs.owner, arcs.owner), np.searchsorted(arcs.owner, arcs.owner, side="right")
    is_later = first_of < np.arange(len(first_of))
    if len(arcs.first_m):
        np.minimum.at(far_m, arcs.target, arcs.first_m.min(axis=0))
    return ProblemArrays(
        arcs.first_m,
        arcs.onward_m,
        arcs.end_m,
        arcs.target,
        arcs.service_s,
        arcs.done,
        arcs.limit_m,
        arcs.speed_mps,
        arcs.ready_s + np.where(is_later, arcs.turnaround_s, 0.0),
        arcs.most,
        arcs.weight,
        arcs.is_makespan,
        arcs.onward_m if is_alike else np.ascontiguousarray(turned_m),
        reversed_visit,
        is_alike and bool((reversed_visit == np.arange(len(reversed_visit))).all()),
        option,
        option_from,
        np.ascontiguousarray(usable),
        np.ascontiguousarray(near),
        _joined(apart_m),
        far_m,
        arcs.class_of,
        bool(len(arcs.burden)),
        np.ascontiguousarray(arcs.burden.first),
        np.ascontiguousarray(arcs.burden.onward),
        np.ascontiguousarray(arcs.burden.end),
        np.ascontiguousarray(arcs.burden.limit),
        arcs.has_sorties,
        first_of,
        end_of,
    )


def _reversed_visits(problem: Problem) -> IntArray:
    reversed_visit = np.arange(len(problem.visits))
    for visits in problem.visits_of_target():
        if len(visits) == 2 and problem.visits[visits[0]].is_reversed != problem.visits[visits[1]].is_reversed:
            reversed_visit[visits] = visits[::-1]
    return reversed_visit


def _apart_m(arcs: Arcs) -> FloatArray:
    """Metres between targets, over their nearest visits and the better direction, (t, t); below 0 from each to itself."""
    targets = len(arcs.weight)
    apart_m = np.full((targets, targets), NO_PATH_M)
    np.minimum.at(apart_m, (arcs.target[:, None], arcs.target[None, :]), arcs.onward_m.min(axis=0))
    apart_m = np.asarray(np.minimum(apart_m, apart_m.T), dtype=np.float64)
    np.fill_diagonal(apart_m, -1.0)
    return apart_m


def _joined(apart_m: FloatArray) -> IntArray:
    """The targets that cost the least to join to each, if the least spanning tree loses its longest arc between them for it.

    Alpha-nearness: K. Helsgaun, European Journal of Operational Research 126 (2000). Unlike the nearest, they lead out of every cluster.
    """
    detour_m = apart_m - _longest_between(apart_m)
    np.fill_diagonal(detour_m, -1.0)
    order = np.lexsort((apart_m, np.round(detour_m, 3)), axis=1)
    return np.ascontiguousarray(order[:, : MAX_JOINED + 1])


@njit(cache=True, nogil=True)
def _longest_between(apart_m: FloatArray) -> FloatArray:
    """The longest arc between any two targets in the least spanning tree (Prim 1957), (t, t)."""
    targets = len(apart_m)
    longest_m = np.zeros((targets, targets))
    key_m = np.full(targets, np.inf)
    parent = np.full(targets, -1, dtype=np.int64)
    is_in = np.zeros(targets, dtype=np.bool_)
    order = np.empty(targets, dtype=np.int64)
    for count in range(targets):
        next_one = -1
        for target in range(targets):
            if not is_in[target] and (next_one < 0 or key_m[target] < key_m[next_one]):
                next_one = target
        for at in range(count):
            other = order[at]
            reach_m = max(longest_m[parent[next_one], other], key_m[next_one])
            longest_m[next_one, other] = longest_m[other, next_one] = reach_m
        order[count], is_in[next_one] = next_one, True
        for target in range(targets):
            if not is_in[target] and apart_m[next_one, target] < key_m[target]:
                key_m[target], parent[target] = apart_m[next_one, target], next_one
    return longest_m


def _kinds(problem: Problem) -> list[QuantityKind]:
    """What the objective counts, and behind it what else is limited."""
    objective = problem.objective
    if objective is Objective.TOTAL or (objective is Objective.MAKESPAN and problem.seconds is None):
        counted = QuantityKind.METRES
    else:
        counted = QuantityKind.WH if objective is Objective.ENERGY else QuantityKind.SECONDS
    has_limit = {
        QuantityKind.METRES: any(uav.limit_m < NO_LIMIT for uav in problem.uavs),
        QuantityKind.WH: any(uav.limit_wh < NO_LIMIT for uav in problem.uavs),
    }
    return [counted, *(kind for kind, is_limited in has_limit.items() if is_limited and kind is not counted)]


def _burden(found: Quantities, limited: int) -> Burden:
    """Of the quantities behind the one that is counted."""
    if not limited:
        return no_burden(*found.first.shape[1:])
    behind = slice(1, 1 + limited)
    return Burden(found.first[behind], found.onward[behind], found.end[behind], found.limit[behind])


def _with_again(first: FloatArray, problem: Problem) -> FloatArray:
    """A later sortie begins with what lies between it and the one before."""
    later = [uav for uav in range(1, len(problem.owner)) if problem.owner[uav] == problem.owner[uav - 1]]
    for uav in later:
        first[uav] = np.minimum(first[uav] + problem.uavs[uav].turnaround_s, NO_PATH_M)
    return first
