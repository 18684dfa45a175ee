"""The large plans of `benchmarks.planning.assignment`: missions on the graph of make_graph.py, with the metres between them."""

from pathlib import Path

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from benchmarks.network.make_graph import haversine, make, missions
from planning.problem import Objective, Problem, UavStart, Visit

KEPT = Path(__file__).resolve().parents[2] / "var" / "bench"
WORKLOADS = {"w4": (10, 100), "w5": (20, 500)}


def instances(name: str, count: int, nodes: int) -> list[Problem]:
    """Problems of the total; metres between all places by scipy, kept in var/bench."""
    uavs, targets = WORKLOADS[name]
    files = [KEPT / f"{name}_{nodes}_{number}.npz" for number in range(count)]
    if not all(file.exists() for file in files):
        KEPT.mkdir(parents=True, exist_ok=True)
        graph = make(nodes, seed=1, polygons=500)
        for file, mission in zip(files, missions(graph, uavs, targets, count, seed=11), strict=True):
            np.savez(file, **_ways(graph, mission))
    problems = []
    for file in files:
        ways = np.load(file)
        problems.append(
            Problem(
                uavs=(UavStart(),) * uavs,
                visits=tuple(Visit(target) for target in range(targets)),
                target_count=targets,
                from_start_m=ways["from_start_m"],
                between_m=ways["between_m"],
                to_start_m=ways["to_start_m"],
                objective=Objective.TOTAL,
            )
        )
    return problems


def _ways(graph: dict[str, np.ndarray], mission: dict[str, list]) -> dict[str, np.ndarray]:
    nodes, uavs = len(graph["lat"]), len(mission["uavs"])
    network = csr_matrix((graph["w"], (graph["u"], graph["v"])), shape=(nodes, nodes))
    tree = cKDTree(_on_sphere(graph["lat"], graph["lon"]))
    lat, lon = np.array(mission["uavs"]).T
    _, near = tree.query(_on_sphere(lat, lon))
    leg_m = haversine(lat, lon, graph["lat"][near], graph["lon"][near])
    places = np.r_[near, mission["targets"]]
    ways_m = dijkstra(network, directed=False, indices=places)[:, places]
    ways_m[:uavs] += leg_m[:, None]
    ways_m[:, :uavs] += leg_m[None]
    return {"from_start_m": ways_m[:uavs, uavs:], "between_m": ways_m[uavs:, uavs:], "to_start_m": ways_m[uavs:, :uavs]}


def _on_sphere(lat: np.ndarray, lon: np.ndarray) -> np.ndarray:
    lat, lon = np.radians(lat), np.radians(lon)
    return np.c_[np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]


def with_objective(problem: Problem, objective: Objective) -> Problem:
    return Problem(
        problem.uavs, problem.visits, problem.target_count, problem.from_start_m, problem.between_m, problem.to_start_m, objective
    )
