"""The graph of whole regions, generated and real: what the rules promise holds for every edge, with and without zones."""

from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
import shapely

from inspection import services
from inspection.geodesy import LonLat, distance_m
from inspection.network.build.build import build
from inspection.network.build.edges import component_labels
from inspection.network.build.zone_masking import MaskedGraph
from inspection.network.infrastructure import GroundData, Zones
from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.network.nearness import pairs_within
from inspection.network.paths.access import LegRules, clear_legs
from inspection.network.paths.paths import travel_between
from inspection.network.rules import LinkingRules
from inspection.network.zones.zone_index import zones_of_graph
from inspection.selectors.ground_data import ground_data
from tests.cases import long
from tests.exact_geometry import segment_meets_polygon

RULES = LinkingRules()
REGIONS = [
    "elme-valley.osm.pbf", "quillmoor.osm.pbf",
    *long("columbus-ohio.osm.pbf", "nepal-power-2025.osm.pbf", "liechtenstein-2021-infra.osm.pbf", "copenhagen-rail-2015.osm.gz"),
]  # fmt: skip


@pytest.fixture(scope="module")
def grounds() -> dict[str, GroundData]:
    return {}


@pytest.fixture(params=REGIONS)
def region(request, grounds, db, region_file) -> GroundData:
    if request.param not in grounds:
        services.import_osm(path=region_file(request.param))
        grounds[request.param] = ground_data()
    return grounds[request.param]


def with_random_zones(ground: GroundData, seed: int, count: int = 40) -> GroundData:
    """Irregular polygons of 0.1 to 2 km around random places of the region."""
    rng = np.random.default_rng(seed)
    places = np.concatenate([ground.supports.position, ground.bridges.position, ground.lines.position, ground.railways.position])
    zones = []
    for lon, lat in places[rng.integers(0, len(places), count)] + rng.normal(0, 0.005, (count, 2)):
        angle = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 12)))
        radius_deg = rng.uniform(0.001, 0.02) * rng.uniform(0.3, 1.0, len(angle))
        zones.append(shapely.Polygon(np.column_stack([lon + radius_deg * np.cos(angle), lat + radius_deg * np.sin(angle)])))
    zones = [zone for zone in zones if zone.is_valid]
    names = tuple(f"zone {number}" for number in range(len(zones)))
    wkb = tuple(shapely.to_wkb(zone) for zone in zones)
    return GroundData(
        ground.revision,
        ground.supports,
        ground.bridges,
        ground.lines,
        ground.railways,
        Zones(wkb, np.arange(len(zones), dtype=np.int64), names),
    )


def assert_rules_hold(result: MaskedGraph) -> None:
    graph = result.graph
    start, end = graph.edge.T
    kinds = np.sort(np.column_stack([graph.node_kind[start], graph.node_kind[end]]), axis=1)
    assert graph.length_m == pytest.approx(distance_m(graph.position[start], graph.position[end]), abs=1e-6)
    assert (graph.length_m > 0).all()
    assert (start < end).all()
    assert len(np.unique(graph.edge, axis=0)) == graph.edge_count
    is_link = graph.edge_kind > EdgeKind.RAILWAY
    assert np.array_equal(graph.cost, np.where(is_link, RULES.off_network_factor * graph.length_m, graph.length_m))
    assert ((graph.edge_asset < 0) == is_link).all()
    for kind, ends, farthest_m in (
        (EdgeKind.RAILWAY, {(2, 2)}, RULES.railway_spacing_m),
        (EdgeKind.BRIDGE_TO_TOWER, {(0, 3)}, RULES.bridge_to_tower_m),
        (EdgeKind.BRIDGE_TO_BRIDGE, {(3, 3)}, RULES.bridge_to_bridge_m),
        (EdgeKind.RAILWAY_TO_TOWER, {(0, 2)}, RULES.railway_to_tower_m),
        (EdgeKind.CROSSING, {(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 3)}, RULES.crossing_m),
        (EdgeKind.LINE, {(0, 0), (0, 1), (1, 1)}, np.inf),
    ):
        of_kind = graph.edge_kind == kind
        assert set(map(tuple, kinds[of_kind].tolist())) <= ends
        assert graph.length_m[of_kind].max(initial=0.0) <= farthest_m
    assert result.components == component_labels(graph.node_count, graph.edge)[0]


@pytest.mark.django_db
def test_every_edge_obeys_its_rule(region):
    result = build(region, RULES)
    assert_rules_hold(result)
    assert (result.excluded_nodes, result.excluded_edges) == (0, 0)
    graph = result.graph
    bridges = np.flatnonzero(graph.node_kind == NodeKind.BRIDGE)
    assert int((graph.edge_kind == EdgeKind.BRIDGE_TO_BRIDGE).sum()) == len(pairs_within(graph.position[bridges], RULES.bridge_to_bridge_m))
    assert set(region.supports.asset.tolist()) <= set(graph.node_asset[graph.node_kind == NodeKind.SUPPORT].tolist())


@pytest.mark.django_db
def test_every_line_span_is_an_edge(region):
    """Independent of the builder: consecutive OSM nodes of each line against the graph's positions."""
    graph = build(region, RULES).graph
    number = {tuple(place): index for index, place in reversed(list(enumerate(graph.position.tolist())))}
    pairs = {tuple(pair) for pair in graph.edge.tolist()}
    place_of_osm = dict(zip(region.supports.osm_node.tolist(), region.supports.position.tolist(), strict=True))
    for begin, end in zip(region.lines.first[:-1].tolist(), region.lines.first[1:].tolist(), strict=True):
        way = [
            number[tuple(place_of_osm.get(region.lines.osm_node[vertex], region.lines.position[vertex].tolist()))]
            for vertex in range(begin, end)
        ]
        for one, other in pairwise(way):
            assert one == other or (min(one, other), max(one, other)) in pairs


@pytest.mark.django_db
@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(5, 10))])
def test_no_node_and_no_edge_meets_a_zone(region, seed):
    """Judged by exact rational arithmetic, for all edges whose box meets the zone's box."""
    zoned = with_random_zones(region, seed)
    result = build(zoned, RULES)
    assert_rules_hold(result)
    graph = result.graph
    assert result.excluded_edges > 0
    lowest = np.minimum(graph.position[graph.edge[:, 0]], graph.position[graph.edge[:, 1]])
    highest = np.maximum(graph.position[graph.edge[:, 0]], graph.position[graph.edge[:, 1]])
    for zone in shapely.from_wkb(np.array(zoned.zones.wkb, dtype=object)):
        west, south, east, north = zone.bounds
        near = (lowest[:, 0] <= east) & (highest[:, 0] >= west) & (lowest[:, 1] <= north) & (highest[:, 1] >= south)
        for start, end in graph.edge[near].tolist():
            assert not segment_meets_polygon(graph.position[start].tolist(), graph.position[end].tolist(), [zone.exterior.coords])
        inside = shapely.contains_xy(zone, graph.position)
        assert not inside.any()


@pytest.mark.django_db
def test_only_what_meets_a_zone_is_taken_away(region):
    """Every edge of the graph without zones is there, or comes within the clearance (and its allowed excess) of a zone."""
    whole = build(region, RULES).graph
    zoned = build(with_random_zones(region, 3), RULES).graph
    node = {tuple(place): index for index, place in enumerate(zoned.position.tolist())}
    left = {tuple(pair) for pair in zoned.edge.tolist()}
    zones = shapely.from_wkb(np.array(zoned.zone_wkb, dtype=object))
    around = shapely.STRtree(
        shapely.buffer(zones, 1.2 * RULES.zone_clearance_m / 111_000 / np.cos(np.radians(np.abs(whole.position[:, 1]).max())))
    )
    for kind, (start, end) in zip(whole.edge_kind.tolist(), whole.edge.tolist(), strict=True):
        if kind in (EdgeKind.BRIDGE_TO_TOWER, EdgeKind.RAILWAY_TO_TOWER):
            continue
        ends = [node.get(tuple(whole.position[one].tolist())) for one in (start, end)]
        if None in ends or tuple(sorted(ends)) not in left:
            assert len(around.query(shapely.LineString(whole.position[[start, end]]), predicate="intersects"))


def missions(graph: InspectionGraph, count: int):
    rng = np.random.default_rng(11)
    zones = zones_of_graph(graph)
    for _ in range(count):
        spots = graph.position[rng.integers(0, graph.node_count, 6)] + rng.normal(0, 0.003, (6, 2)) * rng.integers(0, 2, (6, 1))
        yield [
            clear_legs(graph, zones, LonLat(*spot), LegRules(2_000, RULES.off_network_factor, RULES.zone_clearance_m))
            for spot in spots.tolist()
        ]


@pytest.mark.django_db
def test_ways_between_places_equal_those_of_networkx(region):
    graph = build(with_random_zones(region, 4), RULES).graph
    copy = nx.Graph()
    copy.add_nodes_from(range(graph.node_count))
    copy.add_weighted_edges_from((a, b, cost) for (a, b), cost in zip(graph.edge.tolist(), graph.cost.tolist(), strict=True))
    found = 0
    for legs_of in missions(graph, 6):
        travel = travel_between(graph, legs_of[:2], legs_of[2:])
        directed = copy.to_directed()
        for name, group in (("source", legs_of[:2]), ("sink", legs_of[2:])):
            for place, legs in enumerate(group):
                directed.add_node((name, place))
                for leg in legs:
                    ends = ((name, place), leg.node) if name == "source" else (leg.node, (name, place))
                    directed.add_edge(*ends, weight=leg.cost)
        for source in range(2):
            costs = nx.single_source_dijkstra_path_length(directed, ("source", source))
            for sink in range(4):
                expected = costs.get(("sink", sink), np.inf)
                assert travel.cost[source, sink] == pytest.approx(expected, abs=1e-6)
                found += np.isfinite(expected)
    assert found >= 5
