"""A planning problem in plain values: tasks, UAVs, visits, and the metres between them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum, StrEnum
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

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
    MAKESPAN = "makespan"  # the longest route takes as little time as can be


class End(StrEnum):
    """Where a route ends."""

    OPEN = "open"  # over its last target
    RETURN = "return"  # where it started
    ANY_BASE = "any_base"  # at the base that is nearest to its last target


class Priority(IntEnum):
    """What is left out first, when not everything can be done."""

    LOW = 0
    NORMAL = 1
    HIGH = 2


@dataclass(frozen=True)
class UavStart:
    """A UAV at its start: how far and how fast it can fly, where it ends, and how many targets it does at most."""

    max_range_m: float | None = None
    end: End = End.OPEN
    speed_mps: float = 1.0  # without a speed, a second is a metre
    most_targets: int | None = None
    ready_s: float = 0.0  # of a route with any visit, beyond flying and serving: take-off and landing

    @property
    def limit_m(self) -> float:
        return math.inf if self.max_range_m is None else self.max_range_m * (1.0 - RANGE_RESERVE)

    @property
    def most(self) -> int:
        return ANY_NUMBER if self.most_targets is None else self.most_targets


ANY_NUMBER = 1_000_000  # of targets; more than any plan has


@dataclass(frozen=True)
class Visit:
    """One way of doing a target. A point has one; a stretch has two, as it may be flown from either end."""

    target: int
    is_reversed: bool = False
    length_m: float = 0.0  # flown along the stretch
    service_s: float = 0.0  # beyond the time of flying
    done: int = 1  # targets done by it: more than one for a locked run


@dataclass(frozen=True)
class Lock:
    """Targets that one UAV flies in this order with nothing between, if wished as the first or the last of its route."""

    uav: int
    targets: tuple[int, ...]
    at_start: bool = False
    at_end: bool = False


class InvalidProblem(ValueError):
    """The parts of a problem do not fit together."""


@dataclass(frozen=True, eq=False)
class Problem:
    """u UAVs, v visits that do `target_count` targets; metres, inf where there is no way.

    from_start_m (u, v)  start of each UAV to where each visit begins
    between_m    (v, v)  where the row's visit ends to where the column's begins
    to_start_m   (v, u)  where each visit ends to the start of each UAV
    to_base_m    (v, u)  where each visit ends to the nearest base that is open to each UAV; needed if one may end at any base
    allowed      (u, v)  which visits each UAV may fly; without it all
    priorities   one for each target; without them all alike
    weights      (targets,) what leaving out each target weighs, given by who knows better than the priorities (see `left_out_weights`)
    """

    uavs: tuple[UavStart, ...]
    visits: tuple[Visit, ...]
    target_count: int
    from_start_m: FloatArray
    between_m: FloatArray
    to_start_m: FloatArray
    objective: Objective
    to_base_m: FloatArray | None = None
    allowed: BoolArray | None = None
    priorities: tuple[Priority, ...] = ()
    locks: tuple[Lock, ...] = ()
    weights: FloatArray | None = None

    def visits_of_target(self) -> list[list[int]]:
        """Indices of the visits that do each target."""
        visits: list[list[int]] = [[] for _ in range(self.target_count)]
        for index, visit in enumerate(self.visits):
            visits[visit.target].append(index)
        return visits

    @cached_property
    def left_out_weights(self) -> FloatArray:
        """What leaving out each target weighs, (targets,): one of a higher priority more than all of the lower ones together."""
        if self.weights is not None:
            return self.weights
        weights = np.ones(self.target_count)
        if self.priorities:
            priorities, heavier = np.array(self.priorities), 1.0
            for level in sorted(set(self.priorities)):
                weights[priorities == level] = heavier
                heavier += heavier * float((priorities == level).sum())
        return weights

    @cached_property
    def end_m(self) -> FloatArray:
        """Metres from where each visit ends to where each UAV's route ends, (v, u); 0 if it ends there."""
        end_m = np.zeros((len(self.visits), len(self.uavs)))
        for uav, start in enumerate(self.uavs):
            if start.end is End.RETURN:
                end_m[:, uav] = self.to_start_m[:, uav]
            elif start.end is End.ANY_BASE:
                if self.to_base_m is None:
                    raise InvalidProblem("a UAV may end at any base, but the ways to the bases are missing")
                end_m[:, uav] = self.to_base_m[:, uav]
        return end_m

    def may_fly(self, uav: int, visit: int) -> bool:
        return self.allowed is None or bool(self.allowed[uav, visit])

    def route_length_m(self, uav: int, route: Sequence[int]) -> float:
        """Metres flown by the UAV over the visits in order, and on to where it ends; 0 for no visit."""
        if not route:
            return 0.0
        length_m = float(self.from_start_m[uav, route[0]]) + sum(self.visits[visit].length_m for visit in route)
        length_m += sum(float(self.between_m[left, right]) for left, right in pairwise(route))
        return length_m + float(self.end_m[route[-1], uav])

    def route_duration_s(self, uav: int, route: Sequence[int]) -> float:
        """Seconds of flying the route, of what is done at its targets, of take-off and landing; 0 for no visit."""
        if not route:
            return 0.0
        service_s = sum(self.visits[visit].service_s for visit in route)
        return self.route_length_m(uav, route) / self.uavs[uav].speed_mps + service_s + self.uavs[uav].ready_s

    def keeps_limits(self, uav: int, route: Sequence[int]) -> bool:
        """Whether the UAV can and may fly the route."""
        length_m = self.route_length_m(uav, route)
        done = sum(self.visits[visit].done for visit in route)
        return (
            math.isfinite(length_m)
            and length_m <= self.uavs[uav].limit_m
            and done <= self.uavs[uav].most
            and all(self.may_fly(uav, visit) for visit in route)
        )


Routes = tuple[tuple[int, ...], ...]  # visits in order, one tuple per UAV


class Reason(StrEnum):
    """Why a target is not visited."""

    NO_PATH = "no_path"
    BEYOND_RANGE = "beyond_range"
    NOT_ALLOWED = "not_allowed"
    MOST_TARGETS = "most_targets"


@dataclass(frozen=True)
class Unassigned:
    target: int
    reason: Reason
    message: str


@dataclass(frozen=True)
class Solution:
    """Visits in order for each UAV, and the targets that nobody visits, each with the reason.

    `lower_bound` is in the objective's own unit, metres for the total and seconds for the longest route: no plan that leaves out as
    little as the best one has less. `gap` is the share of this plan's value that lies above it.
    """

    routes: Routes
    unassigned: tuple[Unassigned, ...]
    total_m: float
    longest_m: float
    longest_s: float
    lower_bound: float
    gap: float
    is_proven: bool
    method: str


def merit(problem: Problem, routes: Routes) -> tuple[float, float, float]:
    """Less is better: what is not visited by weight, then the objective, then the other: total metres and longest seconds."""
    total_m = sum(problem.route_length_m(uav, route) for uav, route in enumerate(routes))
    longest_s = max((problem.route_duration_s(uav, route) for uav, route in enumerate(routes)), default=0.0)
    weights = problem.left_out_weights
    missed = float(weights.sum()) - float(sum(weights[problem.visits[visit].target] for route in routes for visit in route))
    return (missed, total_m, longest_s) if problem.objective is Objective.TOTAL else (missed, longest_s, total_m)
