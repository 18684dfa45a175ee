"""The drawing of the demo region: how much there is, where it lies, and that nothing in it is left to chance."""

import hashlib
from collections import Counter
from collections.abc import Iterator
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import osmium
import pytest
import shapely

from inspection.demo_region import BASES, DemoRegion, make_region, write_osm_file
from inspection.demo_region.osm_file import FIRST_ID, OsmWay
from inspection.demo_region.place import METRES_PER_DEG_LAT, METRES_PER_DEG_LON
from inspection.geodesy import LonLat, distance_m

SUPPORTS = {"tower", "pole", "portal"}


@pytest.fixture(scope="module")
def region() -> DemoRegion:
    return make_region()


@pytest.fixture(scope="module")
def positions(region: DemoRegion) -> dict[int, LonLat]:
    return {node.id: node.position for node in region.osm.nodes}


def path_of(way: OsmWay, positions: dict[int, LonLat]) -> shapely.LineString:
    return shapely.LineString([positions[node_id] for node_id in way.node_ids])


def flown_lines(region: DemoRegion) -> Iterator[OsmWay]:
    return (way for way in region.osm.ways if way.tags.get("power") in {"line", "minor_line"} and "line" not in way.tags)


def zone_shapes(region: DemoRegion) -> dict[str, shapely.Polygon]:
    return {feature["name"]: shape_of(feature["geometry"][0]["horizontalProjection"]) for feature in region.zones["features"]}


def shape_of(projection: dict[str, Any]) -> shapely.Polygon:
    if projection["type"] == "Polygon":
        return shapely.Polygon(projection["coordinates"][0])
    (lon, lat), radius_m = projection["center"], projection["radius"]
    return shapely.Polygon(
        [
            (lon + radius_m * cos(turn) / METRES_PER_DEG_LON, lat + radius_m * sin(turn) / METRES_PER_DEG_LAT)
            for turn in np.arange(72) * pi / 36
        ]
    )


def sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.long
@pytest.mark.parametrize("seed", [20_260, 1, 2])
def test_about_3000_supports_60_bridges_2_railways_and_8_zones_from_any_seed(seed: int) -> None:
    counts = make_region(seed).counts()
    assert 2_700 <= counts["supports"] <= 3_300
    assert counts["railways"] == 2
    assert counts["zones"] == 8
    assert counts["bridge_areas"] >= 5


def test_ways_on_a_bridge_area_and_lone_bridge_ways_make_60_bridges(region: DemoRegion, positions: dict[int, LonLat]) -> None:
    areas = [shapely.Polygon(path_of(way, positions)) for way in region.osm.ways if way.tags.get("man_made") == "bridge"]
    decks = [path_of(way, positions) for way in region.osm.ways if "bridge" in way.tags]
    ways_on_area = Counter(index for deck in decks for index, area in enumerate(areas) if area.covers(deck))
    lone = [deck for deck in decks if not any(area.intersects(deck) for area in areas)]
    assert len(lone) + len(areas) == 60
    assert sum(ways_on_area.values()) + len(lone) == len(decks), "each way lies wholly on one area or touches none"
    assert set(ways_on_area) == set(range(len(areas)))
    assert min(ways_on_area.values()) >= 2


def test_bridge_areas_are_valid_polygons(region: DemoRegion, positions: dict[int, LonLat]) -> None:
    areas = [shapely.Polygon(path_of(way, positions)) for way in region.osm.ways if way.tags.get("man_made") == "bridge"]
    assert all(area.is_valid for area in areas)


def test_lines_have_every_voltage_and_a_line_of_two_voltages(region: DemoRegion) -> None:
    assert {way.tags["voltage"] for way in flown_lines(region)} == {"400000", "132000", "66000", "20000", "132000;66000"}


def test_20_kv_is_minor_line_on_poles(region: DemoRegion) -> None:
    tags = {node.id: node.tags for node in region.osm.nodes}
    minor = [way for way in flown_lines(region) if way.tags["power"] == "minor_line"]
    assert {way.tags["voltage"] for way in minor} == {"20000"}
    assert {tags[node_id].get("power") for way in minor for node_id in way.node_ids} == {"pole", None}


def test_11_to_21_percent_of_line_nodes_are_not_tagged_as_a_support(region: DemoRegion) -> None:
    supports = {node.id for node in region.osm.nodes if node.tags.get("power") in SUPPORTS}
    on_lines = {node_id for way in flown_lines(region) for node_id in way.node_ids}
    assert 0.11 <= 1 - len(on_lines & supports) / len(on_lines) <= 0.21


@pytest.mark.parametrize(("voltage", "shortest_m", "longest_m"), [("400000", 250, 400), ("20000", 35, 85)])
def test_spans_are_as_long_as_the_voltage_makes_them(
    region: DemoRegion, positions: dict[int, LonLat], voltage: str, shortest_m: float, longest_m: float
) -> None:
    spans = []
    for way in flown_lines(region):
        if way.tags["voltage"] == voltage:
            points = np.array([positions[node_id] for node_id in way.node_ids])
            spans.extend(distance_m(points[:-1], points[1:]))
    assert shortest_m <= np.quantile(spans, 0.05)
    assert np.quantile(spans, 0.95) <= longest_m


def test_branch_lines_start_on_a_pole_of_their_trunk(region: DemoRegion) -> None:
    uses = Counter(node_id for way in flown_lines(region) for node_id in way.node_ids)
    assert sum(count > 1 for count in uses.values()) >= 10


def test_each_zone_lies_over_a_line_or_railway(region: DemoRegion, positions: dict[int, LonLat]) -> None:
    ways = [*flown_lines(region), *(way for way in region.osm.ways if way.tags.get("railway") == "rail")]
    network = shapely.MultiLineString([path_of(way, positions) for way in ways])
    idle = [name for name, shape in zone_shapes(region).items() if not network.intersects(shape)]
    assert idle == []


def test_bases_stand_clear_of_zones_and_near_a_line(region: DemoRegion, positions: dict[int, LonLat]) -> None:
    zones = shapely.MultiPolygon(list(zone_shapes(region).values()))
    line_nodes = np.array([positions[node_id] for way in flown_lines(region) for node_id in way.node_ids])
    for base in BASES:
        assert zones.distance(shapely.Point(base.position)) * METRES_PER_DEG_LON > 500
        assert distance_m(np.tile(base.position, (len(line_nodes), 1)), line_nodes).min() < 1_000


def test_two_bases_have_two_uavs_each_with_names_of_their_own() -> None:
    assert [len(base.uavs) for base in BASES] == [2, 2]
    assert len({uav.name for base in BASES for uav in base.uavs}) == 4


def test_terrain_covers_all_that_is_drawn(region: DemoRegion) -> None:
    terrain = region.terrain
    rows, columns = terrain.heights_amsl_m.shape
    points = np.array([node.position for node in region.osm.nodes])
    west, south = points.min(axis=0)
    east, north = points.max(axis=0)
    assert terrain.west_deg < west
    assert terrain.north_deg > north
    assert terrain.west_deg + columns * terrain.step_deg > east
    assert terrain.north_deg - rows * terrain.step_deg < south


def test_terrain_has_hills_without_cliffs(region: DemoRegion) -> None:
    heights = region.terrain.heights_amsl_m
    assert np.isfinite(heights).all()
    assert heights.max() - heights.min() > 300
    assert np.abs(np.diff(heights, axis=0)).max() < 60, "under 45 degrees over a cell of 62 m"


@pytest.mark.long
def test_the_same_seed_writes_the_same_file_and_another_seed_another(tmp_path: Path) -> None:
    paths = [tmp_path / f"{index}.osm.pbf" for index in range(3)]
    for path, seed in zip(paths, [7, 7, 8], strict=True):
        write_osm_file(path, make_region(seed).osm)
    assert sha256(paths[0]) == sha256(paths[1])
    assert sha256(paths[0]) != sha256(paths[2])


def test_the_file_says_that_it_is_synthetic_and_keeps_its_ids_away_from_osms(region: DemoRegion, tmp_path: Path) -> None:
    path = tmp_path / "demo.osm.pbf"
    write_osm_file(path, region.osm)
    with osmium.io.Reader(str(path)) as reader:
        assert reader.header().get("generator") == "Spanwise synthetic demo region"
    ids = [thing.id for thing in osmium.FileProcessor(str(path))]
    assert len(ids) == len(region.osm.nodes) + len(region.osm.ways)
    assert min(ids) == FIRST_ID
    assert max(ids) < 2**53
