"""Proof that a plan is the best there is, or a better bound and perhaps a better plan, in up to a minute of one processor.

Up to 20 targets the tables of `exact` do it. Where these would be too large, or limits of range and battery leave them open, OR-tools'
CP-SAT begins with the plan: it proves least totals of 40 targets in seconds. Its bounds of the longest route are weak; there the best
plans for some 16 of the targets give better ones.

This is the only module that imports OR-tools, which takes 60 MB: programs that prove nothing do not import it.
"""

import itertools
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from itertools import pairwise
from threading import Event, Timer
from typing import TypeVar

import numpy as np
from ortools.sat.python import cp_model

from planning.problem import FloatArray, Problem, Routes, merit
from planning.solver import exact
from planning.solver.cost_matrices import NO_LIMIT, NO_PATH_M
from planning.solver.lower_bounds import Subsets, lower_bound
from planning.solver.problem_arrays import Arcs
from planning.solver.solver import EXACT, MAX_PROVEN_TARGETS, BoundedPlan, Proof, Stop

CP_SAT = "CP-SAT"  # what Solution.method says
TABLE_TARGETS = 20
LIMITED_TABLE_TARGETS = 15  # where range or battery limit tours beside the objective, or UAVs fly several times
MAX_TABLE_STEPS = 1e10  # pairs of a set and a part of it, some 30 s
MAX_TABLE_BYTES = 500_000_000
SUBSET_STEPS = 3e8  # as many pairs for the best plan of a few targets, half a second
LIMIT_SCALE = 10_000_000  # a range or a battery in CP-SAT's whole numbers
SCALE = 1_000  # whole numbers of CP-SAT are millimetres, milliseconds and thousandths of a Wh
POLL_S = 0.1
CP_SAT_SHARE = 0.5  # of the time for CP-SAT, where subsets follow

OnLook = Callable[[float, Routes, float], None]
_Found = TypeVar("_Found")


def prove(found: BoundedPlan, *, time_s: float, stop: Stop, on_look: OnLook, seed: int) -> Proof | None:
    """Return the better of the plan and those found, with the best bound; None where nothing can be said.

    stop is asked ten times a second, and on_look told the share of the time, the best plan and the bound. A plan that CP-SAT proves is the
    best to a millimetre, a millisecond or a thousandth of a Wh for each leg.
    """
    arcs = Arcs.of(found.problem)
    if not found.usable.any() or found.problem.target_count > MAX_PROVEN_TARGETS:
        return None
    pool = ThreadPoolExecutor(1, "proof")
    try:
        if found.problem.target_count > exact.MAX_TARGETS and _has_table(arcs):  # smaller ones have been tried
            tables = _result(pool.submit(exact.proven_routes, arcs), stop, lambda: on_look(0.0, found.routes, found.bound))
            if tables is None:
                return None
            routes, is_proven = tables
            if is_proven:
                return Proof(routes, None, EXACT)
            found = replace(found, routes=min(found.routes, routes, key=lambda one: merit(found.problem, one)))
        subsets_s = time_s * (1.0 - CP_SAT_SHARE) if arcs.is_makespan else 0.0
        look = _with_share(on_look, time_s)
        cp_sat = _CpSatModel(found, arcs, seed)
        proof = cp_sat.proof(pool, time_s - subsets_s, stop, look)
    finally:
        pool.shutdown(wait=False)  # abandoned tables end in half a minute at most
    if proof.bound is None:
        return proof
    best, bound = replace(found, routes=proof.routes, bound=proof.bound), proof.bound
    if subsets_s and not stop():
        bound = max(bound, _bound_by_subsets(best, arcs, subsets_s, stop, look, seed))
    if not cp_sat.leaves_out_least:  # a plan that leaves out less may be the best
        bound = min(bound, found.problem.value(proof.routes) * (1.0 - 1e-6))
    return replace(proof, bound=bound)


def _with_share(on_look: OnLook, time_s: float) -> Callable[[Routes, float], None]:
    """Return what is to be called every POLL_S; it counts the share of the time."""
    looks = itertools.count(1)
    return lambda routes, bound: on_look(min(1.0, next(looks) * POLL_S / time_s) if time_s else 1.0, routes, bound)


def _bound_by_subsets(found: BoundedPlan, arcs: Arcs, time_s: float, stop: Stop, look: Callable[[Routes, float], None], seed: int) -> float:
    is_over = Event()
    timer = Timer(time_s, is_over.set)
    timer.start()
    subsets = Subsets(_subset_targets(arcs), trials=1_000_000, stop=is_over.is_set)
    with ThreadPoolExecutor(1, "subsets") as pool:
        work = pool.submit(lower_bound, found.problem, found.usable, found.needed_m, found.routes, seed=seed, subsets=subsets)
        while wait([work], timeout=POLL_S).not_done:
            look(found.routes, found.bound)
            if stop():
                is_over.set()
    timer.cancel()
    return work.result()


def _has_table(arcs: Arcs) -> bool:
    """Whether the tables over all sets of targets are small enough."""
    targets, rows = len(arcs.weight), len(arcs.first_m)
    is_limited = arcs.has_sorties or bool(len(arcs.burden))
    if targets > (LIMITED_TABLE_TARGETS if is_limited else TABLE_TARGETS):
        return False
    sets = 1 << targets
    tours_bytes = (rows if is_limited else 1) * 8 * len(arcs.target) * sets
    return pow(3, targets) * max(1, rows - 2) <= MAX_TABLE_STEPS and tours_bytes + 4 * rows * 8 * sets <= MAX_TABLE_BYTES


def _subset_targets(arcs: Arcs) -> int:
    """Return for how many targets a best plan takes about half a second."""
    most = LIMITED_TABLE_TARGETS if arcs.has_sorties else TABLE_TARGETS
    rows = len(arcs.first_m)
    return max(targets for targets in range(4, most + 1) if targets == 4 or 3**targets * rows <= SUBSET_STEPS)


def _result(work: Future[_Found], stop: Stop, look: Callable[[], None]) -> _Found | None:
    """Return what the work gives; None once it is stopped, though it goes on."""
    while wait([work], timeout=POLL_S).not_done:
        look()
        if stop():
            return None
    return work.result()


@dataclass(frozen=True)
class _Arc:
    """An arc of a row: nodes are 0 for its start and end, and visits from 1."""

    begin: int
    end: int
    literal: cp_model.IntVar


class _CpSatModel:
    """The problem as CP-SAT reads it: a circuit for each row of the plan through the visits that it flies."""

    def __init__(self, found: BoundedPlan, arcs: Arcs, seed: int) -> None:
        self._problem, self._arcs, self._usable, self._seed = found.problem, arcs, found.usable, seed
        self.leaves_out_least = True  # no plan leaves out less than the best one so far
        self._routes, self._bound = _sorted_rows(found.problem, arcs, found.routes), found.bound
        self._model = cp_model.CpModel()
        self._rows: list[list[_Arc]] = []
        self._is_idle: list[cp_model.IntVar] = []
        self._flown: dict[int, list[cp_model.LiteralT]] = {}  # by target
        self._values: list[cp_model.LinearExprT] = []
        self._left_out: list[tuple[cp_model.IntVar, int]] = []  # whether a target is, where not all can be visited
        for row in range(len(arcs.first_m)):
            self._add_row(row)
        self._add_most_targets()
        self._missing = self._add_targets()
        self._value = self._add_value()

    def proof(self, pool: ThreadPoolExecutor, time_s: float, stop: Stop, look: Callable[[Routes, float], None]) -> Proof:
        """Return the proof after so many seconds at most."""
        if self._missing is not None:  # first as few targets left out as possible
            time_s /= 2.0
            self._model.minimize(self._missing)
            status, least = self._solve(pool, time_s, stop, lambda bound: look(self._routes, self._bound))
            missed = merit(self._problem, self._routes)[0]
            self.leaves_out_least = status == cp_model.OPTIMAL and least is not None and round(least) >= round(missed)
            self._model.add(self._missing <= round(missed))
            if least is None or stop():
                return Proof(self._routes, self._bound, CP_SAT)
        self._model.minimize(self._value)
        status, least = self._solve(pool, time_s, stop, lambda bound: look(self._routes, max(self._bound, bound / SCALE - self._slack)))
        value, slack = self._problem.value(self._routes), self._slack
        if least is None:
            return Proof(self._routes, self._bound, CP_SAT)
        if status == cp_model.OPTIMAL and self.leaves_out_least and value <= least / SCALE + slack:
            return Proof(self._routes, None, CP_SAT)
        return Proof(self._routes, max(self._bound, least / SCALE - slack), CP_SAT)

    @property
    def _slack(self) -> float:
        """What the rounding of all legs of a plan can amount to, in the objective's unit."""
        return (len(self._arcs.weight) + 2 * len(self._rows)) / SCALE

    def _solve(self, pool: ThreadPoolExecutor, time_s: float, stop: Stop, look: Callable[[float], None]) -> tuple[int, float | None]:
        """Return CP-SAT's status and bound; None without a bound. Better plans replace the one it begins with; look is told the bound."""
        solver = cp_model.CpSolver()
        parameters = solver.parameters
        parameters.max_time_in_seconds = time_s
        parameters.num_workers = 1
        parameters.linearization_level = 2  # with the cuts of circuits: a total of 20 targets is proven in 0.1 instead of 5.5 s
        parameters.random_seed = self._seed
        self._hint()
        bounds = [0.0]
        solver.best_bound_callback = bounds.append
        work = pool.submit(solver.solve, self._model, _SolutionCallback(lambda value_of: self._take(self._read(value_of))))
        while wait([work], timeout=POLL_S).not_done:
            look(bounds[-1])
            if stop():
                solver.stop_search()
        status = work.result()
        return int(status), solver.best_objective_bound if status in (cp_model.OPTIMAL, cp_model.FEASIBLE) else None

    def _take(self, routes: Routes) -> None:
        """Keep the plan if it is better: its limits are checked again, those of the model are rounded."""
        problem = self._problem
        if _keeps_limits(problem, self._arcs, routes) and merit(problem, routes) < merit(problem, self._routes):
            self._routes = routes

    # --- the model ---------------------------------------------------------------------------------------------------------------

    def _add_row(self, row: int) -> None:
        arcs, model = self._arcs, self._model
        onward_m = arcs.onward_m[arcs.class_of[row]]
        visits = np.flatnonzero(self._usable[row]).tolist()
        is_idle = model.new_bool_var("")
        own = [_Arc(0, 0, is_idle)]
        for visit in visits:
            if arcs.first_m[row, visit] < NO_PATH_M:
                own.append(_Arc(0, visit + 1, model.new_bool_var("")))
            if arcs.end_m[row, visit] < NO_PATH_M:
                own.append(_Arc(visit + 1, 0, model.new_bool_var("")))
            left_out = model.new_bool_var("")
            own.append(_Arc(visit + 1, visit + 1, left_out))
            model.add_implication(is_idle, left_out)  # else visits could be a circuit without the start
            self._flown.setdefault(int(arcs.target[visit]), []).append(left_out.Not())
            for other in visits:
                if arcs.target[other] != arcs.target[visit] and onward_m[visit, other] < NO_PATH_M:
                    own.append(_Arc(visit + 1, other + 1, model.new_bool_var("")))
        model.add_circuit([(arc.begin, arc.end, arc.literal) for arc in own])
        self._rows.append(own)
        self._is_idle.append(is_idle)
        if row and arcs.owner[row] == arcs.owner[row - 1]:  # a later flight, only after an earlier one
            model.add_implication(self._is_idle[row - 1], is_idle)
        self._add_limits(row)
        self._values.append(self._value_of_row(row))

    def _add_limits(self, row: int) -> None:
        """Rounded down, so that no plan that keeps the limits is excluded."""
        arcs, of_class = self._arcs, self._arcs.class_of[row]
        limited = [(arcs.first_m[row], arcs.onward_m[of_class], arcs.end_m[row], float(arcs.limit_m[row]))]
        burden = arcs.burden
        limited += [
            (burden.first[at, row], burden.onward[at, of_class], burden.end[at, row], float(burden.limit[at, row]))
            for at in range(len(burden))
        ]
        for first, onward, end, limit in limited:
            if limit < NO_LIMIT:
                scale = LIMIT_SCALE / max(limit, 1.0)
                taken = [(arc.literal, int(_amount(arc, first, onward, end) * scale)) for arc in self._rows[row] if arc.begin != arc.end]
                self._model.add(_sum(taken) <= int(limit * scale) + 1)

    def _add_most_targets(self) -> None:
        """The targets of a UAV are limited over all its flights."""
        arcs = self._arcs
        for rows in _rows_of(arcs).values():
            done = [
                (arc.literal, int(arcs.done[arc.end - 1])) for row in rows for arc in self._rows[row] if arc.end and arc.begin != arc.end
            ]
            if done and sum(count for _, count in done) > arcs.most[rows[0]]:
                self._model.add(_sum(done) <= int(arcs.most[rows[0]]))

    def _value_of_row(self, row: int) -> cp_model.LinearExprT:
        """Return what the objective counts of a row, times SCALE."""
        arcs = self._arcs
        first, onward, end = arcs.first_m[row], arcs.onward_m[arcs.class_of[row]], arcs.end_m[row]
        taken = []
        is_later = row > 0 and arcs.owner[row] == arcs.owner[row - 1]
        ready_s = float(arcs.ready_s[row]) + (float(arcs.turnaround_s[row]) if is_later else 0.0)
        for arc in self._rows[row]:
            if arc.begin == arc.end:
                continue
            amount = _amount(arc, first, onward, end)
            if arcs.is_makespan:
                amount = amount / float(arcs.speed_mps[row]) + (float(arcs.service_s[arc.end - 1]) if arc.end else 0.0)
                amount += 0.0 if arc.begin else ready_s
            taken.append((arc.literal, round(amount * SCALE)))
        return _sum(taken)

    def _add_targets(self) -> cp_model.LinearExprT | None:
        """Each target that can be visited is visited once. Return the weight of those left out; None where the plan leaves none out."""
        flown = {int(self._arcs.target[visit]) for route in self._routes for visit in route}
        if self._flown.keys() <= flown:
            for literals in self._flown.values():
                self._model.add_exactly_one(literals)
            return None
        missing: list[tuple[cp_model.IntVar, int]] = []
        for target, literals in self._flown.items():
            is_missing = self._model.new_bool_var("")
            self._model.add_exactly_one([*literals, is_missing])
            self._left_out.append((is_missing, target))
            missing.append((is_missing, round(float(self._arcs.weight[target]))))
        beyond = sum(round(float(weight)) for target, weight in enumerate(self._arcs.weight) if target not in self._flown)
        return _sum(missing) + beyond

    def _add_value(self) -> cp_model.LinearExprT:
        arcs, model = self._arcs, self._model
        if not arcs.is_makespan:
            return cp_model.LinearExpr.sum(self._values)
        longest = model.new_int_var(int(self._bound * SCALE), round(NO_LIMIT), "")
        of_owner: dict[int, list[cp_model.LinearExprT]] = {}
        for owner, value in zip(arcs.owner.tolist(), self._values, strict=True):
            of_owner.setdefault(owner, []).append(value)
        sums = {owner: cp_model.LinearExpr.sum(values) for owner, values in of_owner.items()}
        for value in sums.values():
            model.add(value <= longest)
        for owner, after in _alike_neighbours(arcs):
            model.add(sums[owner] >= sums[after])
        return longest

    # --- plans in and out --------------------------------------------------------------------------------------------------------

    def _hint(self) -> None:
        """Begin with the best plan so far."""
        self._model.proto.clear_solution_hint()
        done = {int(self._arcs.target[visit]) for route in self._routes for visit in route}
        for is_missing, target in self._left_out:
            self._model.add_hint(is_missing, target not in done)
        for own, route in zip(self._rows, self._routes, strict=True):
            nodes = [0, *(visit + 1 for visit in route), 0]
            flown = set(pairwise(nodes))
            for arc in own:
                is_flown = arc.begin not in nodes[1:-1] if arc.begin == arc.end and arc.begin else (arc.begin, arc.end) in flown
                self._model.add_hint(arc.literal, is_flown)

    def _read(self, value_of: Callable[[cp_model.IntVar], bool]) -> Routes:
        routes = []
        for own in self._rows:
            after = {arc.begin: arc.end for arc in own if arc.begin != arc.end and value_of(arc.literal)}
            route, node = [], after.get(0, 0)
            while node:
                route.append(node - 1)
                node = after[node]
            routes.append(tuple(route))
        return tuple(routes)


class _SolutionCallback(cp_model.CpSolverSolutionCallback):
    """Hands each plan that CP-SAT finds to a function."""

    def __init__(self, on_plan: Callable[[Callable[[cp_model.IntVar], bool]], None]) -> None:
        super().__init__()
        self._on_plan = on_plan

    def on_solution_callback(self) -> None:
        self._on_plan(self.boolean_value)


def _keeps_limits(problem: Problem, arcs: Arcs, routes: Routes) -> bool:
    """Whether each flight keeps its limits, and each UAV that of its targets over all of its flights."""
    done = [sum(int(arcs.done[visit]) for visit in route) for route in routes]
    return all(problem.keeps_limits(row, route) for row, route in enumerate(routes) if route) and all(
        sum(done[row] for row in rows) <= arcs.most[rows[0]] for rows in _rows_of(arcs).values()
    )


def _rows_of(arcs: Arcs) -> dict[int, list[int]]:
    """Return the rows of each UAV."""
    rows_of: dict[int, list[int]] = {}
    for row, owner in enumerate(arcs.owner.tolist()):
        rows_of.setdefault(owner, []).append(row)
    return rows_of


def _amount(arc: _Arc, first: FloatArray, onward: FloatArray, end: FloatArray) -> float:
    if not arc.begin:
        return float(first[arc.end - 1])
    if not arc.end:
        return float(end[arc.begin - 1])
    return float(onward[arc.begin - 1, arc.end - 1])


def _sum(taken: Sequence[tuple[cp_model.IntVar, int]]) -> cp_model.LinearExprT:
    return cp_model.LinearExpr.weighted_sum([literal for literal, _ in taken], [amount for _, amount in taken])


def _alike_neighbours(arcs: Arcs) -> list[tuple[int, int]]:
    """Return pairs of owners whose rows are alike in everything: their routes may be exchanged."""
    alike: dict[tuple[object, ...], int] = {}
    pairs = []
    for owner, rows in _rows_of(arcs).items():
        likeness = tuple(exact.likeness(arcs, row) for row in rows)
        if likeness in alike:
            pairs.append((alike[likeness], owner))
        alike[likeness] = owner
    return pairs


def _sorted_rows(problem: Problem, arcs: Arcs, routes: Routes) -> Routes:
    """Return the routes in the order of the model: those of a UAV without empty ones between, UAVs that are alike by duration."""
    rows_of = _rows_of(arcs)
    flown = {owner: sorted((routes[row] for row in rows), key=lambda route: not route) for owner, rows in rows_of.items()}
    duration_s = dict(zip(rows_of, problem.durations_s(routes), strict=True))
    group_of = {owner: owner for owner in rows_of}
    for owner, after in _alike_neighbours(arcs):
        group_of[after] = group_of[owner]
    for first in set(group_of.values()):
        group = [owner for owner in rows_of if group_of[owner] == first]
        plans = [flown[owner] for owner in sorted(group, key=lambda owner: -duration_s[owner])]
        flown |= dict(zip(group, plans, strict=True))
    return tuple(route for owner in rows_of for route in flown[owner])
