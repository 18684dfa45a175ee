"""A planning problem in plain values: tasks, UAVs, visits, and the metres between them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

MAX_HOLD_S = 3_600.0
# Legs are measured on the ellipsoid, a route's line is straight in lon/lat: on a leg of 10 km they differ by less than this share.
RANGE_RESERVE = 1e-6


class TaskKind(StrEnum):
    LOOK = "look"  # slow down and film the asset in passing
    PHOTO = "photo"  # stand still for sharp pictures
    HOLD = "hold"  # hover over the place


# Seconds at the target when the operator names the kind of task alone: a look in passing, one round of pictures, a longer hover.
DEFAULT_HOLD_S = {TaskKind.LOOK: 5.0, TaskKind.PHOTO: 10.0, TaskKind.HOLD: 30.0}


@dataclass(frozen=True)
class Task:
    """What is done at a target; the UAV stays `hold_s` seconds."""

    kind: TaskKind
    hold_s: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.hold_s <= MAX_HOLD_S:
            raise ValueError(f"hold_s must be from 0 to {MAX_HOLD_S:.0f}")


def default_task(asset_kind: str | None, *, is_path: bool) -> Task:
    """The task of a target for which the operator names none.

    Towers and bridges have details to photograph; a line or railway flown end to end is filmed without stopping, a single point on it
    is looked at; over a bare position the UAV hovers.
    """
    if is_path:
        return Task(TaskKind.LOOK, 0.0)
    if asset_kind in {"tower", "bridge"}:
        return Task(TaskKind.PHOTO, DEFAULT_HOLD_S[TaskKind.PHOTO])
    if asset_kind is None:
        return Task(TaskKind.HOLD, 10.0)
    return Task(TaskKind.LOOK, DEFAULT_HOLD_S[TaskKind.LOOK])


class Objective(StrEnum):
    TOTAL = "total"  # the least distance flown by all
    MAKESPAN = "makespan"  # the shortest longest route


@dataclass(frozen=True)
class UavStart:
    """A UAV at its start: how far it can fly, and whether it has to come back."""

    max_range_m: float | None = None
    returns: bool = False

    @property
    def limit_m(self) -> float:
        return math.inf if self.max_range_m is None else self.max_range_m * (1.0 - RANGE_RESERVE)


@dataclass(frozen=True)
class Visit:
    """One way of doing a target. A point has one; a stretch has two, as it may be flown from either end."""

    target: int
    is_reversed: bool = False
    length_m: float = 0.0  # flown along the stretch


@dataclass(frozen=True, eq=False)
class Problem:
    """u UAVs, v visits that do `target_count` targets; metres, inf where there is no way.

    from_start_m (u, v)  start of each UAV to where each visit begins
    between_m    (v, v)  where the row's visit ends to where the column's begins
    to_start_m   (v, u)  where each visit ends to the start of each UAV
    """

    uavs: tuple[UavStart, ...]
    visits: tuple[Visit, ...]
    target_count: int
    from_start_m: FloatArray
    between_m: FloatArray
    to_start_m: FloatArray
    objective: Objective

    def visits_of_target(self) -> list[list[int]]:
        """Indices of the visits that do each target."""
        visits: list[list[int]] = [[] for _ in range(self.target_count)]
        for index, visit in enumerate(self.visits):
            visits[visit.target].append(index)
        return visits

    def route_length_m(self, uav: int, route: Sequence[int]) -> float:
        """Metres flown by the UAV over the visits in order, home again if it returns; 0 for no visit."""
        if not route:
            return 0.0
        length_m = float(self.from_start_m[uav, route[0]]) + sum(self.visits[visit].length_m for visit in route)
        length_m += sum(float(self.between_m[left, right]) for left, right in pairwise(route))
        return length_m + (float(self.to_start_m[route[-1], uav]) if self.uavs[uav].returns else 0.0)


Routes = tuple[tuple[int, ...], ...]  # visits in order, one tuple per UAV


class Reason(StrEnum):
    """Why a target is not visited."""

    NO_PATH = "no_path"
    BEYOND_RANGE = "beyond_range"


@dataclass(frozen=True)
class Unassigned:
    target: int
    reason: Reason
    message: str


@dataclass(frozen=True)
class Solution:
    """Visits in order for each UAV, and the targets that nobody visits, each with the reason."""

    routes: Routes
    unassigned: tuple[Unassigned, ...]
    total_m: float
    longest_m: float


def merit(problem: Problem, routes: Routes) -> tuple[float, float, float]:
    """Less is better: targets not visited, then the objective, then the other length."""
    lengths_m = [problem.route_length_m(uav, route) for uav, route in enumerate(routes)]
    missed = problem.target_count - sum(len(route) for route in routes)
    total_m, longest_m = sum(lengths_m), max(lengths_m, default=0.0)
    return (missed, total_m, longest_m) if problem.objective is Objective.TOTAL else (missed, longest_m, total_m)
