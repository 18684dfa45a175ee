"""Plans on a graph of a file: proven against brute force on small ones, walks on real edges, and files with faults."""

import io
import json
from itertools import chain, count, pairwise, permutations, product

import networkx as nx
import numpy as np
import pytest

from planning.file_plans import EARTH_RADIUS_M, InvalidFile, plan_json, read_graph
from planning.problem import Objective


def graph_file(**changes: object) -> io.BytesIO:
    """A ring of twelve nodes with a tail and an island of two: 0 to 11, 12 and 13, 14 and 15."""
    random = np.random.default_rng(3)
    angle = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    lat = np.concatenate([55.0 + 0.05 * np.sin(angle), [55.06, 55.08], [56.0, 56.01]])
    lon = np.concatenate([10.0 + 0.08 * np.cos(angle), [10.0, 10.01], [12.0, 12.0]])
    pairs = [(node, (node + 1) % 12) for node in range(12)] + [(3, 12), (12, 13), (14, 15), (2, 7)]
    u, v = np.array(pairs, dtype=np.int32).T
    arrays = {"lat": lat, "lon": lon, "u": u, "v": v, "w": random.uniform(2_000.0, 9_000.0, len(pairs)), "kind": np.zeros(16, np.uint8)}
    stream = io.BytesIO()
    np.savez(stream, **(arrays | changes))
    stream.seek(0)
    return stream


def network() -> nx.Graph:
    stored = np.load(graph_file())
    made = nx.Graph()
    made.add_weighted_edges_from(zip(stored["u"].tolist(), stored["v"].tolist(), stored["w"].tolist(), strict=True))
    return made


def planned(mission: dict[str, object], objective: Objective = Objective.TOTAL) -> dict[str, object]:
    ticks = count()
    return json.loads(plan_json(read_graph(graph_file()), mission, objective, lambda: next(ticks) / 1_000))


def leg_m(place: list[float], node: int) -> float:
    stored = np.load(graph_file())
    (lat, lon), (lat_2, lon_2) = np.radians(place), np.radians([stored["lat"][node], stored["lon"][node]])
    half = np.sin((lat_2 - lat) / 2) ** 2 + np.cos(lat) * np.cos(lat_2) * np.sin((lon_2 - lon) / 2) ** 2
    return float(2 * EARTH_RADIUS_M * np.arcsin(np.sqrt(half)))


@pytest.mark.parametrize("objective", [Objective.TOTAL, Objective.MAKESPAN])
def test_a_plan_is_the_best_and_its_waypoints_walk_along_edges(objective):
    uavs, targets = [[55.049, 10.001], [54.951, 9.999]], [0, 13, 5, 10]
    starts = [3, 9]
    plan = planned({"uavs": uavs, "targets": targets}, objective)
    made = network()
    apart_m = dict(nx.all_pairs_dijkstra_path_length(made))

    def route_m(uav: int, route: tuple[int, ...]) -> float:
        nodes = [starts[uav], *(targets[target] for target in route)]
        return leg_m(uavs[uav], starts[uav]) + sum(apart_m[a][b] for a, b in pairwise(nodes)) if route else 0.0

    best = min(
        (sum(lengths), max(lengths)) if objective is Objective.TOTAL else (max(lengths), sum(lengths))
        for owners in product(range(2), repeat=4)
        for lengths in [[min(route_m(uav, way) for way in permutations(t for t in range(4) if owners[t] == uav)) for uav in range(2)]]
    )
    found = (plan["cost_m"], plan["makespan_m"])
    assert (found if objective is Objective.TOTAL else found[::-1]) == pytest.approx(best, abs=1e-6)

    assert sorted(chain.from_iterable(plan["routes"])) == [0, 1, 2, 3]
    for uav, (route, nodes) in enumerate(zip(plan["routes"], plan["waypoints"], strict=True)):
        if route:
            assert nodes[0] == starts[uav]
            assert nodes[-1] == targets[route[-1]]
            flown_m = leg_m(uavs[uav], starts[uav]) + nx.path_weight(made, nodes, "weight")
            assert flown_m == pytest.approx(route_m(uav, tuple(route)), abs=1e-6)
    assert plan["ms"] == {"nearest": 1.0, "matrix": 1.0, "assign": 1.0, "expand": 1.0, "total": 4.0}


def test_a_target_on_an_island_is_on_no_route():
    plan = planned({"uavs": [[55.049, 10.001]], "targets": [14, 12]})
    assert plan["routes"] == [[1]]
    assert plan["waypoints"] == [[3, 12]]


def test_a_target_where_the_uav_stands_is_reached_at_once():
    plan = planned({"uavs": [[55.06, 10.0], [56.0, 12.0]], "targets": [12, 12]})
    assert plan["routes"] in ([[0, 1], []], [[1, 0], []])
    assert plan["waypoints"] == [[12], []]
    assert plan["cost_m"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.long
def test_more_targets_than_can_be_proven_are_all_visited():
    plan = planned({"uavs": [[55.049, 10.001]], "targets": list(range(14))})
    assert sorted(plan["routes"][0]) == list(range(14))


@pytest.mark.parametrize("mission", [{"uavs": [], "targets": [1]}, {"uavs": [[55.0, 10.0]], "targets": []}])
def test_without_uavs_or_targets_nobody_flies(mission):
    plan = planned(mission)
    assert (plan["cost_m"], plan["makespan_m"]) == (0.0, 0.0)
    assert plan["routes"] == plan["waypoints"] == [[]] * len(mission["uavs"])


@pytest.mark.parametrize(
    "changes",
    [
        {"lat": np.zeros(3)},
        {"u": np.full(16, 99, dtype=np.int32)},
        {"w": np.full(16, -1.0)},
        {"w": np.full(16, np.nan)},
        {"lon": np.full(16, np.nan)},
        {"w": np.array([{}] * 16)},
    ],
)
def test_a_graph_with_faults_is_refused(changes):
    with pytest.raises(InvalidFile):
        read_graph(graph_file(**changes))


@pytest.mark.parametrize(
    "mission",
    [[], {}, {"uavs": [[55.0]], "targets": [1]}, {"uavs": [[55.0, 10.0]], "targets": [16]}, {"uavs": [["x", 1]], "targets": [0]}],
)
def test_a_mission_with_faults_is_refused(mission):
    with pytest.raises(InvalidFile):
        planned(mission)


@pytest.mark.parametrize("spoil", [lambda npz: b"no npz", lambda npz: npz[: len(npz) // 2], lambda npz: npz[:200] + bytes(60) + npz[260:]])
def test_a_file_that_is_no_whole_npz_is_refused(spoil):
    with pytest.raises(InvalidFile):
        read_graph(io.BytesIO(spoil(graph_file().getvalue())))
