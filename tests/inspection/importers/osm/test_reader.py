"""From an OSM file to asset records."""

import gzip
import json

import numpy as np
import pytest
from shapely import Point

from inspection.geodesy.wgs84 import path_length_m
from inspection.importers.osm.file_validator import OsmFileError
from inspection.importers.osm.reader import read_osm
from tests.inspection.imports.osm_files import TOWER, osm_xml, small_line, write_osm

# Of the generated regions as drawn, counted without the reader; of the real files the table in the README of the shared data.
# Kilometres to one decimal.
COUNTS = {
    "elme-valley.osm.pbf": {"tower": 887, "pole": 2_135, "portal": 43, "line": 36, "minor_line": 43, "railway": 40, "bridge_ways": 72,
        "railway_bridge_ways": 19, "bridge_areas": 9, "line_km": 240.5, "minor_line_km": 146.5, "railway_km": 55.7},
    "quillmoor.osm.pbf": {"tower": 335, "pole": 128, "portal": 3, "line": 18, "minor_line": 3, "railway": 59, "bridge_ways": 50,
        "railway_bridge_ways": 9, "bridge_areas": 7, "missing_nodes": 109, "line_km": 125.0, "minor_line_km": 10.5, "railway_km": 100.9,
        "skipped": {"bridge_area_incomplete": 1, "line_too_few_nodes": 1}},
    "liechtenstein-2021-infra.osm.pbf": {"tower": 170, "pole": 17, "line": 11, "minor_line": 4, "railway": 34, "bridge_ways": 301,
        "railway_bridge_ways": 15, "bridge_areas": 1, "line_km": 48.5, "minor_line_km": 1.0, "railway_km": 10.9},
    "liechtenstein-2021.osm.pbf": {"tower": 170, "pole": 17, "line": 11, "minor_line": 4, "railway": 34, "bridge_ways": 301,
        "railway_bridge_ways": 15, "bridge_areas": 1, "line_km": 48.5, "minor_line_km": 1.0, "railway_km": 10.9},
    "columbus-ohio.osm.pbf": {"tower": 261, "pole": 314, "line": 26, "minor_line": 1, "railway": 815, "bridge_ways": 622,
        "railway_bridge_ways": 115, "line_km": 96.8, "minor_line_km": 0.9, "railway_km": 520.9},
    "nepal-power-2025.osm.pbf": {"tower": 10_428, "line": 466, "line_km": 3_895.9},
    "roenne-bornholm-2015.osm.gz": {"tower": 66, "line": 1, "line_km": 11.0},
    "copenhagen-rail-2015.osm.gz": {"railway": 165, "bridge_ways": 47, "railway_bridge_ways": 7, "railway_km": 49.1},
    "funen-power-nodes-2019.osm.pbf": {"tower": 3_009, "pole": 7, "portal": 18},
}  # fmt: skip
COUNTED = (
    "tower",
    "pole",
    "portal",
    "line",
    "minor_line",
    "railway",
    "bridge_ways",
    "railway_bridge_ways",
    "bridge_areas",
    "missing_nodes",
)


@pytest.mark.parametrize("name", COUNTS)
def test_counts_of_a_region_are_those_that_are_known(name, region_file):
    expected = COUNTS[name]
    content = read_osm(region_file(name))
    assert {key: content.counts[key] for key in COUNTED} == {key: expected.get(key, 0) for key in COUNTED}
    for key in ("line_km", "minor_line_km", "railway_km"):
        assert content.counts[key] == pytest.approx(expected.get(key, 0.0), rel=0.005, abs=0.05)
    assert content.counts["skipped"] == expected.get("skipped", {})


@pytest.mark.parametrize(
    ("name", "west", "east"),
    [("elme-valley.osm.pbf", 26.4, 26.8), ("quillmoor.osm.pbf", 25.88, 26.13), ("columbus-ohio.osm.pbf", -83.4, -82.7)],
)
def test_every_record_of_a_region_is_sound(name, west, east, region_file):
    content = read_osm(region_file(name))
    assert len({record.key for record in content.records}) == len(content.records)
    for record in content.records:
        assert record.geometry.is_valid
        assert west < record.centre.lon < east
        if record.kind in {"line", "railway"}:
            points = np.array(record.geometry.coords)
            assert len(record.node_osm_ids) == len(points)
            assert record.length_m == pytest.approx(path_length_m(points), abs=1e-3)
            assert record.geometry.distance(Point(record.centre)) < 1e-9
        if record.kind == "bridge":
            assert record.geometry.geom_type == "Polygon"
            assert record.geometry.area > 0


@pytest.mark.parametrize(
    ("name", "ways_on_areas"),
    [
        ("elme-valley.osm.pbf", [2, 2, 2, 3, 3, 3, 2, 2, 2]),
        ("quillmoor.osm.pbf", [6, 2, 1, 3, 3, 0]),
        ("liechtenstein-2021-infra.osm.pbf", [1]),
    ],
)
def test_ways_on_a_bridge_area_are_one_bridge(name, ways_on_areas, region_file):
    content = read_osm(region_file(name))
    areas = [record for record in content.records if record.subtype == "area"]
    assert [len(area.parts) for area in sorted(areas, key=lambda area: area.osm_id)] == ways_on_areas
    on_areas = {part["osm_id"] for area in areas for part in area.parts}
    assert not on_areas & {record.osm_id for record in content.records if record.kind == "bridge" and record.subtype == "way"}
    assert content.counts["bridge"] == content.counts["bridge_ways"] + len(areas) - len(on_areas)


def test_a_track_on_a_bridge_is_a_railway_and_a_bridge(tmp_path):
    nodes = {1: (9.0, 47.0, {}), 2: (9.001, 47.0, {})}
    content = read_osm(write_osm(tmp_path / "a.osm", nodes, {5: ([1, 2], {"railway": "rail", "bridge": "yes"})}))
    assert [record.key for record in content.records] == [("railway", "w", 5), ("bridge", "w", 5)]


def test_all_raw_tags_are_kept_and_typed_values_stand_beside_them(tmp_path):
    tags = {
        "power": "line",
        "voltage": "220000;110000",
        "circuits": "2",
        "operator": "Net <AG>",
        "ref": "7",
        "name": "Süd",
        "wires": "quad",
    }
    nodes = {1: (9.0, 47.0, {"power": "tower", "height": "45 m", "design": "donau"}), 2: (9.01, 47.0, {"power": "terminal"})}
    tower, line = read_osm(write_osm(tmp_path / "a.osm", nodes, {5: ([1, 2], tags)})).records
    assert line.tags == tags
    assert (line.voltages_v, line.circuits, line.operator, line.ref, line.name) == ((220_000, 110_000), 2, "Net <AG>", "7", "Süd")
    assert (tower.height_m, tower.tags["design"]) == (45.0, "donau")


def test_missing_nodes_are_counted_and_the_way_keeps_the_others(tmp_path):
    nodes, ways = small_line(without={3})
    content = read_osm(write_osm(tmp_path / "a.osm", nodes, {10: ([1, 2, 3, 4], ways[10][1])}))
    line = content.records[-1]
    assert (content.counts["missing_nodes"], content.counts["line"], line.node_osm_ids) == (1, 1, (1, 2, 4))


def test_a_way_with_fewer_than_two_nodes_is_skipped_with_its_reason(tmp_path):
    ways = {10: ([1, 7, 8], {"power": "line"}), 11: ([1, 1], {"railway": "rail"})}
    content = read_osm(write_osm(tmp_path / "a.osm", {1: (9.0, 47.0, TOWER)}, ways))
    assert content.counts["skipped"] == {"line_too_few_nodes": 1, "railway_without_length": 1}
    assert (content.counts["line"], content.counts["railway"], len(content.records)) == (1, 1, 1)


def test_kin_of_rail_are_counted_under_their_own_keys(tmp_path):
    nodes = {1: (9.0, 47.0, {}), 2: (9.01, 47.0, {})}
    kinds = ["rail", "tram", "light_rail", "abandoned", "platform"]
    content = read_osm(write_osm(tmp_path / "a.osm", nodes, {index: ([1, 2], {"railway": kind}) for index, kind in enumerate(kinds, 1)}))
    counts = content.counts
    assert (counts["railway"], counts["tram"], counts["light_rail"], counts["railway_abandoned"]) == (1, 1, 1, 1)
    assert [(record.subtype, record.is_flyable) for record in content.records] == [
        ("rail", True), ("tram", True), ("light_rail", True), ("abandoned", False),
    ]  # fmt: skip


def test_objects_in_any_order_and_packed_give_the_same_records(tmp_path):
    nodes, ways = small_line()
    plain = read_osm(write_osm(tmp_path / "a.osm", nodes, ways))
    packed = tmp_path / "a.osm.gz"
    packed.write_bytes(gzip.compress(osm_xml(dict(reversed(nodes.items())), ways).encode()))
    assert {record.content_hash for record in read_osm(packed).records} == {record.content_hash for record in plain.records}


def test_overpass_json_gives_the_same_records_as_xml(tmp_path):
    nodes, ways = small_line()
    elements = [{"type": "way", "id": key, "nodes": refs, "tags": tags} for key, (refs, tags) in ways.items()]
    elements += [{"type": "node", "id": key, "lon": lon, "lat": lat, "tags": tags} for key, (lon, lat, tags) in nodes.items()]
    path = tmp_path / "answer.json"
    path.write_text(json.dumps({"version": 0.6, "osm3s": {"timestamp_osm_base": "2026-01-02T03:04:05Z"}, "elements": elements}))
    content = read_osm(path)
    plain = read_osm(write_osm(tmp_path / "a.osm", nodes, ways))
    assert content.data_timestamp == "2026-01-02T03:04:05Z"
    assert {record.content_hash for record in content.records} == {record.content_hash for record in plain.records}


def test_overpass_ways_with_their_geometry_need_no_nodes(tmp_path):
    way = {
        "type": "way",
        "id": 3,
        "nodes": [1, 2],
        "geometry": [{"lat": 47.0, "lon": 9.0}, {"lat": 47.0, "lon": 9.01}],
        "tags": {"power": "line"},
    }
    path = tmp_path / "answer.json"
    path.write_text(json.dumps({"elements": [way]}))
    assert read_osm(path).counts["line_km"] == pytest.approx(0.761, abs=0.001)


def test_objects_without_a_real_osm_id_and_deleted_ones_are_counted(tmp_path):
    text = osm_xml({-1: (9.0, 47.0, TOWER), 5: (9.0, 47.0, TOWER)})
    path = tmp_path / "a.osm"
    path.write_text(text.replace("</osm>", '<node id="6" visible="false" lon="9" lat="47"><tag k="power" v="tower"/></node></osm>'))
    content = read_osm(path)
    assert ([record.osm_id for record in content.records], content.counts["skipped"]) == ([5], {"deleted": 1, "without_osm_id": 1})


def test_a_node_off_the_earth_is_counted_and_no_tower(tmp_path):
    content = read_osm(write_osm(tmp_path / "a.osm", {1: (9.0, 91.0, TOWER), 2: (9.0, 47.0, TOWER)}))
    assert ([record.osm_id for record in content.records], content.counts["skipped"]) == ([2], {"node_not_on_earth": 1})


@pytest.mark.parametrize(
    "text",
    [
        "",
        "AAAA",
        "<osm",
        "<kml/>",
        '<osm version="0.6"><node id="1" lat="x" lon="1"/></osm>',
        '<!DOCTYPE a [<!ENTITY b "c">]><osm version="0.6">&b;</osm>',
        '{"elements": [{"type": "node", "id": 1, "lat": NaN, "lon": 1}]}',
        '{"elements": [{"type": "node", "id": 1, "lat": 1e999, "lon": 1}]}',
        '{"elements": [{"type": "node", "id": 1, "lat": 95, "lon": 1}]}',
        '{"elements": [{"type": "node", "id": true, "lat": 5, "lon": 1}]}',
        '{"elements": [' + '{"a":' * 20_000,
        '{"elements": {}}',
        '{"no": 1}',
        '{"elements": [{"type": "node", "id": 1, "lat": 1, "lon": 1}',
    ],
)
def test_a_file_that_is_no_osm_data_is_refused_with_a_sentence(text, tmp_path):
    path = tmp_path / "a.osm"
    path.write_text(text)
    with pytest.raises(OsmFileError, match=r"[A-Za-z]{3,}"):
        read_osm(path)
