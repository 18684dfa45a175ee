"""A problem as plain arrays, the shape that the compiled solvers read."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from missions.routing.problem import Amounts, BoolArray, FloatArray, IntArray, InvalidProblem, Objective, Problem

NO_WAY_M = 1e11  # a hundred million kilometres stand for no way: sums of them stay numbers, unlike those of infinities


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
        speed_mps = np.array([uav.speed_mps for uav in uavs], dtype=np.float64)
        if not (speed_mps > 0).all():
            raise InvalidProblem("a UAV's speed must be above 0")
        class_of, pilots = _classes(problem)
        counted, burden = _counted(problem, class_of, pilots)
        is_whole = objective in (Objective.TIME, Objective.ENERGY)
        turnaround_s = np.array([uav.turnaround_s for uav in uavs], dtype=np.float64)
        is_in_metres = objective is Objective.TOTAL or (objective is Objective.MAKESPAN and problem.seconds is None)
        return cls(
            first_m=_with_again(counted.first, problem) if objective is Objective.TIME else counted.first,
            onward_m=counted.onward,
            end_m=counted.end,
            target=np.array([visit.target for visit in visits], dtype=np.int64),
            service_s=np.zeros(len(visits)) if is_whole else np.array([visit.service_s for visit in visits], dtype=np.float64),
            done=np.array([visit.done for visit in visits], dtype=np.int64),
            limit_m=counted.limit,
            speed_mps=speed_mps if is_in_metres else np.ones(len(uavs)),
            ready_s=np.zeros(len(uavs)) if is_whole else np.array([uav.ready_s for uav in uavs], dtype=np.float64),
            most=np.array([uav.most for uav in uavs], dtype=np.int64),
            allowed=np.ones(shape, dtype=np.bool_) if problem.allowed is None else np.ascontiguousarray(problem.allowed, dtype=np.bool_),
            weight=np.asarray(problem.left_out_weights, dtype=np.float64),
            is_makespan=objective is Objective.MAKESPAN,
            class_of=class_of,
            along_m=counted.along,
            owner=np.array(problem.owner, dtype=np.int64) if problem.owner else np.arange(len(uavs)),
            turnaround_s=np.zeros(len(uavs)) if is_whole else turnaround_s,
            again_m=turnaround_s if objective is Objective.TIME else np.zeros(len(uavs)),
            burden=burden,
            has_sorties=len(set(problem.owner)) < len(problem.owner),
        )

    @cached_property
    def visits_of_target(self) -> tuple[IntArray, IntArray]:
        """The visits of each target one after another, and where each target's begin: (v,) and (t + 1,)."""
        order = np.argsort(self.target, kind="stable")
        return order, np.searchsorted(self.target[order], np.arange(len(self.weight) + 1))


@dataclass(frozen=True, eq=False)
class Quantity:
    """One quantity of all arcs, each with what lies along the visit that it leads to; shapes as in Arcs."""

    first: FloatArray
    onward: FloatArray
    end: FloatArray
    along: FloatArray
    limit: FloatArray


def _with_again(first: FloatArray, problem: Problem) -> FloatArray:
    """A later sortie begins with what lies between it and the one before."""
    later = [uav for uav in range(1, len(problem.owner)) if problem.owner[uav] == problem.owner[uav - 1]]
    for uav in later:
        first[uav] = np.minimum(first[uav] + problem.uavs[uav].turnaround_s, NO_WAY_M)
    return first


def quantities(problem: Problem) -> tuple[Quantity, Quantity | None]:
    """Metres and, where they are known, Wh of all arcs; one that has no way in metres, Wh or seconds has none in any."""
    class_of, pilots = _classes(problem)
    counted = _all_quantities(problem, class_of, pilots)
    return counted[0], None if problem.wh is None else counted[1]


def classes_of(problem: Problem) -> IntArray:
    return _classes(problem)[0]


def _classes(problem: Problem) -> tuple[IntArray, list[int]]:
    """The class of each UAV, (u,), and of each class one UAV: those of a class have the same arcs between visits."""
    by_speed = problem.objective is Objective.TIME and problem.seconds is None
    is_classed = problem.seconds is not None or problem.wh is not None
    numbers: dict[tuple[int, float], int] = {}
    class_of, pilots = [], []
    for uav, start in enumerate(problem.uavs):
        kind = (problem.class_number(uav) if is_classed else 0, start.speed_mps if by_speed else 0.0)
        if kind not in numbers:
            numbers[kind] = len(numbers)
            pilots.append(uav)
        class_of.append(numbers[kind])
    return np.array(class_of, dtype=np.int64), pilots


def _counted(problem: Problem, class_of: IntArray, pilots: list[int]) -> tuple[Quantity, Burden]:
    """What the objective counts, and what else is limited."""
    objective = problem.objective
    has_range = any(uav.limit_m < NO_WAY_M / 2 for uav in problem.uavs)
    has_battery = any(uav.limit_wh < NO_WAY_M / 2 for uav in problem.uavs)
    others = _all_quantities(problem, class_of, pilots)
    of_metres = others[0]
    if objective is Objective.TOTAL or (objective is Objective.MAKESPAN and problem.seconds is None):
        counted = of_metres
    elif objective is Objective.ENERGY:
        counted = others[1]
    else:
        counted = others[-1]
    limited = [of_metres] if has_range and counted is not of_metres else []
    limited += [others[1]] if has_battery and counted is not others[1] else []
    if not limited:
        return counted, no_burden(*counted.first.shape)
    return counted, Burden(
        np.stack([part.first for part in limited]),
        np.stack([part.onward for part in limited]),
        np.stack([part.end for part in limited]),
        np.stack([part.limit for part in limited]),
    )


def _all_quantities(problem: Problem, class_of: IntArray, pilots: list[int]) -> list[Quantity]:
    """Metres, then Wh if the problem has them, then seconds if it has them or counts their sum."""
    parts = [metres(problem, len(pilots))]
    parts += [] if problem.wh is None else [watt_hours(problem, class_of, pilots)]
    parts += [] if problem.seconds is None and problem.objective is not Objective.TIME else [seconds(problem, class_of, pilots)]
    if len(parts) > 1:
        no_first = np.logical_or.reduce([part.first >= NO_WAY_M for part in parts])
        no_onward = np.logical_or.reduce([part.onward >= NO_WAY_M for part in parts])
        no_end = np.logical_or.reduce([part.end >= NO_WAY_M for part in parts])
        for part in parts:
            part.first[no_first], part.onward[no_onward], part.end[no_end] = NO_WAY_M, NO_WAY_M, NO_WAY_M
    return parts


def metres(problem: Problem, classes: int = 1) -> Quantity:
    along_m = np.array([visit.length_m for visit in problem.visits])
    onward_m = np.minimum(problem.between_m + along_m, NO_WAY_M)[None]
    return Quantity(
        first=np.ascontiguousarray(np.minimum(problem.from_start_m + along_m, NO_WAY_M)).reshape(len(problem.uavs), len(problem.visits)),
        onward=onward_m if classes <= 1 else np.repeat(onward_m, classes, axis=0),
        end=np.ascontiguousarray(np.minimum(problem.end_m, NO_WAY_M).T).reshape(len(problem.uavs), len(problem.visits)),
        along=along_m[None] if classes <= 1 else np.repeat(along_m[None], classes, axis=0),
        limit=_limits([uav.limit_m for uav in problem.uavs]),
    )


def seconds(problem: Problem, class_of: IntArray, pilots: list[int]) -> Quantity:
    """Of flying; for the least time also of take-off, landing and service. `pilots` has one UAV of each class."""
    is_whole = problem.objective is Objective.TIME
    service_s = np.array([visit.service_s for visit in problem.visits]) if is_whole else np.zeros(len(problem.visits))
    ready_s = np.array([uav.ready_s for uav in problem.uavs]) if is_whole else np.zeros(len(problem.uavs))
    limit_s = _limits([NO_WAY_M] * len(problem.uavs))
    if problem.seconds is not None:
        rows = [problem.class_number(uav) for uav in pilots]
        return _quantity(problem.seconds, rows, class_of, service_s, ready_s, limit_s)
    speed_mps = np.array([uav.speed_mps for uav in problem.uavs])
    pilots_mps = speed_mps[pilots][:, None]
    along_m = np.array([visit.length_m for visit in problem.visits])
    flown = Amounts(
        problem.from_start_m / speed_mps[:, None],
        problem.between_m / pilots_mps[:, :, None],
        problem.end_m / speed_mps,
        along=along_m / pilots_mps,
    )
    return _quantity(flown, list(range(len(pilots))), class_of, service_s, ready_s, limit_s)


def watt_hours(problem: Problem, class_of: IntArray, pilots: list[int]) -> Quantity:
    """All Wh of a route; none of a UAV of whose energy nothing is known. `pilots` has one UAV of each class."""
    if problem.wh is None:
        raise InvalidProblem("the Wh are missing")
    limit_wh = _limits([uav.limit_wh for uav in problem.uavs])
    rows = [problem.class_number(uav) for uav in pilots]
    used = _quantity(problem.wh, rows, class_of, np.zeros(len(problem.visits)), np.zeros(len(problem.uavs)), limit_wh)
    is_known = np.array([uav.usable_wh is not None for uav in problem.uavs], dtype=bool)
    used.first[~is_known], used.end[~is_known] = 0.0, 0.0
    for number in range(len(pilots)):
        if not is_known[class_of == number].any():
            used.onward[number] = 0.0
    return used


def _quantity(amounts: Amounts, rows: list[int], class_of: IntArray, service: FloatArray, ready: FloatArray, limit: FloatArray) -> Quantity:
    """Rows are those of the amounts for each class of the arcs; service (v,) and ready (u,) come on top."""
    along = amounts.at_visit[rows] + service
    if amounts.ready is not None:
        ready = ready + amounts.ready
    return Quantity(
        first=_ways(amounts.first + along[class_of] + ready[:, None]),
        onward=_ways(amounts.onward[rows] + along[:, None, :]),
        end=_ways(np.asarray(amounts.end).T),
        along=along,
        limit=limit,
    )


def _ways(values: FloatArray) -> FloatArray:
    """What is not known is no way."""
    return np.ascontiguousarray(np.minimum(np.where(np.isnan(values), NO_WAY_M, values), NO_WAY_M))


def _limits(values: list[float]) -> FloatArray:
    return np.array([min(value, NO_WAY_M / 2) for value in values], dtype=np.float64)
