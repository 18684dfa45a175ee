"""Assignment and order: proven for a few targets, else the best plan of several searches side by side, with a bound below it."""

from collections.abc import Callable

from missions.routing import exact
from missions.routing.locks import reduced
from missions.routing.problem import BoolArray, FloatArray, Objective, Problem, Routes, Solution, Unassigned
from missions.routing.progress import OnProgress, Progress
from missions.routing.reach import needed_range_m, reachable, reasons
from missions.routing.search import Found, best_found

PROVEN_GAP = 1e-8  # the bound stays a hair below what it proves
EXACT, SEARCH = "exact", "ruin and recreate"  # what Solution.method says

Stop = Callable[[], bool]


def never() -> bool:
    return False


def no_report(progress: Progress) -> None:
    """For callers that do not watch."""


def solve(problem: Problem, *, stop: Stop = never, on_progress: OnProgress = no_report, seed: int = 7, search_s: float = 0.0) -> Solution:
    """The best plan found: first it leaves out as little as possible, high priorities last, then the objective counts.

    Every route keeps its UAV's limits, and a locked run is flown as it is wished or left out whole. Up to 12 targets, a locked run being
    one, the plan is the best there is. Beyond, the answer depends on the problem and the seed alone as long as `search_s` is 0; with it
    the search takes about so many seconds. `stop` is asked several times a second; once it is true, the best plan so far is returned.
    Raises InvalidProblem.
    """
    if problem.locks:
        whole = reduced(problem)
        routes, left_out, bound, method = _solved(
            whole.problem,
            stop=stop,
            on_progress=lambda told: on_progress(_expanded(told, whole.expanded)),
            seed=seed,
            search_s=search_s,
        )
        routes, left_out = whole.expanded(routes), whole.expanded_reasons(left_out)
    else:
        routes, left_out, bound, method = _solved(problem, stop=stop, on_progress=on_progress, seed=seed, search_s=search_s)
    return _solution(problem, routes, left_out, bound, method)


def _solved(
    problem: Problem, *, stop: Stop, on_progress: OnProgress, seed: int, search_s: float
) -> tuple[Routes, tuple[Unassigned, ...], float | None, str]:
    """Routes, what they leave out, a bound (none: the plan is the best there is), and the method."""
    if problem.target_count <= exact.MAX_TARGETS:
        routes = exact.best_plan(problem)
        if sum(len(route) for route in routes) == problem.target_count:
            return routes, (), None, EXACT
        return routes, reasons(problem, needed_range_m(problem), routes), None, EXACT
    needed_m = needed_range_m(problem)
    usable = reachable(problem, needed_m)
    if not usable.any():
        routes = ((),) * len(problem.uavs)
        return routes, reasons(problem, needed_m, routes), None, EXACT
    found = searched_plan(problem, usable, needed_m, stop=stop, on_progress=on_progress, seed=seed, search_s=search_s)
    return found.routes, reasons(problem, needed_m, found.routes), found.bound, SEARCH


def searched_plan(
    problem: Problem, usable: BoolArray, needed_m: FloatArray, *, stop: Stop, on_progress: OnProgress, seed: int, search_s: float
) -> Found:
    """The best plan of the search; usable (u, v) says which UAV can fly which visit at all, needed_m (u, v) with what range."""
    on_progress(Progress(0.0, "Looking for a first plan"))

    def on_look(share: float, found: Found) -> None:
        on_progress(Progress(min(share, 0.99), progress_message(problem, found.routes), found.routes, found.bound))

    found = best_found(problem, usable, needed_m, seed=seed, search_s=search_s, stop=stop, on_look=on_look)
    on_progress(Progress(1.0, progress_message(problem, found.routes), found.routes, found.bound))
    return found


def _expanded(told: Progress, expanded: Callable[[Routes], Routes]) -> Progress:
    return told if told.best_routes is None else Progress(told.share, told.message, expanded(told.best_routes), told.bound)


def _solution(problem: Problem, routes: Routes, left_out: tuple[Unassigned, ...], bound: float | None, method: str) -> Solution:
    lengths_m = [problem.route_length_m(uav, route) for uav, route in enumerate(routes)]
    longest_s = max((problem.route_duration_s(uav, route) for uav, route in enumerate(routes)), default=0.0)
    value = sum(lengths_m) if problem.objective is Objective.TOTAL else longest_s
    lower_bound = value if bound is None else min(value, bound)
    return Solution(
        routes,
        left_out,
        total_m=sum(lengths_m),
        longest_m=max(lengths_m, default=0.0),
        longest_s=longest_s,
        lower_bound=lower_bound,
        gap=(value - lower_bound) / value if value else 0.0,
        is_proven=value - lower_bound <= PROVEN_GAP * value,
        method=method,
    )


def progress_message(problem: Problem, routes: Routes) -> str:
    lengths_m = [problem.route_length_m(uav, route) for uav, route in enumerate(routes)]
    missed = problem.target_count - sum(len(route) for route in routes)
    left_out = f", {missed} not reached" if missed else ""
    if problem.objective is Objective.TOTAL:
        return f"{sum(lengths_m) / 1_000:,.1f} km in total{left_out}"
    return f"longest route {max(lengths_m, default=0.0) / 1_000:,.1f} km{left_out}"
