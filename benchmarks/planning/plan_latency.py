"""How long a small plan takes on the ground in the database, beside the article's method on the same graph.

    .venv/bin/python benchmarks/planning/plan_latency.py --uavs 2 --targets 4 --count 50

Both plan the same missions: UAVs and towers or bridges at random, total distance, open routes. Spanwise's time is the whole of
make_plan, with its database queries, waypoints, heights and zone checks; the article's is its path matrix and assignment alone.
"""

import argparse
import os
import random
import statistics
import sys
from pathlib import Path
from time import perf_counter

import django

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from benchmarks.planning.article_method import ArticleMethod  # noqa: E402 (Django first)
from inspection.geodesy import LonLat  # noqa: E402
from inspection.network.inspection_graph import InspectionGraph, NodeKind  # noqa: E402
from inspection.selectors import current_graph  # noqa: E402
from missions.services import PlanRequest, TargetRequest, UavRequest, make_plan  # noqa: E402
from planning.problem import Objective  # noqa: E402
from planning.request import EndAction  # noqa: E402


def missions(graph: InspectionGraph, uavs: int, targets: int, count: int, seed: int) -> list[tuple[list[LonLat], list[int]]]:
    """Positions of UAVs and nodes of targets, within about 30 km of a random node."""
    draw = random.Random(seed)
    single = [node for node in range(graph.node_count) if graph.node_kind[node] in {NodeKind.SUPPORT, NodeKind.BRIDGE}]
    drawn = []
    while len(drawn) < count:
        centre = graph.position[draw.choice(single)]
        near = [node for node in single if abs(graph.position[node] - centre).max() < 0.25]
        if len(near) > targets:
            starts = [graph.position[draw.choice(near)] + (draw.uniform(-0.01, 0.01), draw.uniform(-0.01, 0.01)) for _ in range(uavs)]
            drawn.append(([LonLat(float(lon), float(lat)) for lon, lat in starts], draw.sample(near, targets)))
    return drawn


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--uavs", type=int, default=2)
    parser.add_argument("--targets", type=int, default=4)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()

    graph = current_graph()
    article = ArticleMethod(graph)
    print(f"graph {graph.version}: {graph.node_count:,} nodes, {graph.edge_count:,} edges; {options.uavs} UAVs x {options.targets} targets")
    ours_s, articles_s, visited = [], [], 0
    for number, (starts, nodes) in enumerate(missions(graph, options.uavs, options.targets, options.count + 1, options.seed)):
        request = PlanRequest(
            tuple(UavRequest(f"UAV {number}", start, None, 12.0, EndAction.HOVER) for number, start in enumerate(starts)),
            tuple(TargetRequest(int(graph.node_asset[node])) for node in nodes),
            Objective.TOTAL,
            False,
        )
        began_s = perf_counter()
        plan = make_plan(request=request)
        planned_s = perf_counter()
        article.plan(starts, nodes)
        if number == 0:
            continue  # the first one loads the graph and its indices
        ours_s.append(planned_s - began_s)
        articles_s.append(perf_counter() - planned_s)
        visited += sum(len(route["targets"]) for route in plan["routes"])
    ours_ms, articles_ms = _report("Spanwise, whole plan", ours_s), _report("article, assignment", articles_s)
    print(f"ratio {articles_ms / ours_ms:.1f}; {visited} of {options.count * options.targets} targets visited")


def _report(what: str, seconds: list[float]) -> float:
    """Print median, least and rate; returns the median in ms."""
    median_ms = statistics.median(seconds) * 1_000
    print(f"{what:22} median {median_ms:8.1f} ms  min {min(seconds) * 1_000:8.1f} ms  {1_000 / median_ms:6.1f} plans/s in one process")
    return median_ms


if __name__ == "__main__":
    main()
