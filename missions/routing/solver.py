"""Assignment and order: exact for a few targets, else by OR-tools side by side with plain insertion; the better plan is kept."""

import math
from collections.abc import Callable, Sequence
from itertools import count

import numpy as np
from numpy.typing import NDArray
from ortools.constraint_solver import pywrapcp, routing_enums_pb2

from missions.routing import exact
from missions.routing.insertion import ArcTable, insertion_plans, ruin_and_recreate, with_missing_inserted
from missions.routing.locks import reduced
from missions.routing.problem import Objective, Problem, Routes, Solution, Unassigned, merit
from missions.routing.reach import needed_range_m, reachable, reasons

CM_PER_M = 100
UNLIMITED_CM = 10**12  # ten million kilometres: longer than any route, short enough for sums in 64 bits
FORBIDDEN_CM = UNLIMITED_CM + 1  # no UAV has the range for it
SPAN_WEIGHT = 1_000  # a metre off the longest route is worth so many off the total
LOOK_INTERVAL_MS = 100  # how often `stop` is asked
LOOKS_PER_CLOCK = 64  # OR-tools looks at its limits hundreds of thousands of times a second; the clock is read now and then
DESCENT_S = 5.0  # no descent of a problem without a search takes longer
INSERTION_STARTS = 2
ROUND_VISITS_PER_S = 150_000  # how much taking out and putting back fills about a second: rounds times visits
MOST_ROUNDS_PER_S = 1_500

FIRST_SOLUTIONS = (
    routing_enums_pb2.FirstSolutionStrategy.PARALLEL_CHEAPEST_INSERTION,
    routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC,
    routing_enums_pb2.FirstSolutionStrategy.SAVINGS,
)

Stop = Callable[[], bool]
OnProgress = Callable[[float, str], None]


def never() -> bool:
    return False


def no_report(progress: float, message: str) -> None:
    """For callers that do not watch."""


def solve(problem: Problem, *, stop: Stop = never, on_progress: OnProgress = no_report, seed: int = 7, search_s: float = 0.0) -> Solution:
    """The best plan found: first as many targets as possible, then the objective.

    Every route keeps its UAV's range. Up to 12 targets the plan is the best there is. Beyond, the answer depends on the problem and the
    seed alone as long as `search_s` is 0; with it a guided search goes on for about so many seconds. `stop` is asked several times a
    second while OR-tools searches; once it is true, the best plan so far is returned.
    """
    whole = reduced(problem) if problem.locks else None
    solved = problem if whole is None else whole.problem
    needed_m = needed_range_m(solved)
    usable = reachable(solved, needed_m)
    empty: Routes = ((),) * len(problem.uavs)
    if not usable.any():
        routes = empty
    elif solved.target_count <= exact.MAX_TARGETS:
        routes = exact.best_plan(solved)
    else:
        routes = searched_plan(solved, usable, stop=stop, on_progress=on_progress, seed=seed, search_s=search_s)
    left_out = reasons(solved, needed_m, routes)
    if whole is not None:
        routes, left_out = whole.expanded(routes), whole.expanded_reasons(left_out)
    return _solution(problem, routes, left_out)


def searched_plan(
    problem: Problem, usable: NDArray[np.bool_], *, stop: Stop, on_progress: OnProgress, seed: int, search_s: float
) -> Routes:
    """The best of several descents of OR-tools and plain insertions, and of a guided search if there is time for one."""

    def better(*plans: Routes) -> Routes:
        return min(plans, key=lambda routes: merit(problem, routes))

    on_progress(0.0, "Looking for a first plan")
    insertions = insertion_plans(problem, usable, seed=seed)
    best = better(*insertions)
    descent_s = search_s / 5 if search_s else DESCENT_S
    starts: list[int | Routes] = [*FIRST_SOLUTIONS, *insertions[:INSERTION_STARTS]]
    for number, start in enumerate(starts, start=1):
        if stop():
            break
        best = better(best, _Model(problem, usable, stop).descend(start, descent_s))
        on_progress(0.3 * number / len(starts), _progress_message(problem, best))
    if search_s and not stop():
        if problem.objective is Objective.TOTAL:
            best = better(best, _Model(problem, usable, stop).search(best, search_s, on_progress))
        else:  # OR-tools' guided search bends arcs; the longest route hardly feels it

            def on_round(share: float, routes: Routes) -> None:
                on_progress(0.3 + 0.7 * share, _progress_message(problem, routes))

            rounds = int(search_s * min(MOST_ROUNDS_PER_S, ROUND_VISITS_PER_S / len(problem.visits)))
            best = ruin_and_recreate(problem, best, usable, seed=seed, rounds=rounds, stop=stop, on_round=on_round)
    best = with_missing_inserted(problem, best, usable)
    on_progress(1.0, _progress_message(problem, best))
    return best


def _solution(problem: Problem, routes: Routes, left_out: tuple[Unassigned, ...]) -> Solution:
    lengths_m = [problem.route_length_m(uav, route) for uav, route in enumerate(routes)]
    longest_s = max((problem.route_duration_s(uav, route) for uav, route in enumerate(routes)), default=0.0)
    return Solution(routes, left_out, sum(lengths_m), max(lengths_m, default=0.0), longest_s, 0.0, 1.0, False, "")


def _progress_message(problem: Problem, routes: Routes) -> str:
    missed, length_m, _ = merit(problem, routes)
    left_out = f", {missed:.0f} not reached" if missed else ""
    length = f"{length_m / 1_000:,.1f} km"
    return f"{length} in total{left_out}" if problem.objective is Objective.TOTAL else f"longest route {length}{left_out}"


class _Model:
    """The problem as OR-tools has it: starts, visits and ends are nodes, arcs are whole centimetres rounded up.

    Rounding up, with the ranges rounded down, is why no route is ever longer than its UAV can fly. A model is good for one search:
    OR-tools 9.15 gives up at once when it is asked again after a guided search.
    """

    def __init__(self, problem: Problem, usable: NDArray[np.bool_], stop: Stop) -> None:
        self.problem = problem
        uavs, visits = len(problem.uavs), len(problem.visits)
        self.first_visit = uavs
        arc_cm = _arcs_cm(problem, usable)
        nodes = len(arc_cm)
        self.manager = pywrapcp.RoutingIndexManager(nodes, uavs, list(range(uavs)), list(range(uavs + visits, nodes)))
        self.routing = pywrapcp.RoutingModel(self.manager)
        transit = self.routing.RegisterTransitMatrix(arc_cm.tolist())
        self.routing.SetArcCostEvaluatorOfAllVehicles(transit)
        limits_cm = [
            UNLIMITED_CM if math.isinf(uav.limit_m) else min(UNLIMITED_CM, math.floor(uav.limit_m * CM_PER_M)) for uav in problem.uavs
        ]
        self.routing.AddDimensionWithVehicleCapacity(transit, 0, limits_cm, True, "length")
        span_weight = SPAN_WEIGHT if problem.objective is Objective.MAKESPAN else 0
        self.routing.GetDimensionOrDie("length").SetGlobalSpanCostCoefficient(span_weight)
        longest_arc_cm = int(arc_cm[arc_cm < FORBIDDEN_CM].max(initial=0))
        dearer_than_any_plan = (longest_arc_cm + 1) * (problem.target_count + uavs) * (span_weight + 1)
        for alternatives in filter(None, problem.visits_of_target()):
            self.routing.AddDisjunction(
                [self.manager.NodeToIndex(self.first_visit + visit) for visit in alternatives], dearer_than_any_plan
            )
        self._watch(stop)

    def _watch(self, stop: Stop) -> None:
        """Ask `stop` from within every search, not oftener than needed."""
        solver = self.routing.solver()
        self.stopped = False
        self.looked_at_ms = solver.WallTime()
        self.report: Callable[[int], None] | None = None

        looks = count(1)

        def is_over() -> bool:
            if next(looks) % LOOKS_PER_CLOCK:
                return self.stopped
            now_ms = solver.WallTime()
            if not self.stopped and now_ms - self.looked_at_ms >= LOOK_INTERVAL_MS:
                self.looked_at_ms = now_ms
                self.stopped = stop()
                if self.report is not None:
                    self.report(now_ms)
            return self.stopped

        self.limit = solver.CustomLimit(is_over)
        self.routing.AddSearchMonitor(self.limit)

    def descend(self, start: int | Routes, limit_s: float) -> Routes:
        """Go downhill from a first solution strategy, or from a plan, until nothing improves."""
        parameters = pywrapcp.DefaultRoutingSearchParameters()
        parameters.time_limit.FromMilliseconds(max(1, int(limit_s * 1_000)))
        if isinstance(start, int):
            parameters.first_solution_strategy = start
            return self._routes(self.routing.SolveWithParameters(parameters))
        return self._from_plan(start, parameters)

    def search(self, plan: Routes, search_s: float, on_progress: OnProgress) -> Routes:
        best = plan
        began_ms = self.routing.solver().WallTime()

        def report(now_ms: int) -> None:
            share = min(1.0, (now_ms - began_ms) / (search_s * 1_000))
            on_progress(0.3 + 0.7 * share, _progress_message(self.problem, best))

        self.report = report
        best = min(best, self._from_plan(plan, self._guided(search_s)), key=lambda routes: merit(self.problem, routes))
        self.report = None
        return best

    def _guided(self, limit_s: float) -> pywrapcp.DefaultRoutingSearchParameters:
        parameters = pywrapcp.DefaultRoutingSearchParameters()
        parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
        parameters.time_limit.FromMilliseconds(max(1, int(limit_s * 1_000)))
        return parameters

    def _from_plan(self, plan: Routes, parameters: pywrapcp.DefaultRoutingSearchParameters) -> Routes:
        indices = [[self.manager.NodeToIndex(self.first_visit + visit) for visit in route] for route in plan]
        assignment = self.routing.ReadAssignmentFromRoutes(indices, True)
        if assignment is None:  # rounded up to centimetres the plan is a hair too long
            return plan
        found = self._routes(self.routing.SolveFromAssignmentWithParameters(assignment, parameters))
        return min(plan, found, key=lambda routes: merit(self.problem, routes))

    def _routes(self, assignment: pywrapcp.Assignment | None) -> Routes:
        """The plan of an assignment; without one nobody flies."""
        uavs = len(self.problem.uavs)
        if assignment is None:
            return ((),) * uavs
        return tuple(tuple(self._route(assignment, uav)) for uav in range(uavs))

    def _route(self, assignment: pywrapcp.Assignment, uav: int) -> Sequence[int]:
        route = []
        index = assignment.Value(self.routing.NextVar(self.routing.Start(uav)))
        while not self.routing.IsEnd(index):
            route.append(self.manager.IndexToNode(index) - self.first_visit)
            index = assignment.Value(self.routing.NextVar(index))
        return route


def _arcs_cm(problem: Problem, usable: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Arcs between starts, visits and ends; an arc contains the way along the visit that it leads to."""
    table = ArcTable(problem)
    uavs, visits = len(problem.uavs), len(problem.visits)
    metres = np.full((uavs + visits + uavs, uavs + visits + uavs), np.inf)
    metres[: uavs + visits, uavs:] = table.arc_m
    metres[:, uavs : uavs + visits] += table.along_m[None, :]
    flyable = np.concatenate([np.zeros(uavs, dtype=bool), usable.any(axis=0), np.ones(uavs, dtype=bool)])
    metres[:, ~flyable] = np.inf
    arc_cm = np.full(metres.shape, FORBIDDEN_CM, dtype=np.int64)
    finite = np.isfinite(metres)
    arc_cm[finite] = np.ceil(metres[finite] * CM_PER_M).astype(np.int64)
    return arc_cm
