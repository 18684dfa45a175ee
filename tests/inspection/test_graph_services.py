"""From assets and zones in the database to the graph that planners hold."""

import json
import shutil
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from io import StringIO
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from django.contrib.gis.geos import LineString, MultiPolygon, Point, Polygon
from django.core.management import CommandError, call_command
from django.db import connection, connections
from django.utils import timezone

from inspection import selectors, services, tasks
from inspection.geodesy import LonLat
from inspection.models import Asset, AssetKind, GraphSnapshot, NoFlyZone
from inspection.network.build.flyable import flyable_part
from inspection.network.inspection_graph import InspectionGraph, NodeKind
from inspection.network.legs import Attachment
from inspection.network.paths.paths import travel_between
from inspection.network.route_index import route_index
from inspection.network.rules import LinkingRules
from inspection.network.snapshot_file import CLEARED, NETWORKS
from inspection.network.zones.zone_index import ZoneIndex
from inspection.selectors import graph as graph_selectors
from inspection.selectors.graph import KEPT, _MadeOnce, graph_for
from inspection.selectors.planning import planning_read
from inspection.services.graph import BUILD_LOCK, KEPT_SNAPSHOTS
from tests.inspection.network.drawn_graphs import drawn_graph

GRAPH, OTHER = drawn_graph([], []), drawn_graph([], [])

pytestmark = pytest.mark.django_db


@pytest.fixture(autouse=True)
def _own_cache(settings, tmp_path: Path) -> None:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"


@pytest.fixture
def line() -> Asset:
    """1 --- 2 --- 3: two towers, and a vertex without one between them."""
    for osm_id, lon in ((1, 9.000), (3, 9.004)):
        point = Point(lon, 47.0, srid=4326)
        Asset.objects.create(kind=AssetKind.TOWER, osm_type="n", osm_id=osm_id, geometry=point, centre=point, height_m=30.0)
    path = LineString((9.000, 47.0), (9.002, 47.0), (9.004, 47.0), srid=4326)
    line = Asset.objects.create(kind=AssetKind.LINE, osm_type="w", osm_id=7, geometry=path, centre=path.centroid, node_osm_ids=[1, 2, 3])
    services.mark_ground_changed()
    return line


def add_zone(west: float, south: float, east: float, north: float, name: str = "Airfield") -> NoFlyZone:
    zone = NoFlyZone.objects.create(
        identifier=name, name=name, geometry=MultiPolygon(Polygon.from_bbox((west, south, east, north)), srid=4326)
    )
    services.mark_ground_changed()
    return zone


def test_each_change_counts_the_ground_up():
    first = services.mark_ground_changed()
    assert services.mark_ground_changed() == first + 1 == selectors.ground_revision()


def test_the_graph_shows_the_assets(line):
    snapshot = services.build_graph()
    graph = selectors.current_graph()
    assert graph.version == snapshot.version
    assert graph.ground_revision == selectors.ground_revision()
    assert (snapshot.nodes, snapshot.edges, snapshot.components) == (3, 2, 1)
    assert sorted(graph.node_kind.tolist()) == [NodeKind.SUPPORT, NodeKind.SUPPORT, NodeKind.LINE_VERTEX]
    assert np.nanmax(graph.node_height_m) == 30.0
    assert set(graph.edge_asset.tolist()) == {line.pk}


@pytest.mark.long
def test_assets_that_vanished_or_cannot_be_flown_are_left_out(line):
    Asset.objects.filter(osm_id=3).update(vanished_at=timezone.now())
    Asset.objects.filter(pk=line.pk).update(is_flyable=False)
    services.mark_ground_changed()
    assert services.build_graph().nodes == 1


def test_nothing_is_built_while_nothing_has_changed(line, settings):
    first = services.build_graph()
    assert services.build_graph().version == first.version
    forced = services.build_graph(force=True)
    assert forced.version > first.version
    assert bytes(forced.arrays) == bytes(GraphSnapshot.objects.get(version=first.version).arrays)
    settings.GRAPH_RULES = LinkingRules(crossing_m=10.0)
    assert services.build_graph().version > forced.version


def test_a_zone_takes_nodes_and_edges_out_and_is_gone_round(line):
    """Two towers are left, and two bends round the zone between them."""
    services.build_graph()
    zone = add_zone(9.0015, 46.999, 9.0025, 47.001)
    snapshot = services.build_graph()
    assert (snapshot.nodes, snapshot.edges, snapshot.components) == (4, 3, 1)
    assert (snapshot.excluded_nodes, snapshot.excluded_edges) == (1, 2)
    assert selectors.current_graph().zone_id.tolist() == [zone.pk]
    assert selectors.current_graph().zone_name == ("Airfield",)


def test_zones_in_force_are_those_of_now_not_of_the_graph(line):
    services.build_graph()
    assert selectors.zones_in_force().zone_at(LonLat(9.002, 47.0)) is None
    zone = add_zone(9.0015, 46.999, 9.0025, 47.001)
    assert selectors.zones_in_force().zone_at(LonLat(9.002, 47.0)) == (zone.pk, "Airfield")
    assert selectors.zones_in_force() is selectors.zones_in_force()
    zone.delete()
    services.mark_ground_changed()
    assert selectors.zones_in_force().zone_at(LonLat(9.002, 47.0)) is None


def test_a_process_loads_a_version_once_and_takes_up_the_next(line, django_assert_num_queries):
    services.build_graph()
    graph = selectors.current_graph()
    with django_assert_num_queries(2):
        assert selectors.current_graph() is graph
    newer = services.build_graph(force=True)
    assert selectors.current_graph().version == newer.version
    assert selectors.graph_of_version(graph.version).version == graph.version


def test_a_graph_is_loaded_from_the_database_where_no_cache_can_be_written(line, settings, tmp_path):
    settings.GRAPH_CACHE_DIR = tmp_path / "a file"
    settings.GRAPH_CACHE_DIR.write_text("in the way")
    assert services.build_graph().nodes == selectors.current_graph().node_count == 3


def test_without_a_snapshot_there_is_no_graph():
    with pytest.raises(selectors.NoGraph):
        selectors.current_graph()
    with pytest.raises(selectors.NoGraph):
        selectors.graph_of_version(1)


def test_the_task_builds_once_for_several_changes(line):
    for _ in range(3):
        services.mark_ground_changed()
    tasks.refresh_graph()
    tasks.refresh_graph()
    assert GraphSnapshot.objects.count() == 1


def test_the_task_builds_nothing_where_there_are_no_assets():
    services.mark_ground_changed()
    tasks.refresh_graph()
    assert not GraphSnapshot.objects.exists()


def test_the_task_clears_the_graph_when_the_last_asset_goes(line):
    tasks.refresh_graph()
    Asset.objects.all().delete()
    services.mark_ground_changed()
    tasks.refresh_graph()
    assert selectors.current_graph().node_count == 0


@pytest.mark.django_db(transaction=True)
def test_the_task_leaves_a_build_under_way_alone(line):
    other = connections.create_connection("default")
    try:
        with other.cursor() as cursor:
            cursor.execute("SELECT pg_advisory_lock(%s)", [BUILD_LOCK])
        assert services.refresh_graph() is None
        with other.cursor() as cursor:
            cursor.execute("SELECT pg_advisory_unlock(%s)", [BUILD_LOCK])
        assert services.refresh_graph() is not None
    finally:
        other.close()


def test_only_the_newest_snapshots_are_kept(line):
    first = services.build_graph()
    for _ in range(KEPT_SNAPSHOTS):
        newest = services.build_graph(force=True)
    assert GraphSnapshot.objects.count() == KEPT_SNAPSHOTS
    assert not GraphSnapshot.objects.filter(version=first.version).exists()
    assert selectors.current_graph().version == newest.version


def test_a_line_that_a_curator_edited_is_joined_by_position(line):
    """Its second vertex was moved; the OSM node of old must not pull another line there."""
    branch = LineString((9.002, 47.0), (9.002, 47.003), srid=4326)
    Asset.objects.create(kind=AssetKind.LINE, osm_type="w", osm_id=8, geometry=branch, centre=branch.centroid, node_osm_ids=[2, 9])
    services.mark_ground_changed()
    assert services.build_graph().components == 1
    line.geometry = LineString((9.000, 47.0), (9.002, 46.99), (9.004, 47.0), srid=4326)
    line.is_edited = True
    line.save()
    services.mark_ground_changed()
    snapshot = services.build_graph()
    assert snapshot.components == 2
    assert [9.002, 46.99] in selectors.current_graph().position.tolist()


def test_build_graph_prints_its_figures(line):
    printed = StringIO()
    call_command("build_graph", "--json", stdout=printed)
    figures = json.loads(printed.getvalue())
    assert figures.pop("build_s") > 0
    assert figures == {
        "version": selectors.current_graph().version,
        "nodes": 3,
        "edges": 2,
        "components": 1,
        "excluded_nodes": 0,
        "excluded_edges": 0,
    }
    printed = StringIO()
    call_command("build_graph", "--force", stdout=printed)
    assert "3 nodes, 2 edges, 1 components" in printed.getvalue()


def test_the_graph_is_exported_in_three_formats(line, settings, tmp_path):
    first = services.build_graph()
    call_command("export_graph", "--format", "graphml", "--version", str(first.version), str(tmp_path / "all.graphml"), stdout=StringIO())
    settings.GRAPH_RULES = LinkingRules(detour_m=0.0)
    add_zone(9.0025, 46.999, 9.0035, 47.001)
    services.build_graph()

    copy = nx.read_graphml(tmp_path / "all.graphml")
    assert (len(copy), copy.number_of_edges(), copy.graph["graph_version"]) == (3, 2, first.version)
    assert {data["kind"] for _, data in copy.nodes(data=True)} == {"support", "line_vertex"}
    assert all(data["length_m"] == pytest.approx(152.1, abs=0.5) for *_, data in copy.edges(data=True))

    call_command("export_graph", "--format", "geojson", str(tmp_path / "cleared.geojson"), stdout=StringIO())
    features = json.loads((tmp_path / "cleared.geojson").read_text())["features"]
    assert [feature["geometry"]["type"] for feature in features] == ["LineString", "Point"]
    assert features[0]["properties"]["kind"] == "line"
    assert features[0]["properties"]["asset"] == line.pk

    call_command("export_graph", "--format", "npz", str(tmp_path / "cleared.npz"), stdout=StringIO())
    with np.load(tmp_path / "cleared.npz") as arrays:
        assert arrays["position"].shape == (3, 2)
        assert arrays["edge"].shape == (1, 2)


def test_an_export_without_a_graph_or_to_no_folder_says_why(line, tmp_path):
    with pytest.raises(CommandError, match="no such graph"):
        call_command("export_graph", str(tmp_path / "graph.npz"))
    services.build_graph()
    with pytest.raises(CommandError, match="cannot be written"):
        call_command("export_graph", str(tmp_path / "missing" / "graph.npz"))
    assert not connection.needs_rollback


def masked_files(settings) -> set[str]:
    return {path.name for path in (settings.GRAPH_CACHE_DIR / CLEARED).iterdir()}


def test_the_task_leaves_the_index_ready_for_planners(line, settings):
    services.build_graph()
    (name,) = masked_files(settings)
    assert (settings.GRAPH_CACHE_DIR / CLEARED / name / "labels.label_hub.npy").exists()
    index = route_index(selectors.current_graph())
    assert isinstance(index.labels.label_cost.base, np.memmap)
    assert masked_files(settings) == {name}


def test_an_old_snapshot_without_files_gets_them_when_it_is_loaded(line, settings):
    snapshot = services.build_graph()
    shutil.rmtree(settings.GRAPH_CACHE_DIR)
    graph = selectors.graph_of_version(snapshot.version)
    assert isinstance(route_index(graph).labels.label_cost.base, np.memmap)
    assert travel_between(graph, [[Attachment(0, 0.0, 0.0)]], [[Attachment(1, 0.0, 0.0)]]).length_m[0, 0] > 0


@pytest.mark.parametrize("spoiled", [CLEARED, NETWORKS])
def test_broken_files_are_made_anew_from_what_is_not_broken(line, settings, monkeypatch, spoiled):
    """A broken network from the database, a broken graph from the network."""
    snapshot = services.build_graph()
    whole = graph_of_plans()
    for path in (settings.GRAPH_CACHE_DIR / spoiled).glob("*/position.npy"):
        content = bytearray(path.read_bytes())
        content[-1] ^= 1
        path.unlink()  # what is mapped stays as it is
        path.write_bytes(bytes(content))
    monkeypatch.setattr(graph_selectors, "_graphs", _MadeOnce())
    add_zone(9.1, 47.1, 9.2, 47.2)  # beside everything: another set of zones, the same graph
    for zones in (selectors.zones_in_force(), selectors.zones_in_force().where([])):
        again = graph_for(snapshot.version, zones)
        assert again.position.tobytes() == whole.position.tobytes()
        assert isinstance(again.position.base, np.memmap)


def graph_of_plans() -> InspectionGraph:
    ground = planning_read().ground()
    return ground.graph(ground.zones())


def test_a_saved_zone_is_in_force_before_there_is_a_new_snapshot(line):
    snapshot = services.build_graph()
    zone = add_zone(9.0015, 46.999, 9.0025, 47.001)
    graph = graph_of_plans()
    assert (graph.version, np.unique(graph.node_kind).tolist()) == (snapshot.version, [NodeKind.SUPPORT, NodeKind.BEND])
    assert graph.zone_id.tolist() == [zone.pk]


def test_a_snapshot_after_a_change_of_zones_has_the_network_of_before(line, settings):
    first = services.build_graph()
    add_zone(9.0015, 46.999, 9.0025, 47.001)
    second = services.build_graph()
    assert second.arrays_sha256 == first.arrays_sha256
    assert len(list((settings.GRAPH_CACHE_DIR / NETWORKS).iterdir())) == 1
    assert len(masked_files(settings)) == 2


def test_each_set_of_zones_has_its_graph(line):
    row = services.build_graph()
    west, east = (add_zone(lon - 0.0001, 46.999, lon + 0.0001, 47.001, name) for lon, name in ((9.0, "west"), (9.004, "east")))
    both = selectors.zones_in_force()
    graphs = [graph_for(row.version, both.where(chosen)) for chosen in ([0], [1], [])]
    assert [graph.zone_id.tolist() for graph in graphs] == [[west.pk], [east.pk], []]
    assert [graph.node_count for graph in graphs] == [2, 2, 3]
    assert graph_for(row.version, both.where([1])) is graphs[1]


def test_a_zone_above_what_is_flown_takes_nothing(line):
    """Towers of 30 m and untagged vertices of 45 m are passed at 60 m, at most 90 m with tolerance, twice, and margin."""
    row = services.build_graph()
    add_zone(9.0015, 46.999, 9.0025, 47.001)
    polygons = selectors.zones_in_force().polygons
    graphs = [graph_for(row.version, ZoneIndex(polygons, [1], ["Airfield"], floor_agl_m=[floor_m])) for floor_m in (90.0, 90.5)]
    assert [(graph.node_kind == NodeKind.LINE_VERTEX).sum() for graph in graphs] == [0, 1]


def test_a_snapshot_of_an_earlier_layout_is_no_graph_until_it_is_made_anew(line, settings):
    snapshot = services.build_graph()
    GraphSnapshot.objects.filter(pk=snapshot.pk).update(rules=asdict(settings.GRAPH_RULES), arrays=b"of another layout")
    with pytest.raises(selectors.NoGraph):
        selectors.current_graph()
    with pytest.raises(selectors.NoGraph):
        selectors.graph_of_version(snapshot.version)
    with pytest.raises(selectors.NoGraph):
        graph_of_plans()
    assert not selectors.ground_summary().graph_is_current
    tasks.refresh_graph()
    assert selectors.current_graph().node_count == graph_of_plans().node_count == 3
    assert selectors.ground_summary().graph_is_current


def test_of_threads_that_want_the_same_graph_one_makes_it():
    """And one that wants another is not held up: it comes back while the first is still being made."""
    kept, made = _MadeOnce(), []
    is_making, may_end = threading.Event(), threading.Event()

    def slowly():
        made.append("slow")
        is_making.set()
        may_end.wait()
        return GRAPH

    with ThreadPoolExecutor() as threads:
        first = threads.submit(kept.get, "slow", slowly)
        is_making.wait()
        second = threads.submit(kept.get, "slow", slowly)
        assert kept.get("other", lambda: OTHER) is OTHER
        assert not first.done()
        may_end.set()
        assert first.result() is second.result() is GRAPH
    assert made == ["slow"]


def test_a_graph_that_could_not_be_made_is_tried_again():
    kept = _MadeOnce()
    with pytest.raises(selectors.NoGraph):
        kept.get("key", fail)
    assert kept.get("key", lambda: GRAPH) is GRAPH


def fail() -> None:
    raise selectors.NoGraph


def test_the_graphs_used_last_are_kept_in_memory():
    kept = _MadeOnce()
    for number in range(KEPT):
        kept.get(number, lambda: GRAPH)
    assert kept.get(0, lambda: OTHER) is GRAPH
    kept.get("one more", lambda: GRAPH)
    assert [kept.get(number, lambda: OTHER) is GRAPH for number in (0, 1)] == [True, False]


def test_a_tower_too_tall_to_be_flown_over_is_left_out_of_the_stored_part(line, settings):
    Asset.objects.filter(osm_id=3).update(height_m=119.0)
    services.mark_ground_changed()
    services.build_graph()
    graph = selectors.current_graph()
    flyable = flyable_part(graph, settings.FLIGHT_RULES.tallest_m)
    assert (graph.node_count, flyable.node_count) == (3, 2)
    assert isinstance(flyable.position.base, np.memmap)
