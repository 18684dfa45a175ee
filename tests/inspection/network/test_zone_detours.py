"""Ways round zones: hand-worked cases, and against brute force over the corners of all zones."""

from itertools import combinations

import networkx as nx
import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry.base import BaseGeometry

from inspection.geodesy import distance_m, path_length_m
from inspection.network.zones.zone_detours import Errand, WayRound, ways_round
from inspection.network.zones.zone_index import ZoneIndex
from tests.exact_geometry import segment_meets_polygon
from tests.inspection.network.drawn_ground import Spot, lonlat, square, zone

CLEARANCE_M = 5.0
MAX_LENGTH_M = 10_000.0


def index(*polygons: BaseGeometry, **bands: list[float]) -> ZoneIndex:
    return ZoneIndex(list(polygons), range(len(polygons)), [f"zone {number}" for number in range(len(polygons))], **bands)


def errand(*spots: Spot, heights: tuple[float, float] | None = None) -> Errand:
    """From the first spot to each of the others."""
    places = np.array([lonlat(spot) for spot in spots])
    pairs = np.array([(0, other) for other in range(1, len(spots))])
    return Errand(places, pairs, *(heights or (None, None)))


def way(zones: ZoneIndex, start: Spot, end: Spot, longest_m: float = MAX_LENGTH_M, **flown: tuple[float, float]) -> WayRound | None:
    return ways_round(zones, [errand(start, end, **flown)], CLEARANCE_M, longest_m)[0][0]


def assert_clear(zones: ZoneIndex, found: WayRound, start: Spot, end: Spot) -> None:
    line = np.array([lonlat(start), *found.bend.tolist(), lonlat(end)])
    assert not zones.meets(line[:-1], line[1:], CLEARANCE_M).any()
    assert found.length_m == pytest.approx(path_length_m(line), abs=1e-6)
    for polygon in shapely.get_parts(zones.polygons):
        rings = [ring.coords for ring in (polygon.exterior, *polygon.interiors)]
        assert not any(segment_meets_polygon(*leg, rings) for leg in zip(line[:-1].tolist(), line[1:].tolist(), strict=True))


def test_a_leg_that_is_clear_has_no_bends():
    found = way(index(square((0.0, 500.0), 100.0)), (-300.0, 0.0), (400.0, 0.0))
    assert len(found.bend) == 0
    assert found.length_m == pytest.approx(700.0, abs=0.01)


def test_round_a_square_by_its_nearer_side():
    """A square of 200 m, its middle 40 m north of the leg: south round the corners at (-100, -60) and (100, -60), 5 m wider.

    From (-300, 0): 2 * |(195, 65)| + 210 = 2 * 205.55 + 210 = 621.1 m; corners stand out some centimetres more.
    """
    zones = index(square((0.0, 40.0), 100.0))
    found = way(zones, (-300.0, 0.0), (300.0, 0.0))
    assert_clear(zones, found, (-300.0, 0.0), (300.0, 0.0))
    assert len(found.bend) == 2
    assert (found.bend[:, 1] < lonlat((0.0, 0.0))[1]).all()
    assert found.length_m == pytest.approx(621.1, abs=0.5)


def test_round_two_squares_one_behind_the_other():
    """Squares of 200 m with middles at (-400, 60) and (400, -60): below the first, above the second, straight between them."""
    zones = index(square((-400.0, 60.0), 100.0), square((400.0, -60.0), 100.0))
    start, end = (-700.0, 0.0), (700.0, 0.0)
    found = way(zones, start, end)
    assert_clear(zones, found, start, end)
    corners = np.array([(-700.0, 0), (-505, -45), (-295, -45), (295, 45), (505, 45), (700, 0)])
    assert found.length_m == pytest.approx(np.hypot(*np.diff(corners, axis=0).T).sum(), abs=0.6)
    assert len(found.bend) == 4


def test_a_zone_that_only_the_way_round_meets_is_gone_round_too():
    """South of the square in the way lies another one, wide: the way leads north although it is longer than south without it."""
    zones = index(square((0.0, 40.0), 100.0), zone((-1_000.0, -500.0), (1_000.0, -500.0), (1_000.0, -65.0), (-1_000.0, -65.0)))
    start, end = (-300.0, 0.0), (300.0, 0.0)
    found = way(zones, start, end)
    assert_clear(zones, found, start, end)
    assert found.length_m == pytest.approx(2 * np.hypot(195.0, 145.0) + 210.0, abs=0.6)


def test_a_gap_wider_than_the_clearances_is_flown_through():
    wall = [zone((-50.0, north), (50.0, north), (50.0, north + 2_000.0), (-50.0, north + 2_000.0)) for north in (-2_020.0, 20.0)]
    zones, start, end = index(*wall), (-300.0, 300.0), (300.0, 300.0)
    found = way(zones, start, end)
    assert_clear(zones, found, start, end)
    assert found.length_m == pytest.approx(2 * np.hypot(245.0, 285.0) + 110.0, abs=1.0)


def test_a_way_longer_than_the_limit_is_none():
    zones = index(square((0.0, 40.0), 100.0))
    assert way(zones, (-300.0, 0.0), (300.0, 0.0), longest_m=622.0) is not None
    assert way(zones, (-300.0, 0.0), (300.0, 0.0), longest_m=620.0) is None


def test_no_way_leads_out_of_a_ring_or_a_zone():
    ring = shapely.Polygon(square((0.0, 0.0), 500.0).exterior.coords, [square((0.0, 0.0), 300.0).exterior.coords])
    assert way(index(ring), (0.0, 0.0), (2_000.0, 0.0)) is None
    assert way(index(square((0.0, 0.0), 100.0)), (0.0, 0.0), (500.0, 0.0)) is None
    inside = way(index(ring), (-200.0, 0.0), (200.0, 100.0))
    assert len(inside.bend) == 0


def test_a_way_out_of_a_horseshoe():
    """Open to the west; from inside it to a place east of it: out by the opening and round an arm."""
    shoe = zone((-300, -300), (300, -300), (300, 300), (-300, 300), (-300, 200), (200, 200), (200, -200), (-300, -200))
    zones, start, end = index(shoe), (0.0, 0.0), (600.0, 0.0)
    found = way(zones, start, end)
    assert_clear(zones, found, start, end)
    corners = np.array([(0.0, 0.0), (-305, 195), (-305, 305), (305, 305), (600, 0)])
    assert found.length_m == pytest.approx(np.hypot(*np.diff(corners, axis=0).T).sum(), abs=2.0)


def test_heights_decide_what_is_gone_round():
    zones = index(square((0.0, 40.0), 100.0), floor_agl_m=[100.0])
    assert len(way(zones, (-300.0, 0.0), (300.0, 0.0), heights=(40.0, 80.0)).bend) == 0
    assert len(way(zones, (-300.0, 0.0), (300.0, 0.0), heights=(40.0, 120.0)).bend) == 2
    assert len(way(zones, (-300.0, 0.0), (300.0, 0.0)).bend) == 2


def test_a_place_nearer_to_a_round_zone_than_its_coarse_outline():
    """A circle of 2 km in 256 corners is outlined in fewer; places 6 m from its edge are left and reached all the same."""
    angles = np.linspace(0, 2 * np.pi, 257)[:-1]
    zones = index(zone(*[(2_000 * np.cos(angle), 2_000 * np.sin(angle)) for angle in angles]))
    start, end = (-2_006.0, 0.0), (0.0, 2_006.0)
    found = way(zones, start, end)
    assert_clear(zones, found, start, end)
    assert found.length_m == pytest.approx(np.pi / 2 * 2_006.0, rel=0.02)


def test_a_small_bay_of_a_vast_zone_is_gone_round_as_closely_as_a_small_zone():
    """A wavy coast of 400 km in 1,601 corners, waves of 1 km every kilometre: from bay to bay over the crest, 500 m north."""
    coast = [(250.0 * number - 200_000.0, -500.0 * np.cos(np.pi * number / 2)) for number in range(1_601)]
    vast = zone(*coast, (200_000.0, -90_000.0), (-200_000.0, -90_000.0))
    zones, start, end = index(vast), (0.0, 0.0), (1_000.0, 0.0)
    found = ways_round(zones, [errand(start, end)], CLEARANCE_M, MAX_LENGTH_M)[0][0]
    line = np.array([lonlat(start), *found.bend.tolist(), lonlat(end)])
    assert not zones.meets(line[:-1], line[1:], CLEARANCE_M).any()
    assert found.length_m == pytest.approx(2 * np.hypot(500.0, 505.0), abs=60.0)


def test_a_zone_across_the_seam_is_not_gone_round():
    zones = index(shapely.box(179.9, -0.1, 180.0, 0.1), shapely.box(-180.0, -0.1, -179.9, 0.1))
    task = Errand(np.array([(179.85, 0.0), (-179.85, 0.0)]), np.array([(0, 1)]))
    assert ways_round(zones, [task], CLEARANCE_M, 100_000.0) == [[None]]


def test_nothing_asked_is_nothing_found():
    assert ways_round(index(square((0.0, 0.0), 10.0)), [], CLEARANCE_M, MAX_LENGTH_M) == []
    empty = Errand(np.zeros((0, 2)), np.zeros((0, 2), dtype=np.int64))
    assert ways_round(index(), [empty, errand((0.0, 0.0), (9.0, 0.0))], CLEARANCE_M, MAX_LENGTH_M)[0] == []


spot = st.tuples(st.integers(-40, 40), st.integers(-40, 40)).map(lambda place: (place[0] * 25.0, place[1] * 25.0))


@st.composite
def zones_apart(draw: st.DrawFn) -> list[BaseGeometry]:
    """Up to five polygons of few corners."""
    drawn = []
    for east, north in draw(st.lists(spot, min_size=1, max_size=5, unique=True)):
        corners = draw(st.integers(3, 6))
        radius_m = draw(st.integers(40, 400))
        turn = draw(st.floats(0, 1))
        angles = 2 * np.pi * (np.arange(corners) + turn) / corners
        drawn.append(zone(*[(east + radius_m * np.cos(angle), north + radius_m * np.sin(angle)) for angle in angles]))
    return drawn


@given(zones_apart(), st.lists(spot, min_size=2, max_size=4, unique=True))
@settings(max_examples=150)
def test_as_short_as_brute_force_and_clear(drawn, spots):
    """Brute force: all legs between all corners, stood off by 6 m, that shapely finds to be farther than 5.05 m from every zone."""
    zones = index(*drawn)
    found = ways_round(zones, [errand(*spots)], CLEARANCE_M, MAX_LENGTH_M)[0]
    for end, one in zip(spots[1:], found, strict=True):
        if one is not None:
            assert_clear(zones, one, spots[0], end)
        shortest_m = brute_force_m(drawn, spots[0], end)
        if np.isfinite(shortest_m):
            assert one is not None
            assert one.length_m <= shortest_m + 0.01


def brute_force_m(drawn: list[BaseGeometry], start: Spot, end: Spot) -> float:
    scale = np.array([111_319.0 * np.cos(np.radians(47.0)), 110_574.0])
    grown = [
        shapely.buffer(shapely.transform(polygon, lambda points: points * scale), by_m, join_style="mitre", mitre_limit=2.0)
        for by_m in (6.0, 7.0)
        for polygon in drawn
    ]
    obstacles, corners = grown[: len(drawn)], [tuple(place) for polygon in grown[len(drawn) :] for place in polygon.exterior.coords[:-1]]
    union = shapely.union_all(obstacles)
    places = [tuple(np.array(lonlat(place)) * scale) for place in (start, end)]
    if any(union.intersects(shapely.Point(place)) for place in places):
        return np.inf
    points = [*places, *corners]
    sight = nx.Graph()
    sight.add_nodes_from(range(len(points)))
    for (one, left), (other, right) in combinations(enumerate(points), 2):
        if not shapely.LineString([left, right]).intersects(union):
            ends = np.array([left]) / scale, np.array([right]) / scale
            sight.add_edge(one, other, weight=float(distance_m(*ends)[0]))
    try:
        return float(nx.dijkstra_path_length(sight, 0, 1))
    except nx.NetworkXNoPath:
        return np.inf


@given(zones_apart(), st.lists(spot, min_size=2, max_size=2, unique=True), st.data())
@settings(max_examples=60)
def test_fewer_zones_never_lengthen_a_way_round(drawn, spots, data):
    mask = np.array(data.draw(st.lists(st.booleans(), min_size=len(drawn), max_size=len(drawn))))
    zones = index(*drawn)
    more = way(zones, *spots)
    assume(more is not None)
    fewer = way(zones.where(mask), *spots)
    assert fewer is not None
    assert fewer.length_m <= more.length_m + 0.01
