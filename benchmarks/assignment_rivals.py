"""What other searches find on the large plans of `benchmarks.assignment`, kept in a file, so that a run need not repeat them.

    python -m benchmarks.assignment_rivals [--cpu-s 120] [--only w4:total w5:makespan] [--methods PyVRP OR-tools]

A rival has so many seconds of processor time rather than of the clock: other programs may be at work on the machine meanwhile. What the
file holds already with as much time is not repeated.
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np
from ortools.constraint_solver import pywrapcp, routing_enums_pb2
from pyvrp import Model

from benchmarks.assignment_instances import WORKLOADS, instances, with_objective
from missions.routing.problem import Objective, Problem

KEPT = Path(__file__).resolve().parent / "assignment_rivals.json"
UNITS_PER_M = 10  # rivals that count in whole numbers get decimetres
SPAN_WEIGHT = 1_000


def by_ortools(problem: Problem, cpu_s: float) -> float:
    """Guided local search on a registered matrix; for the longest route with a span cost."""
    uavs, targets = len(problem.uavs), problem.target_count
    end = uavs + targets
    arcs = np.zeros((end + 1, end + 1), dtype=np.int64)
    arcs[:uavs, uavs:end] = np.round(problem.from_start_m * UNITS_PER_M)
    arcs[uavs:end, uavs:end] = np.round(problem.between_m * UNITS_PER_M)
    manager = pywrapcp.RoutingIndexManager(end + 1, uavs, list(range(uavs)), [end] * uavs)
    routing = pywrapcp.RoutingModel(manager)
    transit = routing.RegisterTransitMatrix(arcs.tolist())
    routing.SetArcCostEvaluatorOfAllVehicles(transit)
    if problem.objective is Objective.MAKESPAN:
        routing.AddDimension(transit, 0, 10**12, True, "length")
        routing.GetDimensionOrDie("length").SetGlobalSpanCostCoefficient(SPAN_WEIGHT)
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PARALLEL_CHEAPEST_INSERTION
    parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    parameters.time_limit.FromMilliseconds(int(cpu_s * 20_000))  # of the clock, in case the processor is never free
    ends_s = process_time() + cpu_s
    routing.AddSearchMonitor(routing.solver().CustomLimit(lambda: process_time() > ends_s))
    found = routing.SolveWithParameters(parameters)
    if found is None:
        return float("inf")
    lengths_m = []
    for uav in range(uavs):
        index, length = routing.Start(uav), 0
        while not routing.IsEnd(index):
            onward = found.Value(routing.NextVar(index))
            length += int(arcs[manager.IndexToNode(index), manager.IndexToNode(onward)])
            index = onward
        lengths_m.append(length / UNITS_PER_M)
    return sum(lengths_m) if problem.objective is Objective.TOTAL else max(lengths_m)


def by_pyvrp(problem: Problem, cpu_s: float) -> float:
    """Hybrid genetic search of the total."""
    uavs, targets = len(problem.uavs), problem.target_count
    model = Model()
    places = [model.add_location(0, number) for number in range(uavs + targets + 1)]
    starts, clients, end = places[:uavs], places[uavs:-1], places[-1]
    last = model.add_depot(end)
    for start in starts:
        model.add_vehicle_type(1, start_depot=model.add_depot(start), end_depot=last)
        model.add_edge(start, end, 0)
    for client in clients:
        model.add_client(client)
        model.add_edge(client, end, 0)
    for rows, ways_m in ((starts, problem.from_start_m), (clients, problem.between_m)):
        for row, lengths in zip(rows, np.round(ways_m * UNITS_PER_M).astype(int).tolist(), strict=True):
            for client, length in zip(clients, lengths, strict=True):
                if client is not row:
                    model.add_edge(row, client, length)
    ends_s = process_time() + cpu_s
    return float(model.solve(stop=lambda best_cost: process_time() > ends_s, seed=1, display=False).cost()) / UNITS_PER_M


RIVALS: dict[Objective, dict[str, Callable[[Problem, float], float]]] = {
    Objective.TOTAL: {"PyVRP": by_pyvrp, "OR-tools": by_ortools},
    Objective.MAKESPAN: {"OR-tools": by_ortools},
}


def kept(file: Path = KEPT) -> dict[str, dict[str, float]]:
    """Metres and processor seconds by "workload number objective method"."""
    return dict(json.loads(file.read_text())) if file.exists() else {}


def keep(key: str, value_m: float, spent_s: float, file: Path = KEPT) -> None:
    """Put a plan's metres into the file, unless it holds a better plan; the seconds are those of the longest search so far."""
    values = kept(file)
    old = values.get(key, {"value_m": float("inf"), "cpu_s": 0.0})
    values[key] = {"value_m": min(value_m, old["value_m"]), "cpu_s": max(spent_s, old["cpu_s"])}
    file.write_text(json.dumps(values, indent=1, sort_keys=True) + "\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cpu-s", type=float, default=120.0)
    parser.add_argument("--instances", type=int, default=5)
    parser.add_argument("--nodes", type=int, default=200_000)
    every = [f"{name}:{objective}" for name in WORKLOADS for objective in Objective]
    parser.add_argument("--only", nargs="+", choices=every, default=every)
    parser.add_argument("--methods", nargs="+", choices=["PyVRP", "OR-tools"], default=["PyVRP", "OR-tools"])
    parser.add_argument("--rivals", type=Path, default=KEPT, help="the file that keeps what they find")
    options = parser.parse_args()
    for row in options.only:
        name, objective = row.split(":")
        for number, problem in enumerate(instances(name, options.instances, options.nodes)):
            for method, plan in RIVALS[Objective(objective)].items():
                key = f"{name} {number} {objective} {method}"
                if method not in options.methods or kept(options.rivals).get(key, {}).get("cpu_s", 0.0) >= options.cpu_s:
                    continue
                value_m = plan(with_objective(problem, Objective(objective)), options.cpu_s)
                keep(key, value_m, options.cpu_s, options.rivals)
                print(key, f"{value_m / 1_000:,.2f} km", flush=True)


if __name__ == "__main__":
    main()
