"""Which ways make one bridge, and what polygon a bridge gets."""

import pytest
from shapely import Point

from inspection.importers.osm.reader import read_osm
from tests.inspection.imports.osm_files import write_osm

BRIDGE = {"highway": "primary", "bridge": "yes"}
#    a rectangle of about 152 m by 22 m, and ways along it
AREA = {1: (9.000, 47.0000, {}), 2: (9.002, 47.0000, {}), 3: (9.002, 47.0002, {}), 4: (9.000, 47.0002, {})}
OUTLINE = ([1, 2, 3, 4, 1], {"man_made": "bridge", "name": "Long Bridge"})


def bridges(path):
    return {(record.osm_type, record.osm_id): record for record in read_osm(path).records if record.kind == "bridge"}


def test_two_carriageways_on_one_area_are_one_bridge_that_keeps_their_tags(tmp_path):
    nodes = AREA | {5: (9.0, 47.00005, {}), 6: (9.002, 47.00005, {}), 7: (9.0, 47.00015, {}), 8: (9.002, 47.00015, {})}
    ways = {20: OUTLINE, 21: ([5, 6], BRIDGE | {"ref": "A1"}), 22: ([7, 8], BRIDGE | {"ref": "A1"})}
    found = bridges(write_osm(tmp_path / "a.osm", nodes, ways))
    assert list(found) == [("w", 20)]
    bridge = found["w", 20]
    assert (bridge.subtype, bridge.name, bridge.ref, [part["osm_id"] for part in bridge.parts]) == ("area", "Long Bridge", "A1", [21, 22])


def test_a_way_that_only_crosses_an_area_is_a_bridge_of_its_own(tmp_path):
    nodes = AREA | {5: (9.001, 46.999, {}), 6: (9.001, 47.001, {})}
    assert set(bridges(write_osm(tmp_path / "a.osm", nodes, {20: OUTLINE, 21: ([5, 6], BRIDGE)}))) == {("w", 20), ("w", 21)}


def test_a_multipolygon_with_split_outline_and_hole_is_an_area(tmp_path):
    hole = {5: (9.0009, 47.00008, {}), 6: (9.0011, 47.00008, {}), 7: (9.0011, 47.00012, {}), 8: (9.0009, 47.00012, {})}
    ways = {20: ([1, 2, 3], {}), 21: ([3, 4, 1], {}), 22: ([5, 6, 7, 8, 5], {})}
    relation = {30: ([("way", 21, "outer"), ("way", 20, "outer"), ("way", 22, "inner")], {"type": "multipolygon", "man_made": "bridge"})}
    found = bridges(write_osm(tmp_path / "a.osm", AREA | hole, ways, relation))
    assert list(found) == [("r", 30)]
    assert len(found["r", 30].geometry.interiors) == 1
    assert not found["r", 30].geometry.contains(Point(9.001, 47.0001))


@pytest.mark.parametrize(
    ("refs", "reason"),
    [([1, 2, 3, 4], "bridge_area_not_closed"), ([1, 2, 99, 3, 4, 1], "bridge_area_incomplete"), ([1, 3, 2, 4, 1], "bridge_area_invalid")],
)
def test_a_broken_area_is_counted_and_its_ways_stay_bridges(refs, reason, tmp_path):
    nodes = AREA | {5: (9.0, 47.0001, {}), 6: (9.002, 47.0001, {})}
    path = write_osm(tmp_path / "a.osm", nodes, {20: (refs, OUTLINE[1]), 21: ([5, 6], BRIDGE)})
    assert read_osm(path).counts["skipped"] == {reason: 1}
    assert set(bridges(path)) == {("w", 21)}


def test_a_lone_way_gets_a_polygon_of_its_width(tmp_path):
    nodes = {5: (9.0, 47.0, {}), 6: (9.0013156, 47.0, {})}  # 100 m
    found = bridges(write_osm(tmp_path / "a.osm", nodes, {21: ([5, 6], BRIDGE | {"width": "12"})}))
    west, south, east, north = found["w", 21].geometry.bounds
    assert (north - south) * 111_180 == pytest.approx(12.0, rel=0.002)  # metres to a degree of latitude at 47°
    assert (east - west) == pytest.approx(0.0013156, rel=1e-6)
    assert found["w", 21].centre == pytest.approx((9.0006578, 47.0), abs=1e-7)


def test_the_centre_of_a_bent_bridge_lies_on_it(tmp_path):
    nodes = {5: (9.0, 47.0, {}), 6: (9.002, 47.0, {}), 7: (9.002, 47.002, {})}
    bridge = bridges(write_osm(tmp_path / "a.osm", nodes, {21: ([5, 6, 7], BRIDGE)}))["w", 21]
    assert bridge.geometry.covers(Point(bridge.centre))
