"""What other searches find on the large plans of `benchmarks.planning.assignment`, kept in a file, so that a run need not repeat them.

    python -m benchmarks.planning.assignment_rivals [--cpu-s 120] [--only w4:total w5:makespan] [--methods PyVRP OR-tools]

A rival has so many seconds of processor time rather than of the clock: other programs may be at work on the machine meanwhile. What the
file holds already with as much time is not repeated.
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np
from pyvrp import Model

from benchmarks.planning.assignment_instances import WORKLOADS, instances, with_objective
from benchmarks.planning.ortools_plans import routes_by_ortools
from planning.problem import Objective, Problem, merit
from planning.solver.reach import needed_range_m, reachable

KEPT = Path(__file__).resolve().parent / "assignment_rivals.json"
UNITS_PER_M = 10  # rivals that count in whole numbers get decimetres


def by_ortools(problem: Problem, cpu_s: float) -> float:
    routes = routes_by_ortools(problem, reachable(problem, needed_range_m(problem)), cpu_s)
    if routes is None:
        return float("inf")
    missed, value, _ = merit(problem, routes)
    return value if missed == 0 else float("inf")


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
    every = [f"{name}:{objective}" for name in WORKLOADS for objective in RIVALS]
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
