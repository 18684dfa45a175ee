"""A planning problem in plain values: UAVs, visits, and the metres between them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum, StrEnum
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from operation.reasons import Reason

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

# Legs are measured on the ellipsoid, a route's line is straight in lon/lat: on a leg of 10 km they differ by less than this share.
RANGE_RESERVE = 1e-6


class Objective(StrEnum):
    TOTAL = "total"  # the least distance flown by all
    MAKESPAN = "makespan"  # the longest route takes as little time as can be
    TIME = "time"  # the least time in the air of all, changes of batteries among it
    ENERGY = "energy"  # the least Wh of all


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
    """A UAV at its start: how far and how fast it can fly, where it ends, how many targets it does at most, and in how many sorties.

    What is limited by range and battery is one sortie, of targets all of them together. Only a UAV that returns can fly several.
    """

    max_range_m: float | None = None
    end: End = End.OPEN
    speed_mps: float = 1.0  # without a speed, a second is a metre
    most_targets: int | None = None
    ready_s: float = 0.0  # of a route with any visit, beyond flying and serving: take-off and landing
    usable_wh: float | None = None  # of its battery, the reserve taken off; None: nothing is known of its energy
    sorties: int = 1  # how often it may fly at most
    turnaround_s: float = 0.0  # from the landing of one sortie to the take-off for the next

    @property
    def limit_m(self) -> float:
        return math.inf if self.max_range_m is None else self.max_range_m * (1.0 - RANGE_RESERVE)

    @property
    def limit_wh(self) -> float:
        return math.inf if self.usable_wh is None else self.usable_wh * (1.0 - RANGE_RESERVE)

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
class Resources:
    """Seconds or Wh of u UAVs in c classes and v visits that do not follow from the metres; inf or nan where there is no way.

    first   (u, v)     start of each UAV to where each visit begins
    onward  (c, v, v)  where the row's visit ends to where the column's begins; wind makes the two directions differ
    end     (v, u)     where each visit ends to where each UAV's route ends; 0 if it ends there
    along   (c, v)     along the visit; without it 0
    service (c, v)     of what is done at the visit, beyond its `service_s`; without it 0
    ready   (u,)       of a route with any visit, beyond its UAV's `ready_s`; without it 0
    """

    first: FloatArray
    onward: FloatArray
    end: FloatArray
    along: FloatArray | None = None
    service: FloatArray | None = None
    ready: FloatArray | None = None

    @cached_property
    def at_visit(self) -> FloatArray:
        """Along each visit and for what is done there, (c, v)."""
        at_visit = np.zeros(self.onward.shape[:2])
        for part in (self.along, self.service):
            if part is not None:
                at_visit += part
        return at_visit

    def of_route(self, uav: int, of_class: int, route: Sequence[int]) -> float:
        """Of the visits in order and on to where the UAV ends; 0 for no visit, inf without a way."""
        if not route:
            return 0.0
        amount = float(self.first[uav, route[0]]) + sum(float(self.at_visit[of_class, visit]) for visit in route)
        amount += sum(float(self.onward[of_class, left, right]) for left, right in pairwise(route)) + float(self.end[route[-1], uav])
        amount += 0.0 if self.ready is None else float(self.ready[uav])
        return math.inf if math.isnan(amount) else amount

    def taken(self, first: IntArray, last: IntArray, at_visit: FloatArray) -> "Resources":
        """For runs of visits in place of visits: their first and last ones, and what each run takes from end to end (c, runs)."""
        return Resources(self.first[:, first], self.onward[:, last][:, :, first], self.end[last], along=at_visit, ready=self.ready)

    def of_uavs(self, uavs: IntArray) -> "Resources":
        return replace(
            self, first=self.first[uavs], end=self.end[:, uavs], ready=None if self.ready is None else np.asarray(self.ready)[uavs]
        )


@dataclass(frozen=True, eq=False)
class Problem:
    """u UAVs, v visits that do `target_count` targets; metres, inf where there is no way.

    from_start_m (u, v)  start of each UAV to where each visit begins
    between_m    (v, v)  where the row's visit ends to where the column's begins
    to_start_m   (v, u)  where each visit ends to the start of each UAV
    to_base_m    (v, u)  where each visit ends to the nearest base that is open to each UAV; needed if one may end at any base
    allowed      (u, v)  which visits each UAV may fly; without it all
    cannot_end   (v, u)  where a UAV's route must not end, though it may pass; without it nowhere
    priorities   one for each target; without them all alike
    weights      (targets,) what leaving out each target weighs, given by who knows better than the priorities (see `left_out_weights`)
    seconds      of flying; without them metres over the speed
    wh           of flying; needed if a battery is limited or the objective is energy
    class_of     (u,) the class of each UAV in `seconds` and `wh`: those that fly alike share one; without it all are of class 0
    owner        (u,) neighbours with the same number are sorties of one UAV (see `sorties.py`); without it each is a UAV of its own
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
    seconds: Resources | None = None
    wh: Resources | None = None
    class_of: tuple[int, ...] = ()
    owner: tuple[int, ...] = ()
    cannot_end: BoolArray | None = None

    def __post_init__(self) -> None:
        uavs, visits = len(self.uavs), len(self.visits)
        if len(self.class_of) not in (0, uavs) or len(self.owner) not in (0, uavs):
            raise InvalidProblem("each UAV needs a class and an owner, or none has one")
        if self.objective is Objective.ENERGY and (self.wh is None or any(uav.usable_wh is None for uav in self.uavs)):
            raise InvalidProblem("the least energy is asked for, but of a UAV's energy nothing is known")
        if self.wh is None and any(uav.limit_wh < math.inf for uav in self.uavs):
            raise InvalidProblem("a battery is limited, but the Wh are missing")
        if any(uav.sorties < 1 or uav.turnaround_s < 0 or (uav.sorties > 1 and uav.end is not End.RETURN) for uav in self.uavs):
            raise InvalidProblem("only a UAV that returns can fly several sorties, and each flies one or more")
        for resources in (self.seconds, self.wh):
            if resources is None:
                continue
            classes = max(self.class_of, default=0) + 1
            if (
                resources.first.shape != (uavs, visits)
                or resources.onward.shape[1:] != (visits, visits)
                or len(resources.onward) < classes
                or resources.end.shape != (visits, uavs)
            ):
                raise InvalidProblem("seconds or Wh do not fit the UAVs and visits")
            parts = (
                resources.first,
                resources.onward,
                resources.end,
                resources.at_visit,
                *(() if resources.ready is None else (resources.ready,)),
            )
            if any(np.count_nonzero(np.asarray(part) < 0) for part in parts):
                raise InvalidProblem("seconds or Wh are below 0")

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
        if self.cannot_end is not None:
            end_m[self.cannot_end] = np.inf
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
        if self.seconds is not None:
            return self.seconds.of_route(uav, self.class_number(uav), route) + service_s + self.uavs[uav].ready_s
        return self.route_length_m(uav, route) / self.uavs[uav].speed_mps + service_s + self.uavs[uav].ready_s

    def route_wh(self, uav: int, route: Sequence[int]) -> float | None:
        """Wh of the route, 0 for no visit; None if nothing is known of the UAV's energy."""
        if self.wh is None or self.uavs[uav].usable_wh is None:
            return None
        return self.wh.of_route(uav, self.class_number(uav), route)

    def class_number(self, uav: int) -> int:
        return self.class_of[uav] if self.class_of else 0

    def durations_s(self, routes: "Routes") -> list[float]:
        """Seconds of each UAV, those between its sorties among them; in order of the owners."""
        if not self.owner:
            return [self.route_duration_s(uav, route) for uav, route in enumerate(routes)]
        durations_s: dict[int, float] = dict.fromkeys(self.owner, 0.0)
        for uav, route in enumerate(routes):
            if route:
                between_s = self.uavs[uav].turnaround_s if durations_s[self.owner[uav]] else 0.0
                durations_s[self.owner[uav]] += self.route_duration_s(uav, route) + between_s
        return list(durations_s.values())

    def total_wh(self, routes: "Routes") -> float | None:
        """Wh of the routes of which any are known; None if of none."""
        known = [wh for uav, route in enumerate(routes) if (wh := self.route_wh(uav, route)) is not None]
        return sum(known) if known else None

    def value(self, routes: "Routes") -> float:
        """What the objective counts: metres, seconds or Wh."""
        if self.objective is Objective.TOTAL:
            return sum(self.route_length_m(uav, route) for uav, route in enumerate(routes))
        if self.objective is Objective.ENERGY:
            return self.total_wh(routes) or 0.0
        durations_s = self.durations_s(routes)
        return sum(durations_s) if self.objective is Objective.TIME else max(durations_s, default=0.0)

    def keeps_limits(self, uav: int, route: Sequence[int]) -> bool:
        """Whether the UAV can and may fly the route."""
        length_m, wh = self.route_length_m(uav, route), self.route_wh(uav, route)
        done = sum(self.visits[visit].done for visit in route)
        return (
            math.isfinite(length_m)
            and math.isfinite(self.route_duration_s(uav, route))
            and length_m <= self.uavs[uav].limit_m
            and (wh is None or wh <= self.uavs[uav].limit_wh)
            and done <= self.uavs[uav].most
            and all(self.may_fly(uav, visit) for visit in route)
        )


Routes = tuple[tuple[int, ...], ...]  # visits in order, one tuple per UAV


class UnassignedReason(StrEnum):
    """Why a target is not visited."""

    NO_PATH = "no_path"
    BEYOND_RANGE = "beyond_range"
    BEYOND_ENERGY = "beyond_energy"
    NOT_ALLOWED = "not_allowed"
    MAX_TARGETS = "most_targets"


@dataclass(frozen=True)
class Unassigned:
    """missing: metres or Wh that the UAV which comes nearest to it lacks, 0 where it is in reach alone; None for other reasons.

    `uav` is the one that lacks them, by its number in the problem with a row for each UAV. A problem has no names: where `why` has a
    param `uav`, `assignment.unassigned` fills it in.
    """

    target: int
    reason: UnassignedReason
    why: Reason
    missing: float | None = None
    uav: int | None = None


@dataclass(frozen=True)
class Solution:
    """Visits in order for each UAV, and the targets that nobody visits, each with the reason.

    `sorties` are the same visits by UAV and sortie; a UAV that stays on the ground has none. `longest_m` and `longest_s` are of all
    sorties of a UAV, with what lies between them. `total_wh` is of the UAVs of whose energy anything is known, None if of none.
    `lower_bound` is in the objective's own unit, metres for the total, seconds for the longest route and the time, Wh for the energy: no
    plan that leaves out as little as the best one has less. `gap` is the share of this plan's value that lies above it.
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
    sorties: tuple[Routes, ...]
    total_s: float
    total_wh: float | None


def merit(problem: Problem, routes: Routes) -> tuple[float, float, float]:
    """Less is better: what is not visited by weight, then the objective, then another measure.

    That is the longest seconds; for the longest route the total, of metres or of the seconds that the problem has for itself.
    """
    weights = problem.left_out_weights
    missed = float(weights.sum()) - float(sum(weights[problem.visits[visit].target] for route in routes for visit in route))
    if problem.objective is not Objective.MAKESPAN:
        return missed, problem.value(routes), max(problem.durations_s(routes), default=0.0)
    if problem.seconds is not None:
        return (
            missed,
            problem.value(routes),
            sum(problem.seconds.of_route(uav, problem.class_number(uav), route) for uav, route in enumerate(routes)),
        )
    return missed, problem.value(routes), sum(problem.route_length_m(uav, route) for uav, route in enumerate(routes))
