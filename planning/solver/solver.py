"""Assignment and order: proven for a few targets, else the best plan of several searches side by side, with a bound below it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from operation.reasons import Reason
from planning.problem import BoolArray, FloatArray, Objective, Problem, Routes, Solution, Unassigned
from planning.solver import exact
from planning.solver.contraction import Chain, Reduced, chains_of, in_pieces, with_runs
from planning.solver.locks import reduced
from planning.solver.lower_bounds import lower_bound
from planning.solver.problem_arrays import Arcs
from planning.solver.reach import needed_range_m, reachable, reasons
from planning.solver.search import Found, OnProgress, Progress, best_found
from planning.solver.sorties import by_uav, joined, unfolded

PROVEN_GAP = 1e-8  # the bound stays a hair below what it proves
PIECES = (1, 2, 4, 8)  # of each line, one after another
PIECES_SHARE = 0.4  # of the time of a search
EXACT, SEARCH = "exact", "ruin and recreate"  # what Solution.method says

MAX_PROVEN_TARGETS = 40  # of plans that a prover takes
PROOF_TO_SEARCH = 6  # a proof takes as many times as long as the search before it
SEARCH_SHARE = 1 / (1 + PROOF_TO_SEARCH)  # of the time of both

Stop = Callable[[], bool]


@dataclass(frozen=True, eq=False)
class BoundedPlan:
    """A plan of a problem, and a bound in the objective's unit; usable and needed_m as of `lower_bound`."""

    problem: Problem
    usable: BoolArray
    needed_m: FloatArray
    routes: Routes
    bound: float

    @property
    def is_proven(self) -> bool:
        value = self.problem.value(self.routes)
        return value - self.bound <= PROVEN_GAP * value


@dataclass(frozen=True)
class Proof:
    """The better of a plan and those found beside it, and a bound: None where there is no better plan. method: what ended the search."""

    routes: Routes
    bound: float | None
    method: str


class Prover(Protocol):
    """Looks for a better plan and a better bound. `proof.prove` loads a large library: only programs that prove something import it."""

    def __call__(
        self, found: BoundedPlan, *, time_s: float, stop: Stop, on_look: Callable[[float, Routes, float], None], seed: int
    ) -> Proof | None: ...


@dataclass(frozen=True)
class Effort:
    """How a solution is looked for; see `solve`."""

    seed: int = 7
    search_s: float = 0.0
    prover: Prover | None = None

    def times(self, share: float) -> "Effort":
        """The same with a share of the time."""
        return replace(self, search_s=self.search_s * share)


def never() -> bool:
    return False


def no_report(progress: Progress) -> None:
    """For callers that do not watch."""


def solve(
    problem: Problem,
    *,
    stop: Stop = never,
    on_progress: OnProgress = no_report,
    seed: int = 7,
    search_s: float = 0.0,
    prover: Prover | None = None,
) -> Solution:
    """The best plan found: first it leaves out as little as possible, high priorities last, then the objective counts.

    Every route keeps its UAV's limits, and a locked run is flown as it is wished or left out whole. Up to 12 targets, a locked run being
    one, the plan is the best there is; only where battery or range leave too many tours to weigh (see `tours.py`) the gap tells
    what is not proven. Beyond, the answer depends on the problem and the seed alone as long as `search_s` is 0; with it the search takes
    about so many seconds. `stop` is asked several times a second; once it is true, the best plan so far is returned. Progress tells the
    visits of each UAV over all its sorties. A plan that is not proven is then handed to the prover, if there is one, for PROOF_TO_SEARCH
    times as long. Raises InvalidProblem.
    """
    rows = unfolded(problem)

    def of_uavs(routes: Routes) -> Routes:
        return joined(by_uav(rows, routes)) if rows.owner else routes

    if problem.locks:
        whole = reduced(rows)
        routes, left_out, bound, method = _solved(
            whole.problem,
            stop=stop,
            on_progress=lambda reported: on_progress(_expanded(reported, lambda routes: of_uavs(whole.expanded(routes)))),
            seed=seed,
            search_s=search_s,
            prover=prover,
        )
        routes, left_out = whole.expanded(routes), whole.expanded_reasons(left_out)
        bound = bound if whole.is_whole else 0.0  # nothing is known of the ways through the runs that were not looked at
    else:
        tell = (lambda reported: on_progress(_expanded(reported, of_uavs))) if rows.owner else on_progress
        routes, left_out, bound, method = _solved(rows, stop=stop, on_progress=tell, seed=seed, search_s=search_s, prover=prover)
    return _solution(rows, routes, left_out, bound, method)


def _solved(
    problem: Problem, *, stop: Stop, on_progress: OnProgress, seed: int, search_s: float, prover: Prover | None
) -> tuple[Routes, tuple[Unassigned, ...], float | None, str]:
    """Routes, what they leave out, a bound (none: the plan is the best there is), and the method."""
    if problem.target_count <= exact.MAX_TARGETS:
        routes, is_proven = exact.proven_routes(Arcs.of(problem))
        if is_proven and sum(len(route) for route in routes) == problem.target_count:
            return routes, (), None, EXACT
        needed_m = needed_range_m(problem)
        if is_proven:
            return routes, reasons(problem, needed_m, routes), None, EXACT
        usable = reachable(problem, needed_m)
        bounded = BoundedPlan(problem, usable, needed_m, routes, lower_bound(problem, usable, needed_m, routes, seed=seed))
        proof = _proven(bounded, EXACT, prover, stop=stop, on_progress=on_progress, seed=seed, search_s=search_s)
        return proof.routes, reasons(problem, needed_m, proof.routes), proof.bound, proof.method
    needed_m = needed_range_m(problem)
    usable = reachable(problem, needed_m)
    if not usable.any():
        routes = ((),) * len(problem.uavs)
        return routes, reasons(problem, needed_m, routes), None, EXACT
    chains = chains_of(problem)
    pieces = _coarse_problems(problem, chains)
    on_search = on_progress if prover is None else _until(SEARCH_SHARE, on_progress)
    searched_s = search_s * PIECES_SHARE * sum(map(_is_searched, pieces)) / len(PIECES)
    start = _plan_of_pieces(pieces, stop=stop, on_progress=on_search, seed=seed, search_s=searched_s)
    found = searched_plan(
        problem,
        usable,
        needed_m,
        stop=stop,
        on_progress=_from(PIECES_SHARE, on_search) if pieces else on_search,
        seed=seed,
        search_s=search_s - searched_s,
        start=start,
    )
    bounded = BoundedPlan(problem, usable, needed_m, with_runs(problem, chains, found.routes), found.bound or 0.0)
    proof = _proven(bounded, SEARCH, prover, stop=stop, on_progress=on_progress, seed=seed, search_s=search_s)
    return proof.routes, reasons(problem, needed_m, proof.routes), proof.bound, proof.method


def _proven(
    found: BoundedPlan, method: str, prover: Prover | None, *, stop: Stop, on_progress: OnProgress, seed: int, search_s: float
) -> Proof:
    """Return what a prover makes of a plan; the plan itself without one, if nothing is left to prove, or once it is stopped."""
    plan = Proof(found.routes, found.bound, method)
    if prover is None or found.is_proven or stop():
        return plan

    def on_look(share: float, routes: Routes, bound: float) -> None:
        over = SEARCH_SHARE + (1.0 - SEARCH_SHARE) * share
        on_progress(Progress(min(over, 0.99), progress_message(found.problem, routes), routes, bound))

    return prover(found, time_s=PROOF_TO_SEARCH * search_s, stop=stop, on_look=on_look, seed=seed) or plan


def _coarse_problems(problem: Problem, chains: Sequence[Chain]) -> list[Reduced]:
    """Return the problem with the parts of each line in few pieces: first whole, then cut more and more often; none without such parts."""
    pieces = [in_pieces(problem, chains, most) for most in PIECES] if chains else []
    return [coarse for coarse in pieces if coarse.problem.target_count < problem.target_count]


def _is_searched(coarse: Reduced) -> bool:
    return coarse.problem.target_count > exact.MAX_TARGETS


def _plan_of_pieces(pieces: Sequence[Reduced], *, stop: Stop, on_progress: OnProgress, seed: int, search_s: float) -> Routes:
    """Return the best plan found with lines in pieces, each search beginning with the plan of the one before.

    What is too far for a UAV in such a piece is left out.
    """
    routes: Routes = ()
    for number, coarse in enumerate(pieces):
        if stop():
            break
        problem = coarse.problem
        if not _is_searched(coarse):
            routes = coarse.expanded(exact.proven_routes(Arcs.of(problem))[0])
            continue
        needed_m = needed_range_m(problem)
        usable = reachable(problem, needed_m)
        if not usable.any():
            continue
        share = number / len(pieces)

        def on_look(own: float, found: Found, coarse: Reduced = coarse, share: float = share) -> None:
            at = PIECES_SHARE * (share + own / len(pieces))
            on_progress(Progress(at, progress_message(coarse.problem, found.routes), coarse.expanded(found.routes)))

        found = best_found(
            problem,
            usable,
            needed_m,
            seed=seed,
            search_s=search_s / sum(map(_is_searched, pieces)),
            stop=stop,
            on_look=on_look,
            start=coarse.contracted(routes) or (),
            is_bounded=False,
        )
        routes = coarse.expanded(found.routes)
    return routes


def _until(end: float, on_progress: OnProgress) -> OnProgress:
    """Return what tells of a search after which more follows."""
    return lambda told: on_progress(replace(told, share=end * told.share))


def _from(begin: float, on_progress: OnProgress) -> OnProgress:
    """Return what tells of the rest of a search, of which so much is over."""
    return lambda told: on_progress(replace(told, share=begin + (1.0 - begin) * told.share))


def searched_plan(
    problem: Problem,
    usable: BoolArray,
    needed_m: FloatArray,
    *,
    stop: Stop,
    on_progress: OnProgress,
    seed: int,
    search_s: float,
    start: Routes = (),
) -> Found:
    """The best plan of the search; usable (u, v) says which UAV can fly which visit at all, needed_m (u, v) with what range.

    start: a plan to begin with.
    """
    on_progress(Progress(0.0, Reason("looking_for_first_plan")))

    def on_look(share: float, found: Found) -> None:
        on_progress(Progress(min(share, 0.99), progress_message(problem, found.routes), found.routes, found.bound))

    found = best_found(problem, usable, needed_m, seed=seed, search_s=search_s, stop=stop, on_look=on_look, start=start)
    on_progress(Progress(1.0, progress_message(problem, found.routes), found.routes, found.bound))
    return found


def _expanded(reported: Progress, expanded: Callable[[Routes], Routes]) -> Progress:
    return (
        reported
        if reported.best_routes is None
        else Progress(reported.share, reported.message, expanded(reported.best_routes), reported.bound)
    )


def _solution(rows: Problem, routes: Routes, left_out: tuple[Unassigned, ...], bound: float | None, method: str) -> Solution:
    """Of a problem with a row for each sortie."""
    lengths_m = _lengths_m(rows, routes)
    durations_s = rows.durations_s(routes)
    value = rows.value(routes)
    least = value if bound is None else min(value, bound)
    sorties = by_uav(rows, routes)
    return Solution(
        joined(sorties),
        left_out,
        total_m=sum(lengths_m),
        longest_m=max(lengths_m, default=0.0),
        longest_s=max(durations_s, default=0.0),
        lower_bound=least,
        gap=(value - least) / value if value else 0.0,
        is_proven=value - least <= PROVEN_GAP * value,
        method=method,
        sorties=sorties,
        total_s=sum(durations_s),
        total_wh=rows.total_wh(routes),
    )


def _lengths_m(rows: Problem, routes: Routes) -> list[float]:
    """Metres of each UAV."""
    lengths_m = [rows.route_length_m(uav, route) for uav, route in enumerate(routes)]
    if not rows.owner:
        return lengths_m
    return [sum(lengths_m[row] for row, owner in enumerate(rows.owner) if owner == uav) for uav in dict.fromkeys(rows.owner)]


def progress_message(problem: Problem, routes: Routes) -> Reason:
    missed = problem.target_count - sum(len(route) for route in routes)
    found = _value_reason(problem, routes)
    return Reason("some_not_reached", {"found": found, "missed": missed}) if missed else found


def _value_reason(problem: Problem, routes: Routes) -> Reason:
    lengths_m = _lengths_m(problem, routes)
    if problem.objective is Objective.MAKESPAN:
        return Reason("longest_route", {"length_km": round(max(lengths_m, default=0.0) / 1_000, 1)})
    if problem.objective is Objective.TIME:
        return Reason("minutes_in_total", {"duration_min": round(problem.value(routes) / 60, 1)})
    if problem.objective is Objective.ENERGY:
        return Reason("energy_in_total", {"energy_wh": round(problem.value(routes))})
    return Reason("length_in_total", {"length_km": round(sum(lengths_m) / 1_000, 1)})
