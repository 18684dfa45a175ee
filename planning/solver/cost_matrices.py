"""Metres, seconds and Wh of all arcs of a problem, in plain arrays."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple

import numpy as np
from numba import njit

from planning.problem import FloatArray, IntArray, InvalidProblem, Objective, Problem, Resources

NO_PATH_M = 1e11  # a hundred million kilometres stand for no way: sums of them stay numbers, unlike those of infinities
NO_LIMIT = NO_PATH_M / 2


class QuantityKind(Enum):
    METRES = auto()
    SECONDS = auto()
    WH = auto()


@dataclass(frozen=True, eq=False)
class Classes:
    """of_uav (u,) is the class of each UAV: those of a class have the same arcs between visits. `pilots` has one UAV of each class."""

    of_uav: IntArray
    pilots: tuple[int, ...]


class Quantities(NamedTuple):
    """Several quantities, q of them, of all arcs of u UAVs in c classes and v visits; NO_WAY_M where there is no way.

    first (q, u, v) from each start; onward (q, c, v, v) from the row's visit; end (q, u, v) on to where the UAV ends; along (q, c, v) what
    of an arc lies on the visit it leads to; limit (q, u). Each arc contains what lies along the visit that it leads to.
    """

    first: FloatArray
    onward: FloatArray
    end: FloatArray
    along: FloatArray
    limit: FloatArray


def classes_of(problem: Problem) -> Classes:
    by_speed = problem.objective is Objective.TIME and problem.seconds is None
    is_classed = problem.seconds is not None or problem.wh is not None
    numbers: dict[tuple[int, float], int] = {}
    of_uav, pilots = [], []
    for uav, start in enumerate(problem.uavs):
        kind = (problem.class_number(uav) if is_classed else 0, start.speed_mps if by_speed else 0.0)
        if kind not in numbers:
            numbers[kind] = len(numbers)
            pilots.append(uav)
        of_uav.append(numbers[kind])
    return Classes(np.array(of_uav, dtype=np.int64), tuple(pilots))


def quantities_of(problem: Problem, classes: Classes, wanted: Iterable[QuantityKind]) -> Quantities:
    """The wanted quantities in this order. What has no way in metres, seconds or Wh has none in any of those that the problem counts.

    Raises InvalidProblem where Wh are wanted and not known.
    """
    kinds = tuple(wanted)
    kinds += tuple(kind for kind in _counted_kinds(problem) if kind not in kinds)
    uavs, visits, count = len(problem.uavs), len(problem.visits), len(classes.pilots)
    found = Quantities(
        first=np.empty((len(kinds), uavs, visits)),
        onward=np.empty((len(kinds), count, visits, visits)),
        end=np.empty((len(kinds), uavs, visits)),
        along=np.empty((len(kinds), count, visits)),
        limit=np.empty((len(kinds), uavs)),
    )
    for at, kind in enumerate(kinds):
        _WRITE[kind](problem, classes, found, at)
    if len(kinds) > 1:
        _close_alike(found.first, found.onward, found.end)
    return found


def _counted_kinds(problem: Problem) -> list[QuantityKind]:
    kinds = [QuantityKind.METRES]
    kinds += [] if problem.wh is None else [QuantityKind.WH]
    return kinds + ([] if problem.seconds is None and problem.objective is not Objective.TIME else [QuantityKind.SECONDS])


def _write_metres(problem: Problem, classes: Classes, found: Quantities, at: int) -> None:
    along_m = np.array([visit.length_m for visit in problem.visits])[None]
    same = np.zeros(len(classes.pilots), dtype=np.int64)
    flown = Resources(problem.from_start_m, problem.between_m[None], problem.end_m, along=along_m)
    _write(flown, same, classes, np.zeros(len(problem.visits)), np.zeros(len(problem.uavs)), found, at)
    found.limit[at] = [min(uav.limit_m, NO_LIMIT) for uav in problem.uavs]


def _write_seconds(problem: Problem, classes: Classes, found: Quantities, at: int) -> None:
    """Of flying; for the least time also of take-off, landing and service."""
    is_whole = problem.objective is Objective.TIME
    service_s = np.array([visit.service_s for visit in problem.visits]) if is_whole else np.zeros(len(problem.visits))
    ready_s = np.array([uav.ready_s for uav in problem.uavs]) if is_whole else np.zeros(len(problem.uavs))
    found.limit[at] = NO_LIMIT
    if problem.seconds is not None:
        _write(problem.seconds, _rows(problem, classes), classes, service_s, ready_s, found, at)
        return
    speed_mps = np.array([uav.speed_mps for uav in problem.uavs])
    pilots_mps = speed_mps[list(classes.pilots)][:, None]
    along_m = np.array([visit.length_m for visit in problem.visits])
    flown = Resources(
        problem.from_start_m / speed_mps[:, None],
        problem.between_m / pilots_mps[:, :, None],
        problem.end_m / speed_mps,
        along=along_m / pilots_mps,
    )
    _write(flown, np.arange(len(classes.pilots)), classes, service_s, ready_s, found, at)


def _write_wh(problem: Problem, classes: Classes, found: Quantities, at: int) -> None:
    """All Wh of a route; none of a UAV of whose energy nothing is known."""
    if problem.wh is None:
        raise InvalidProblem("the Wh are missing")
    nothing_v, nothing_u = np.zeros(len(problem.visits)), np.zeros(len(problem.uavs))
    _write(problem.wh, _rows(problem, classes), classes, nothing_v, nothing_u, found, at)
    found.limit[at] = [min(uav.limit_wh, NO_LIMIT) for uav in problem.uavs]
    unknown = [number for number, uav in enumerate(problem.uavs) if uav.usable_wh is None]
    if unknown:
        found.first[at, unknown], found.end[at, unknown] = 0.0, 0.0
        known = {int(classes.of_uav[number]) for number, uav in enumerate(problem.uavs) if uav.usable_wh is not None}
        found.onward[at, [number for number in range(len(classes.pilots)) if number not in known]] = 0.0


_WRITE = {QuantityKind.METRES: _write_metres, QuantityKind.SECONDS: _write_seconds, QuantityKind.WH: _write_wh}


def _rows(problem: Problem, classes: Classes) -> IntArray:
    """Of the problem's amounts for each class of the arcs."""
    return np.array([problem.class_number(uav) for uav in classes.pilots], dtype=np.int64)


def _write(
    resources: Resources, rows: IntArray, classes: Classes, service: FloatArray, ready: FloatArray, found: Quantities, at: int
) -> None:
    """service (v,) and ready (u,) come on top of the amounts."""
    arrays = (resources.first, resources.onward, resources.end, resources.at_visit)
    first, onward, end, at_visit = (np.ascontiguousarray(array) for array in arrays)
    own_ready = ready if resources.ready is None else ready + resources.ready
    _fill(ResourceArrays(first, onward, end, at_visit, own_ready, service), rows, classes.of_uav, at, found)


class ResourceArrays(NamedTuple):
    """As in Resources, with what comes on top: ready (u,), service (v,)."""

    first: FloatArray
    onward: FloatArray
    end: FloatArray
    at_visit: FloatArray
    ready: FloatArray
    service: FloatArray


@njit(cache=True, nogil=True)
def _fill(resources: ResourceArrays, rows: IntArray, class_of: IntArray, at: int, found: Quantities) -> None:
    """One quantity; what is not a number is no way."""
    first, onward, end, along = resources.first, resources.onward, resources.end, found.along
    uavs, visits = first.shape
    for number in range(len(rows)):
        for visit in range(visits):
            along[at, number, visit] = resources.at_visit[rows[number], visit] + resources.service[visit]
        for other in range(visits):
            for visit in range(visits):
                amount = onward[rows[number], other, visit] + along[at, number, visit]
                found.onward[at, number, other, visit] = amount if amount < NO_PATH_M else NO_PATH_M
    for uav in range(uavs):
        for visit in range(visits):
            amount = first[uav, visit] + along[at, class_of[uav], visit] + resources.ready[uav]
            found.first[at, uav, visit] = amount if amount < NO_PATH_M else NO_PATH_M
            amount = end[visit, uav]
            found.end[at, uav, visit] = amount if amount < NO_PATH_M else NO_PATH_M


@njit(cache=True, nogil=True)
def _close_alike(first: FloatArray, onward: FloatArray, end: FloatArray) -> None:
    """An arc without a way in one quantity has none in any."""
    for arcs in (first.reshape(len(first), -1), onward.reshape(len(onward), -1), end.reshape(len(end), -1)):
        for arc in range(arcs.shape[1]):
            if arcs[:, arc].max() >= NO_PATH_M:
                arcs[:, arc] = NO_PATH_M
