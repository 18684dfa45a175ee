"""A problem as plain arrays, the shape that the compiled solvers read."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from missions.routing.problem import BoolArray, FloatArray, InvalidProblem, Objective, Problem

IntArray = NDArray[np.int64]

NO_WAY_M = 1e11  # a hundred million kilometres stand for no way: sums of them stay numbers, unlike those of infinities


@dataclass(frozen=True, eq=False)
class Arcs:
    """u UAVs, v visits, t targets. An arc contains the way along the visit that it leads to; metres, NO_WAY_M where there is no way.

    first_m (u, v) from each start; onward_m (v, v) from the row's visit; end_m (u, v) on to where the UAV ends;
    target (v,), service_s (v,), done (v,); limit_m (u,), speed_mps (u,), ready_s (u,), most (u,); allowed (u, v); weight (t,).
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

    @classmethod
    def of(cls, problem: Problem) -> "Arcs":
        uavs, visits = problem.uavs, problem.visits
        along_m = np.array([visit.length_m for visit in visits])
        shape = (len(uavs), len(visits))
        return cls(
            first_m=np.minimum(problem.from_start_m + along_m, NO_WAY_M).reshape(shape),
            onward_m=np.minimum(problem.between_m + along_m, NO_WAY_M),
            end_m=np.ascontiguousarray(np.minimum(problem.end_m, NO_WAY_M).T).reshape(shape),
            target=np.array([visit.target for visit in visits], dtype=np.int64),
            service_s=np.array([visit.service_s for visit in visits], dtype=np.float64),
            done=np.array([visit.done for visit in visits], dtype=np.int64),
            limit_m=np.array([min(uav.limit_m, NO_WAY_M / 2) for uav in uavs], dtype=np.float64),
            speed_mps=np.array([uav.speed_mps for uav in uavs], dtype=np.float64),
            ready_s=np.array([uav.ready_s for uav in uavs], dtype=np.float64),
            most=np.array([uav.most for uav in uavs], dtype=np.int64),
            allowed=np.ones(shape, dtype=np.bool_) if problem.allowed is None else np.ascontiguousarray(problem.allowed, dtype=np.bool_),
            weight=np.asarray(problem.left_out_weights, dtype=np.float64),
            is_makespan=problem.objective is Objective.MAKESPAN,
        )

    def __post_init__(self) -> None:
        if not (self.speed_mps > 0).all():
            raise InvalidProblem("a UAV's speed must be above 0")

    @cached_property
    def visits_of_target(self) -> tuple[IntArray, IntArray]:
        """The visits of each target one after another, and where each target's begin: (v,) and (t + 1,)."""
        order = np.argsort(self.target, kind="stable")
        return order, np.searchsorted(self.target[order], np.arange(len(self.weight) + 1))
