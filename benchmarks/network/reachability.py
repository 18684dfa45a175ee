"""How long it takes to say of every asset of a large network whether it can be inspected.

    python -m benchmarks.network.reachability [--nodes 200000] [--zones 500] [--uavs 10] [--count 5] [--write]

A network of make_graph.py, cleared of its zones and indexed before the clock starts, as planners have it. UAVs stand anywhere on it,
a third of each kind of end; half of them have a range of 40 km. All have the battery of one of two types, of 400 and 600 Wh, and there is
wind of 5 m/s; with --calm there is neither. Measured is what a request costs beyond the database: the reachabilities
and the answer as JSON. With --write the table goes to docs/performance.md. Exits with 1 where the bar is missed.
"""

import argparse
import sys
from collections.abc import Sequence
from itertools import pairwise
from statistics import median
from time import perf_counter

import numpy as np
import orjson
import shapely

from benchmarks.network.make_graph import make
from benchmarks.report import machine, table, write_section
from inspection.geodesy import LonLat, distance_m
from inspection.network.build.flyable import flyable_part
from inspection.network.build.network import Network
from inspection.network.build.zone_masking import masked
from inspection.network.inspection_graph import EdgeKind, NodeKind
from inspection.network.route_index import route_index
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.zones.zone_index import ZoneIndex
from planning.connection_points import AccessRules
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.path_cost import FlightClass
from planning.energy.performance import Performance
from planning.problem import End
from planning.reachability.reachability import FlownNetwork, PossibleFlight, reach
from planning.reachability.reachable_assets import Reach, Reachability
from planning.rules import FlightRules, RoutingRules

MAX_S = 1.0
RANGE_M = 40_000.0
SPANS_OF_A_LINE = 40
TYPES = [FlightClass(Performance(battery_wh=wh, mass_kg=6.0, rotor_disk_m2=0.8), 12.0) for wh in (400.0, 600.0)]
WIND = Conditions((WindLayer(60.0, 5.0, 250.0),))
CALM_TYPES, CALM = [None], Conditions()


def network_of(graph: dict[str, np.ndarray]) -> Network:
    position = np.column_stack([graph["lon"], graph["lat"]])
    edge = np.unique(np.sort(np.column_stack([graph["u"], graph["v"]]), axis=1), axis=0)
    length_m = distance_m(position[edge[:, 0]], position[edge[:, 1]])
    nodes = len(position)
    return Network(
        position=position,
        node_kind=np.array([NodeKind.SUPPORT, NodeKind.RAILWAY, NodeKind.BRIDGE], dtype=np.uint8)[graph["kind"]],
        node_asset=np.arange(nodes, dtype=np.int64),
        node_height_m=np.full(nodes, np.nan),
        edge=edge.astype(np.int32),
        length_m=length_m,
        cost=length_m,
        edge_kind=np.full(len(edge), EdgeKind.LINE, dtype=np.uint8),
        edge_asset=nodes + np.arange(len(edge), dtype=np.int64) // SPANS_OF_A_LINE,
    )


def zones_of(graph: dict[str, np.ndarray]) -> ZoneIndex:
    ends = graph["poly_off"].tolist()
    rings = [graph["poly_xy"][first:last] for first, last in pairwise(ends)]
    polygons = [shapely.make_valid(shapely.Polygon(ring)) for ring in rings]
    return ZoneIndex(polygons, np.arange(len(polygons)) + 1, [f"zone {number}" for number in range(len(polygons))])


def answer(found: Reach) -> bytes:
    columns = {
        "ids": found.asset,
        "code": found.state,
        "flight": found.flight,
        "missing_m": np.ceil(found.missing_m).astype(np.int64),
    }
    return orjson.dumps({name: column.tolist() for name, column in columns.items()})


def measure(
    nodes: int, zone_count: int, uavs: int, count: int, types: Sequence[FlightClass | None], wind: Conditions
) -> tuple[list[float], Reach, int]:
    """Seconds of each run, the last reachabilities, and the bytes of the answer."""
    made = make(nodes, polygons=zone_count)
    network, zones = network_of(made), zones_of(made)
    linking, flight, routing = LinkingRules(), FlightRules(), RoutingRules()
    heights = FlownHeights(flight.transit_agl_m, flight.clearance_m, flight.terrain_tolerance_m, 10.0)
    whole = masked(network, zones, linking, heights).graph
    graph = flyable_part(whole, flight.tallest_m)
    route_index(graph)
    rules = AccessRules(
        routing.access_leg_m, routing.direct_leg_m, linking.railway_spacing_m, linking.off_network_factor, linking.zone_clearance_m
    )
    generator = np.random.default_rng(7)
    times = []
    for run in range(count + 1):  # the first compiles
        at = graph.position[generator.choice(graph.node_count, uavs + 3)] + generator.normal(0.0, 0.003, (uavs + 3, 2))
        places = [LonLat(lon, lat) for lon, lat in at.tolist()]
        ends = (End.OPEN, End.RETURN, End.ANY_BASE)
        flights = [
            PossibleFlight(place, ends[number % 3], RANGE_M if number % 2 else np.inf, number % 3 > 0, types[number // 3 % len(types)])
            for number, place in enumerate(places[:uavs])
        ]
        began_s = perf_counter()
        found = reach(FlownNetwork(network, whole, graph, zones, zones), flights, places[uavs:], rules, conditions=wind)
        size = len(answer(found))
        if run:
            times.append(perf_counter() - began_s)
    return times, found, size


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=200_000)
    parser.add_argument("--zones", type=int, default=500)
    parser.add_argument("--uavs", type=int, default=10)
    parser.add_argument("--count", type=int, default=5)
    parser.add_argument("--calm", action="store_true", help="without batteries and wind")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    times, found, size = measure(
        options.nodes, options.zones, options.uavs, options.count, *((CALM_TYPES, CALM) if options.calm else (TYPES, WIND))
    )
    reachabilities = ", ".join(
        f"{int((found.state == reachability).sum()):,} {reachability.name.lower().replace('_', ' ')}" for reachability in Reachability
    )
    head = [f"{options.nodes:,} nodes, {options.zones} zones, {options.uavs} UAVs", "median", "longest", "assets", "answer"]
    row = [
        "which assets can be inspected",
        f"{median(times):.2f} s",
        f"{max(times):.2f} s",
        f"{len(found.asset):,}",
        f"{size / 1e6:.1f} MB",
    ]
    text = f"`python -m benchmarks.network.reachability`: {reachabilities}. {machine('numba', 'numpy', 'scipy')}\n\n{table(head, [row])}"
    print(text)
    if options.write:
        write_section("What can be inspected", text)
    if median(times) > MAX_S:
        print(f"missed: {median(times):.2f} s, more than {MAX_S:.0f} s", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
