"""The search for plans of many targets: several chains side by side, the best plan kept."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from threading import Event, Timer

import numpy as np

from operation.reasons import Reason
from planning.problem import BoolArray, FloatArray, Problem, Routes, merit
from planning.solver.lower_bounds import lower_bound
from planning.solver.plan_state import Workspace, routes_of, values, workspace
from planning.solver.problem_arrays import Arcs, ProblemArrays, problem_arrays_of
from planning.solver.ruin_and_recreate import anneal, begin_at, construct

Stop = Callable[[], bool]
CHAINS = 2
CONSTRUCTIONS = 6
LOOK_INTERVAL_S = 0.1
TARGET_ROUNDS_PER_STEP = 40_000  # rounds times targets, some tens of milliseconds
FIXED_STEPS = 40  # of each chain in a search without a time, a second or less in all
MAX_ROUNDS_PER_STEP = 600
# Temperatures at the beginning and the end, in mean arcs of the plan, of one chain and the next. Measured by
# `benchmarks.planning.assignment`.
TOTAL_TEMPERATURES = ((4.0, 0.05), (1.5, 0.05))
MAKESPAN_TEMPERATURES = ((1.0, 0.003), (0.4, 0.003))
POWERS = (3, 3, 4, 5, 6)  # of 2, one after another: the longest route comes to count more and more


@dataclass(frozen=True)
class Progress:
    """How far a search is. `best_routes` are the best so far, visits by UAV; `bound` is in the unit of the problem's objective."""

    share: float
    message: Reason
    best_routes: Routes | None = None
    bound: float | None = None


OnProgress = Callable[[Progress], None]


@dataclass(eq=False)
class Chain:
    """One annealing and where it stands."""

    arrays: ProblemArrays
    work: Workspace
    warm: float
    cold: float
    routes: Routes  # the best so far; replaced as a whole, so that other threads may read it

    @classmethod
    def begin(cls, arrays: ProblemArrays, seed: int, number: int, start: Routes) -> "Chain":
        """start: a plan to go on from, if it is better than those that are constructed."""
        work = workspace(len(arrays.first_m), len(arrays.weight), seed + number, len(arrays.more_limit))
        construct(arrays, work, POWERS[0], CONSTRUCTIONS)
        visit, size = np.zeros_like(work.plan.visit), np.zeros_like(work.plan.size)
        for uav, route in enumerate(start):
            visit[uav, : len(route)], size[uav] = route, len(route)
        begin_at(arrays, work, visit, size)
        _, total_m, longest_s = values(arrays, work.best)
        flown = max(1, int(work.best.size.sum()))
        unit = longest_s * np.count_nonzero(work.best.size) / flown if arrays.is_makespan else total_m / flown
        temperatures = MAKESPAN_TEMPERATURES if arrays.is_makespan else TOTAL_TEMPERATURES
        warm, cold = temperatures[number % len(temperatures)]
        return cls(arrays, work, max(1e-6, float(unit) * warm), max(1e-8, float(unit) * cold), routes_of(work.best))

    def step(self, share: float, step: float, rounds: int) -> None:
        """So many rounds, while the search goes from a share of its time to share + step."""
        power = POWERS[min(len(POWERS) - 1, int(share * len(POWERS)))]
        now, later = (self.warm * (self.cold / self.warm) ** min(1.0, at) for at in (share, share + step))
        anneal(self.arrays, self.work, rounds, now, later, power)
        self.routes = routes_of(self.work.best)


@dataclass(frozen=True)
class Found:
    """The best plan, and a bound in the objective's unit: none while it is being worked out."""

    routes: Routes
    bound: float | None


def best_found(
    problem: Problem,
    usable: BoolArray,
    needed_m: FloatArray,
    *,
    seed: int,
    search_s: float,
    stop: Stop,
    on_look: Callable[[float, Found], None],
    start: Routes = (),
    is_bounded: bool = True,
) -> Found:
    """The best plan of all chains, and a bound that is worked out beside them unless it is not `is_bounded`.

    The plan is no worse than `start`, if that keeps all limits.

    Without a time to search each chain makes a fixed number of rounds, and the answer depends on the problem and the seed alone; with
    one they go on until it is over. `stop` is asked and `on_look` told the share of the search ten times a second.
    """
    arrays = problem_arrays_of(problem, Arcs.of(problem), usable)
    rounds = max(1, min(MAX_ROUNDS_PER_STEP, TARGET_ROUNDS_PER_STEP // problem.target_count))
    share, is_over = _Share(), Event()

    def fly(chain: Chain) -> None:
        if search_s:
            chain.step(share.now, 0.0, rounds)  # once at least, however long this thread had to wait for a processor
            while not is_over.is_set():
                chain.step(share.now, 0.0, rounds)
            return
        for step in range(FIXED_STEPS):
            if is_over.is_set():
                return
            chain.step(step / FIXED_STEPS, 1 / FIXED_STEPS, rounds)
            share.now = max(share.now, (step + 1) / FIXED_STEPS)

    timer = Timer(search_s, is_over.set)
    timer.daemon = True
    if search_s:
        timer.start()
    with ThreadPoolExecutor(CHAINS + 1, "search") as pool:
        chains = list(pool.map(lambda number: Chain.begin(arrays, seed, number, start if number == 0 else ()), range(CHAINS)))
        first = _best(problem, chains)
        bounding = pool.submit(lower_bound, problem, usable, needed_m, first, seed=seed) if is_bounded else None
        flights = [pool.submit(fly, chain) for chain in chains]
        try:
            looks = 0
            while wait(flights, timeout=LOOK_INTERVAL_S).not_done:
                looks += 1
                if search_s:
                    share.now = min(1.0, looks * LOOK_INTERVAL_S / search_s)
                if stop():
                    is_over.set()
                on_look(share.now, Found(_best(problem, chains), bounding.result() if bounding and bounding.done() else None))
        finally:
            is_over.set()
            timer.cancel()
        for flight in flights:
            flight.result()
        best = _best(problem, chains)
        bound = None if bounding is None else bounding.result()
    if bound is not None and merit(problem, best)[0] < merit(problem, first)[0]:  # more is certain to be visited
        bound = max(bound, lower_bound(problem, usable, needed_m, best, seed=seed))
    return Found(best, bound)


@dataclass
class _Share:
    """How much of the search is over, told from one thread to another."""

    now: float = 0.0


def _best(problem: Problem, chains: Sequence[Chain]) -> Routes:
    return min((chain.routes for chain in chains), key=lambda routes: (merit(problem, routes), routes))
