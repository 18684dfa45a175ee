"""OR-tools on the same problems as our own search: registered matrices of whole numbers that never promise too much."""

import math
from time import process_time

import numpy as np
from ortools.constraint_solver import pywrapcp, routing_enums_pb2

from planning.problem import BoolArray, FloatArray, Problem, Routes
from planning.solver.cost_matrices import NO_PATH_M
from planning.solver.problem_arrays import Arcs

UNITS_PER_M = 10
UNITS_PER_S = 100
NO_WAY = 10**11  # in units; what cannot be flown
MAX_UNITS = NO_WAY - 1  # of a route without a limit
LEFT_OUT = 10**12  # what the lightest target costs, if it is left out
MAX_LEFT_OUT = 10**15
SPAN_WEIGHT = 1_000  # what the longest route weighs beside the metres
LOOK_AFTER = 1_000  # calls of the limit, of which there are some hundred thousand in a second


class _Limit:
    """Tells when so many seconds of the processor are over: other programs may be at work meanwhile."""

    def __init__(self, cpu_s: float) -> None:
        self.ends_s, self.calls, self.is_over = process_time() + cpu_s, 0, False

    def __call__(self) -> bool:
        self.calls += 1
        if self.calls % LOOK_AFTER == 0 and process_time() > self.ends_s:
            self.is_over = True
        return self.is_over


def routes_by_ortools(problem: Problem, usable: BoolArray, cpu_s: float) -> Routes | None:
    """The best plan of a guided local search from parallel insertion; none if nothing was found in the time.

    Usable (u, v) says which UAV can fly which visit at all. Arcs are rounded up and limits down: what keeps these keeps the true ones.
    While it solves, OR-tools lets other threads run Python only when it asks its limit.
    """
    arcs = Arcs.of(problem)
    uavs, visits = usable.shape
    ends = list(range(uavs + visits, 2 * uavs + visits))
    manager = pywrapcp.RoutingIndexManager(2 * uavs + visits, uavs, list(range(uavs)), ends)
    routing = pywrapcp.RoutingModel(manager)
    metres = _square(arcs)
    lengths = routing.RegisterTransitMatrix(_units(metres, UNITS_PER_M))
    routing.SetArcCostEvaluatorOfAllVehicles(lengths)
    if (arcs.limit_m < NO_PATH_M / 2).any() or (metres >= NO_PATH_M).any():
        limits = [min(MAX_UNITS, math.floor(limit_m * UNITS_PER_M)) for limit_m in arcs.limit_m.tolist()]
        routing.AddDimensionWithVehicleTransitAndCapacity([lengths] * uavs, 0, limits, True, "length")
    if (arcs.most < problem.target_count).any():
        done = [0] * uavs + arcs.done.tolist() + [0] * uavs
        evaluator = routing.RegisterUnaryTransitVector(done)
        routing.AddDimensionWithVehicleCapacity(evaluator, 0, arcs.most.tolist(), True, "done")
    if arcs.is_makespan:
        kinds = list(zip(arcs.speed_mps.tolist(), arcs.ready_s.tolist(), strict=True))
        durations = {kind: routing.RegisterTransitMatrix(_units(_seconds(metres, arcs, *kind), UNITS_PER_S)) for kind in set(kinds)}
        by_uav = [durations[kind] for kind in kinds]
        routing.AddDimensionWithVehicleTransits(by_uav, 0, MAX_UNITS, True, "time")
        routing.GetDimensionOrDie("time").SetGlobalSpanCostCoefficient(SPAN_WEIGHT)
    lightest = float(arcs.weight.min())
    for target, of_target in enumerate(problem.visits_of_target()):
        able = [visit for visit in of_target if usable[:, visit].any()]
        for visit in set(of_target) - set(able):
            routing.VehicleVar(manager.NodeToIndex(uavs + visit)).SetValue(-1)
        places = [manager.NodeToIndex(uavs + visit) for visit in of_target]
        routing.AddDisjunction(places, min(MAX_LEFT_OUT, int(LEFT_OUT * float(arcs.weight[target]) / lightest)))
        for visit in able:
            if not usable[:, visit].all():
                allowed = [-1, *np.flatnonzero(usable[:, visit]).tolist()]
                routing.VehicleVar(manager.NodeToIndex(uavs + visit)).SetValues(allowed)
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PARALLEL_CHEAPEST_INSERTION
    parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    parameters.time_limit.FromMilliseconds(int(cpu_s * 20_000) + 1)  # of the clock, in case the processor is never free
    routing.AddSearchMonitor(routing.solver().CustomLimit(_Limit(cpu_s)))
    found = routing.SolveWithParameters(parameters)
    return None if found is None else _routes(manager, routing, found, uavs)


def _routes(manager: pywrapcp.RoutingIndexManager, routing: pywrapcp.RoutingModel, found: pywrapcp.Assignment, uavs: int) -> Routes:
    routes = []
    for uav in range(uavs):
        route, index = [], found.Value(routing.NextVar(routing.Start(uav)))
        while not routing.IsEnd(index):
            route.append(manager.IndexToNode(index) - uavs)
            index = found.Value(routing.NextVar(index))
        routes.append(tuple(route))
    return tuple(routes)


def _square(arcs: Arcs) -> FloatArray:
    """Metres between starts, visits and ends; 0 from a start straight to an end."""
    uavs, visits = arcs.first_m.shape
    metres = np.zeros((2 * uavs + visits, 2 * uavs + visits))
    metres[:uavs, uavs : uavs + visits] = arcs.first_m
    metres[uavs : uavs + visits, uavs : uavs + visits] = arcs.onward_m[0]
    metres[uavs : uavs + visits, uavs + visits :] = arcs.end_m.T
    np.fill_diagonal(metres, 0.0)
    return metres


def _seconds(metres: FloatArray, arcs: Arcs, speed_mps: float, ready_s: float) -> FloatArray:
    uavs, visits = arcs.first_m.shape
    seconds = metres / speed_mps
    seconds[:, uavs : uavs + visits] += arcs.service_s
    seconds[:uavs, uavs : uavs + visits] += ready_s  # of routes with a visit alone
    seconds[metres >= NO_PATH_M] = NO_PATH_M
    return seconds


def _units(values: FloatArray, per_unit: int) -> list[list[int]]:
    return [[int(value) for value in row] for row in np.where(values >= NO_PATH_M, NO_WAY, np.ceil(values * per_unit)).tolist()]
