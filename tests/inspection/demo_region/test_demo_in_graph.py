"""The demo region through the real importers and the graph builder: one network that zones bend and do not cut."""

import json
from pathlib import Path

import numpy as np
import pytest
from django.conf import settings

from inspection.demo_region import BASES, make_region, write_osm_file
from inspection.models import Asset, AssetKind, DataImport, GraphSnapshot, NoFlyZone
from inspection.network.build.edges import component_labels
from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.network.paths.access import LegRules, clear_legs
from inspection.selectors import current_graph, zones_in_force
from inspection.services import build_graph, import_osm, import_zones


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    directory = tmp_path_factory.mktemp("demo")
    region = make_region()
    write_osm_file(directory / "demo.osm.pbf", region.osm)
    (directory / "demo-zones.json").write_text(json.dumps(region.zones))
    return directory / "demo.osm.pbf", directory / "demo-zones.json"


@pytest.fixture
def imports(db: None, files: tuple[Path, Path]) -> tuple[DataImport, DataImport]:
    osm_path, zones_path = files
    return import_osm(path=osm_path, is_synthetic=True), import_zones(path=zones_path, is_synthetic=True)


@pytest.fixture
def snapshot(imports: tuple[DataImport, DataImport], tmp_path: Path, settings: object) -> GraphSnapshot:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"  # type: ignore[attr-defined]
    return build_graph()


@pytest.fixture
def graph(snapshot: GraphSnapshot) -> InspectionGraph:
    return current_graph()


def test_the_importers_find_what_was_drawn(imports: tuple[DataImport, DataImport]) -> None:
    drawn = make_region().counts()
    of_kind = {kind: Asset.objects.filter(kind=kind).count() for kind in AssetKind}
    assert of_kind[AssetKind.TOWER] == drawn["supports"]
    assert of_kind[AssetKind.BRIDGE] == 60
    assert set(Asset.objects.filter(kind=AssetKind.RAILWAY).values_list("name", flat=True)) == {"Elme Valley Line", "Brindlow Branch"}
    assert NoFlyZone.objects.count() == 8
    assert Asset.objects.filter(kind=AssetKind.LINE, is_flyable=True).count() == drawn["power_lines"]


def test_both_imports_are_marked_as_synthetic(imports: tuple[DataImport, DataImport]) -> None:
    assert [row.is_synthetic for row in imports] == [True, True]


def test_only_the_fair_has_a_schedule_and_one_zone_states_no_upper_limit(imports: tuple[DataImport, DataImport]) -> None:
    assert list(NoFlyZone.objects.filter(schedule__isnull=False).values_list("name", flat=True)) == ["Brindlow Showground"]
    assert list(NoFlyZone.objects.filter(upper_limit_m=None).values_list("name", flat=True)) == ["Wickenfell Training Area"]
    assert NoFlyZone.objects.exclude(circle=None).count() == 3


def test_the_airfields_height_band_is_kept_with_its_references(imports: tuple[DataImport, DataImport]) -> None:
    airfield = NoFlyZone.objects.get(name="Varneck Airfield")
    assert (airfield.lower_limit_m, airfield.lower_reference, airfield.upper_reference) == (0, "AGL", "AMSL")
    assert airfield.upper_limit_m == pytest.approx(2_500 * 0.3048)


def test_nine_tenths_of_the_nodes_hang_together_and_both_bases_reach_them(graph: InspectionGraph) -> None:
    count, component = component_labels(graph.node_count, graph.edge)
    sizes = np.bincount(component, minlength=count)
    assert sizes.max() > 0.9 * graph.node_count
    rules = settings.GRAPH_RULES
    for base in BASES:
        leg_rules = LegRules(settings.ROUTING_RULES.access_leg_m, rules.off_network_factor, rules.zone_clearance_m)
        legs = clear_legs(graph, zones_in_force(), base.position, leg_rules)
        assert sizes.argmax() in component[[leg.node for leg in legs]], base.name


def test_zones_take_nodes_and_edges_out(snapshot: GraphSnapshot) -> None:
    assert snapshot.excluded_nodes > 20
    assert snapshot.excluded_edges > 20


def test_the_graph_has_every_kind_of_node_and_a_link_at_every_bridge(graph: InspectionGraph) -> None:
    assert set(graph.node_kind.tolist()) == set(NodeKind)
    links = graph.edge[np.isin(graph.edge_kind, [EdgeKind.BRIDGE_TO_TOWER, EdgeKind.BRIDGE_TO_BRIDGE])]
    bridges = np.flatnonzero(graph.node_kind == NodeKind.BRIDGE)
    assert len(bridges) > 50
    assert set(bridges.tolist()) <= set(links.ravel().tolist())
