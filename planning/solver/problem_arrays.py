"""A problem as plain arrays, the shape that the compiled solvers read."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from planning.problem import BoolArray, FloatArray, IntArray, InvalidProblem, Objective, Problem
from planning.solver.cost_matrices import NO_LIMIT, NO_PATH_M, Kind, Quantities, classes_of, quantities_of


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
            speed_mps=np.array([uav.speed_mps if counted is Kind.METRES else 1.0 for uav in uavs], dtype=np.float64),
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


def _kinds(problem: Problem) -> list[Kind]:
    """What the objective counts, and behind it what else is limited."""
    objective = problem.objective
    if objective is Objective.TOTAL or (objective is Objective.MAKESPAN and problem.seconds is None):
        counted = Kind.METRES
    else:
        counted = Kind.WH if objective is Objective.ENERGY else Kind.SECONDS
    has_limit = {
        Kind.METRES: any(uav.limit_m < NO_LIMIT for uav in problem.uavs),
        Kind.WH: any(uav.limit_wh < NO_LIMIT for uav in problem.uavs),
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
