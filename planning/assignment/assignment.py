"""From places and ways to the solver's problem with all that is wished; and what the locked runs cost."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from operation.reasons import Reason
from planning.assignment.options import may_do
from planning.assignment.refusals import Grounding
from planning.assignment.routing_input import RoutingInput
from planning.context import ResolvedTarget
from planning.energy.assignment_costs import FlightCosts
from planning.energy.duration import ready_s
from planning.plan import ALL_PLANS, WITHOUT_TIMED_ZONES
from planning.problem import BoolArray, Lock, Objective, Priority, Problem, Resources, Solution, UavStart, Visit
from planning.request import EndAction, LockRequest, PlanRequest, UavRequest
from planning.rules import FlightRules
from planning.solver.exact import MAX_TARGETS
from planning.solver.search import OnProgress, Progress
from planning.solver.solver import PROVEN_GAP, Effort, Stop, solve
from planning.solver.sorties import merit_of

CHARGED_WH = 1e6
COUNTED_CLOSE = 1e-4  # by less of the battery do what is counted and what is drawn differ over ground that is known
NOTHING_TAKEN_OFF: Mapping[int, float] = {}
NOTHING_KEPT: Mapping[int, Collection[int]] = {}
# What a finished route takes beyond what the search counted, in the objective's unit, and still is rounding.
UNCOUNTED = {Objective.TOTAL: math.inf, Objective.MAKESPAN: 0.1, Objective.TIME: 0.1, Objective.ENERGY: 0.01}


@dataclass(frozen=True, eq=False)
class Assignment:
    """What is to be solved. `free` is the problem without the locks; `held_back` says of places, by their number, why no route has them.

    A run of which a part cannot be flown is held back as a whole.
    """

    problem: Problem
    free: Problem | None
    held_back: dict[int, tuple[Reason, ...]]


def least_ready_s(action: EndAction, cruise_speed_mps: float, targets_agl_m: Sequence[float], rules: FlightRules) -> float:
    return ready_s(
        targets_agl_m,
        lands=action is not EndAction.HOVER,
        ends_at_target=action in (EndAction.HOVER, EndAction.LAND),
        cruise_speed_mps=cruise_speed_mps,
        rules=rules,
    )


def assignment(
    routing: RoutingInput,
    uavs: Sequence[int],
    grounded: Mapping[int, Grounding],
    ready: Sequence[float],
    costs: FlightCosts | None = None,
    usable_share: Mapping[int, float] = NOTHING_TAKEN_OFF,
    no_landing: Collection[int] = (),
    kept_from: Mapping[int, Collection[int]] = NOTHING_KEPT,
) -> Assignment:
    """uavs: those that fly, by their places in the request; ready [s]: of each UAV's route.

    costs: seconds and Wh where they do not follow from the metres; ready, and what the visits take, are then among them. usable_share:
    of a UAV's usable battery, by its place in the request, what the search may count on. no_landing: targets, by their numbers, where a
    UAV must not go down to the ground. kept_from: of a UAV, by its place in the request, the targets that it is not to fly to.
    """
    request, targets, visits, ways = routing.request, routing.targets, routing.visits, routing.ways
    if not uavs:
        costs = None  # nothing flies: there is nothing to count
    asked_targets = [request.targets[target.target] for target in targets]
    ends = {request.end_action(uav) for uav in uavs}
    free = Problem(
        uavs=tuple(
            UavStart(
                asked.max_range_m,
                request.route_end(uav),
                asked.cruise_speed_mps,
                asked.most_targets,
                own_ready_s,
                usable_wh=_usable_wh(asked, usable_share.get(uav), may_charge=request.may_charge(uav)),
                sorties=asked.sorties,
                turnaround_s=routing.airspace.flight.turnaround_s,
            )
            for uav, asked, own_ready_s in ((uav, request.uavs[uav], own_ready_s) for uav, own_ready_s in zip(uavs, ready, strict=True))
        ),
        visits=tuple(visits),
        target_count=len(targets),
        from_start_m=ways.from_start_m,
        between_m=ways.between_m,
        to_start_m=ways.to_start_m,
        objective=request.objective if uavs else Objective.TOTAL,
        to_base_m=np.broadcast_to(ways.to_base_m[:, None], (len(visits), len(uavs))) if EndAction.BASE in ends else None,
        allowed=allowed_visits(request, uavs, targets, visits, kept_from)
        if kept_from or any(target.uav or target.sensor for target in asked_targets)
        else None,
        priorities=tuple(target.priority for target in asked_targets)
        if any(target.priority != Priority.NORMAL for target in asked_targets)
        else (),
        seconds=None if costs is None else Resources(**vars(costs.seconds)),
        wh=None if costs is None else Resources(**vars(costs.wh)),
        class_of=() if costs is None else costs.class_of,
        cannot_end=_cannot_end(request, uavs, visits, no_landing) if no_landing else None,
    )
    if not request.locks:
        return Assignment(free, None, {})
    held_back, locks = _runs(request, uavs, targets, grounded)
    return Assignment(replace(free, locks=locks, allowed=_without(free, held_back)), free, held_back)


def _cannot_end(request: PlanRequest, uavs: Sequence[int], visits: Sequence[Visit], no_landing: Collection[int]) -> BoolArray:
    """(v, u): visits of the places at which UAVs that land at their last target must not do so."""
    lands = np.array([request.end_action(uav) is EndAction.LAND for uav in uavs], dtype=bool)
    barred: BoolArray = np.array([visit.target in no_landing for visit in visits], dtype=bool)[:, None] & lands
    return barred


def _usable_wh(asked: UavRequest, share: float | None, *, may_charge: bool) -> float | None:
    """What the search may count on; where a UAV charges on the way, and nothing has shown yet that it cannot, as much as it likes."""
    usable_wh = asked.performance.usable_wh
    if usable_wh is not None and may_charge and share is None:
        return CHARGED_WH
    return None if usable_wh is None else usable_wh * (1.0 if share is None else share) * (1.0 - COUNTED_CLOSE)


def allowed_visits(
    request: PlanRequest,
    uavs: Sequence[int],
    targets: Sequence[ResolvedTarget],
    visits: Sequence[Visit],
    kept_from: Mapping[int, Collection[int]] = NOTHING_KEPT,
) -> BoolArray:
    """Which visits each UAV may fly, (u, v)."""
    of_place = [
        [may_do(request.uavs[uav], request.targets[target.target]) and target.target not in kept_from.get(uav, ()) for target in targets]
        for uav in uavs
    ]
    allowed = np.array(of_place, dtype=bool).reshape(len(uavs), len(targets))
    return allowed[:, [visit.target for visit in visits]]


def _without(problem: Problem, held_back: dict[int, tuple[Reason, ...]]) -> BoolArray | None:
    if not held_back:
        return problem.allowed
    allowed = np.ones((len(problem.uavs), len(problem.visits)), dtype=bool) if problem.allowed is None else problem.allowed
    without: BoolArray = allowed & np.array([visit.target not in held_back for visit in problem.visits], dtype=bool)
    return without


def _runs(
    request: PlanRequest, uavs: Sequence[int], targets: Sequence[ResolvedTarget], grounded: Mapping[int, Grounding]
) -> tuple[dict[int, tuple[Reason, ...]], tuple[Lock, ...]]:
    """What is left of runs that cannot be flown, with the reason, and the runs that can."""
    start_of = {request.uavs[uav].name: start for start, uav in enumerate(uavs)}
    on_the_ground = {request.uavs[uav].name: grounding.why for uav, grounding in grounded.items()}
    place_of = {target.target: number for number, target in enumerate(targets)}
    held_back: dict[int, tuple[Reason, ...]] = {}
    locks: list[Lock] = []
    for lock in request.locks:
        if lock.uav in on_the_ground:
            held_back |= _held(lock, place_of, (Reason("locked_to_grounded", {"uav": lock.uav}), on_the_ground[lock.uav]))
        elif any(target not in place_of for target in lock.targets):
            held_back |= _held(lock, place_of, (Reason("locked_to_unreachable"),))
        else:
            locks.append(Lock(start_of[lock.uav], tuple(place_of[target] for target in lock.targets), lock.at_start, lock.at_end))
    return held_back, tuple(locks)


def _held(lock: LockRequest, place_of: dict[int, int], why: tuple[Reason, ...]) -> dict[int, tuple[Reason, ...]]:
    return {place_of[target]: why for target in lock.targets if target in place_of}


@dataclass(frozen=True)
class LockCost:
    """The plan with the locks less the plan without them. Costs are None where the two do not reach as many targets."""

    cost_m: float | None
    cost_s: float | None
    free_total_m: float
    free_longest_s: float
    left_out: int


def solve_assignment(asked: Assignment, *, stop: Stop, on_progress: OnProgress, effort: Effort) -> tuple[Solution, LockCost | None]:
    """The plan; where runs are locked also what that costs. Where a search is needed the two plans share its time half and half.

    The prover is asked for the plan with the locks alone.
    """
    if asked.free is None:
        return solve(asked.problem, stop=stop, on_progress=on_progress, **vars(effort)), None
    half = effort.times(0.5) if asked.free.target_count > MAX_TARGETS else effort

    def first_half(reported: Progress) -> None:
        on_progress(replace(reported, share=reported.share / 2.0))

    def second_half(reported: Progress) -> None:
        on_progress(Progress(0.5 + reported.share / 2.0, Reason("working_out_locked")))  # what is drawn stays the plan with the locks

    solution = solve(asked.problem, stop=stop, on_progress=first_half, **vars(half))
    free = solve(asked.free, stop=stop, on_progress=second_half, seed=half.seed, search_s=half.search_s)
    return solution, _cost(asked.free, solution, free)


def _cost(problem: Problem, solution: Solution, free: Solution) -> LockCost:
    """The plan with the locks is one without them, too: where the search without them finds nothing better, they cost nothing."""
    if merit_of(problem, solution.sorties) <= merit_of(problem, free.sorties):
        free = solution
    left_out = len(solution.unassigned) - len(free.unassigned)
    is_comparable = {item.target for item in solution.unassigned} == {item.target for item in free.unassigned}
    return LockCost(
        cost_m=solution.total_m - free.total_m if is_comparable else None,
        cost_s=solution.longest_s - free.longest_s if is_comparable else None,
        free_total_m=free.total_m,
        free_longest_s=free.longest_s,
        left_out=left_out,
    )


def quality_of(
    solution: Solution, cost: LockCost | None, objective: Objective, *, value: float, share_of_freest: float | None = 1.0
) -> dict[str, object]:
    """Bound, gap, method and the cost of the locks in the shape of the API.

    value is of the finished routes, in what the objective counts; the bound stays below it, whatever the drawing has rounded. What the
    search does not count (turns of the course; climbs over hills and tall assets, where no battery or wind makes it count them) makes
    routes longer than it thought, and the gap wider: a plan is proven only if its finished routes are.

    Where zones are in force for a part of the flight, `solution` is that on those alone that are so all the time, and share_of_freest
    what it is worth beside this plan. As far as it is better, this plan is not proven, and bound and gap are of plans that keep clear of
    those zones alone, along the ways that are preferred there. None: it leaves out other targets, and tells nothing.
    """
    lower = min(solution.lower_bound, value)
    bound: float | None = lower
    gap: float | None = solution.gap
    is_proven, gap_of = solution.is_proven, ALL_PLANS
    if share_of_freest is None:
        bound, gap, is_proven = None, None, False
    elif share_of_freest < 1.0 - PROVEN_GAP:
        gap, is_proven, gap_of = (value - lower) / value, False, WITHOUT_TIMED_ZONES
    elif value - _own_value(solution, objective) > UNCOUNTED[objective]:
        gap, is_proven = (value - lower) / value, False
    in_seconds = objective in (Objective.MAKESPAN, Objective.TIME)
    return {
        "lower_bound_m": math.floor(bound * 1_000) / 1_000 if bound is not None and objective is Objective.TOTAL else None,
        "lower_bound_s": math.floor(bound * 10) / 10 if bound is not None and in_seconds else None,
        "lower_bound_wh": math.floor(bound * 100) / 100 if bound is not None and objective is Objective.ENERGY else None,
        "gap": None if gap is None else round(gap, 6),
        "is_proven": is_proven,
        "gap_of": gap_of,
        "method": solution.method,
        "wish": None if cost is None else {name: value if value is None else round(value, 3) for name, value in vars(cost).items()},
    }


def _own_value(solution: Solution, objective: Objective) -> float:
    """What the search thought the plan to be worth."""
    values = {
        Objective.TOTAL: solution.total_m,
        Objective.MAKESPAN: solution.longest_s,
        Objective.TIME: solution.total_s,
        Objective.ENERGY: solution.total_wh or 0.0,
    }
    return values[objective]
