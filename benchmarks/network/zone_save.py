"""How long a saved zone takes until planners use a graph that is clear of it.

    python -m benchmarks.network.zone_save [--nodes 200000] [--zones 500] [--count 10] [--write]

A network of make_graph.py and its zones are put into the database, in a transaction that is taken back. Then zones are saved one by
one, and after each what a plan begins with is read: the newest network cleared of the zones of now, with its index, from files that
the first process to ask has made. With --write the table goes to docs/performance.md. Exits with 1 where the bar is missed.
"""

import argparse
import os
import sys
import tempfile
from hashlib import sha256
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

import django
import numpy as np

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.conf import settings  # noqa: E402 (Django first)
from django.contrib.gis.geos import MultiPolygon, Polygon  # noqa: E402
from django.db import transaction  # noqa: E402

from benchmarks.network.make_graph import make  # noqa: E402
from benchmarks.report import machine, table, write_section  # noqa: E402
from inspection.geodesy import distance_m  # noqa: E402
from inspection.models import GraphSnapshot, NoFlyZone  # noqa: E402
from inspection.network.build.network import Network  # noqa: E402
from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind  # noqa: E402
from inspection.network.snapshot_file import to_bytes  # noqa: E402
from inspection.network.warm_up import rehearse  # noqa: E402
from inspection.network.zones.zone_index import ZoneIndex  # noqa: E402
from inspection.selectors.graph import rules_of_snapshots  # noqa: E402
from inspection.selectors.planning import planning_read  # noqa: E402
from inspection.services.ground import mark_ground_changed  # noqa: E402

MAX_S = 2.0
HALF_DEG = 0.01


def store(graph: dict[str, np.ndarray]) -> Network:
    position = np.column_stack([graph["lon"], graph["lat"]])
    edge = np.unique(np.sort(np.column_stack([graph["u"], graph["v"]]), axis=1), axis=0)
    length_m = distance_m(position[edge[:, 0]], position[edge[:, 1]])
    network = Network(
        position=position,
        node_kind=np.array([NodeKind.SUPPORT, NodeKind.RAILWAY, NodeKind.BRIDGE], dtype=np.uint8)[graph["kind"]],
        node_asset=np.arange(len(position), dtype=np.int64),
        node_height_m=np.full(len(position), np.nan),
        edge=edge.astype(np.int32),
        length_m=length_m,
        cost=length_m,
        edge_kind=np.full(len(edge), EdgeKind.LINE, dtype=np.uint8),
        edge_asset=np.full(len(edge), -1, dtype=np.int64),
    )
    content = to_bytes(network)
    counts = {"nodes": network.node_count, "edges": network.edge_count, "components": 1, "excluded_nodes": 0, "excluded_edges": 0}
    GraphSnapshot.objects.create(
        ground_revision=mark_ground_changed(),
        rules=rules_of_snapshots(),
        arrays=content,
        arrays_sha256=sha256(content).hexdigest(),
        build_s=0.0,
        **counts,
    )
    return network


def save_zone(number: int, ring: np.ndarray) -> None:
    polygon = MultiPolygon(Polygon([*ring.tolist(), ring[0].tolist()]), srid=4326)
    NoFlyZone.objects.create(identifier=f"benchmark {number}", name=f"benchmark {number}", geometry=polygon)
    mark_ground_changed()


def current_ground() -> tuple[InspectionGraph, ZoneIndex]:
    """What a plan without a departure time begins with."""
    ground = planning_read().ground()
    zones = ground.zones()
    return ground.graph(zones), zones


def measure(nodes: int, zones: int, count: int) -> tuple[list[float], list[float]]:
    """Seconds of each save, on the clock and of this process's processor time."""
    graph = make(nodes, polygons=zones)
    network = store(graph)
    NoFlyZone.objects.all().delete()
    rings = np.split(graph["poly_xy"], graph["poly_off"][1:-1]) if zones else []
    for number, ring in enumerate(rings):
        save_zone(number, ring)
    current_ground()
    draw, seconds, busy_s = np.random.default_rng(1), [], []
    corners = HALF_DEG * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for number in range(count):
        save_zone(len(rings) + number, network.position[draw.integers(network.node_count)] + corners)
        began_s, began_busy_s = perf_counter(), process_time()
        graph, zones = current_ground()
        seconds.append(perf_counter() - began_s)
        busy_s.append(process_time() - began_busy_s)
        print(f"{seconds[-1]:.2f} s: {graph.node_count:,} of {network.node_count:,} nodes clear of {len(zones):,} zones")
    return seconds, busy_s


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=200_000)
    parser.add_argument("--zones", type=int, default=500)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    rehearse()
    with tempfile.TemporaryDirectory() as folder, transaction.atomic():
        settings.GRAPH_CACHE_DIR = Path(folder)
        seconds, busy_s = measure(options.nodes, options.zones, options.count)
        transaction.set_rollback(True)
    rows = [
        [f"{options.nodes:,}", f"{options.zones:,}", f"{median(seconds):.2f} s", f"{max(seconds):.2f} s", f"{median(busy_s):.2f} s"],
    ]
    text = table(["nodes", "zones", "save to graph in use, median", "longest", "processor time, median"], rows)
    print(text)
    if options.write:
        write_section(
            "A saved zone until planners keep clear of it",
            f"`python -m benchmarks.network.zone_save`\n\n{text}\n\n{machine('numpy', 'shapely')}",
        )
    sys.exit(max(seconds) > MAX_S)


if __name__ == "__main__":
    main()
