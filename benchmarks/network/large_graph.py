"""A stored graph of many nodes, and the process of a planner that maps it: the parts of `benchmarks.planning.plan_speed` that run alone.

    python -m benchmarks.network.large_graph --store FOLDER      writes FOLDER/large.npz as the task that builds graphs does
    python -m benchmarks.network.large_graph --planner FOLDER    plans FOLDER/missions.json on it; prints the most memory it had

Nothing else is imported here, so that what is measured is what a web worker has loaded.
"""

import argparse
import json
import math
import os
import resource
from pathlib import Path

import numpy as np

TARGETS, UAVS = 4, 2
KEY = "large"


def planner(folder: Path) -> None:
    """What a web worker does, in this process: map the stored graph and its index, and plan; prints the most memory it had."""
    import config.wsgi  # noqa: F401, PLC0415 (all that a web worker has loaded)
    from inspection.geodesy import LonLat  # noqa: PLC0415
    from inspection.network.paths.access import LegRules, clear_legs  # noqa: PLC0415
    from inspection.network.paths.paths import travel_between  # noqa: PLC0415
    from inspection.network.snapshot_file import read_masked  # noqa: PLC0415
    from inspection.network.zones.zone_index import ZoneIndex  # noqa: PLC0415

    zones = ZoneIndex([], [], [])
    graph = read_masked(folder / "graphs", key=KEY, zones=zones, version=1, ground_revision=1, tallest_m=math.inf)
    if graph is None:
        raise SystemExit("the stored graph cannot be read")
    for mission in json.loads((folder / "missions.json").read_bytes()):
        places = [LonLat(lon, lat) for lat, lon in mission["uavs"]]
        places += [LonLat(*graph.position[node].tolist()) for node in mission["targets"]]
        legs = [clear_legs(graph, zones, place, LegRules(3_000.0, 2.0, 5.0)) for place in places]
        travel = travel_between(graph, legs, legs[UAVS:])
        for source in range(len(legs)):
            for sink in range(TARGETS):
                travel.path(source, sink)
    print(json.dumps({"peak_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}))


def store(folder: Path) -> None:
    """Write the large graph with its index as the task that builds graphs does, in a process of its own."""
    import django  # noqa: PLC0415

    django.setup()
    from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind  # noqa: PLC0415
    from inspection.network.snapshot_file import write_masked  # noqa: PLC0415

    stored = np.load(folder / "large.npz")
    nodes, edges = len(stored["lat"]), len(stored["u"])
    graph = InspectionGraph(
        version=1,
        ground_revision=1,
        position=np.column_stack([stored["lon"], stored["lat"]]),
        node_kind=np.array([NodeKind.SUPPORT, NodeKind.RAILWAY, NodeKind.BRIDGE], dtype=np.uint8)[stored["kind"]],
        node_asset=np.arange(nodes, dtype=np.int64),
        node_height_m=np.full(nodes, np.nan),
        edge=np.sort(np.column_stack([stored["u"], stored["v"]]), axis=1),
        length_m=stored["w"],
        cost=stored["w"],
        edge_kind=np.full(edges, EdgeKind.LINE, dtype=np.uint8),
        edge_asset=np.arange(edges, dtype=np.int64) // 40,
        zone_wkb=(),
        zone_id=np.zeros(0, dtype=np.int64),
        zone_name=(),
    )
    write_masked(folder / "graphs", graph, key=KEY, tallest_m=math.inf)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--store", type=Path)
    parser.add_argument("--planner", type=Path)
    options = parser.parse_args()
    os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
    if options.store:
        store(options.store)
    if options.planner:
        planner(options.planner)


if __name__ == "__main__":
    main()
