"""Areas of bridges as pieces that flights pass above: nothing of a deck is far from a piece, and its height counts from its banks."""

import math
from dataclasses import replace
from hashlib import sha256
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from inspection.network.build.decks import OVER_BANKS_M, OVER_DECK_M, RING_M, Decks, decks
from inspection.network.build.network import Network, network
from inspection.network.infrastructure import BridgeOutlines
from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import LinkingRules
from inspection.network.snapshot_file import from_bytes, to_bytes
from inspection.network.spans import DECK, spans_between, spans_of
from inspection.scene.bridges import tall_share
from tests.inspection.network.drawn_ground import LAT, LON, ground, lonlat, places, zone

EAST_M = math.cos(math.radians(LAT)) * 111_320.0
LONG = zone((-100.0, -6.0), (100.0, -6.0), (100.0, 6.0), (-100.0, 6.0))


def outlines(*areas: shapely.Geometry, share: float = 0.0) -> BridgeOutlines:
    return BridgeOutlines(np.array(areas, dtype=object), np.full(len(areas), share))


def of_one(area: shapely.Geometry, height_m: float = math.nan, *, share: float = 0.0) -> Network:
    bridge = places([(0.0, 0.0)], first_asset=7, heights=[height_m])
    return network(replace(ground(bridges=bridge), bridge_outlines=outlines(area, share=share)), LinkingRules())


def tops_m(found: Decks, ground_m: Any) -> list[float]:
    """The tops of the bridges over a ground that is a function of metres east and north of the origin."""

    def heights_m(position: np.ndarray) -> np.ndarray:
        return np.array([ground_m(*((place - (LON, LAT)) * (EAST_M, 111_320.0))) for place in position])

    line = found.line
    spans = spans_between(line[:, 0], line[:, 1], np.zeros(len(line)), np.zeros(len(line)), None, found.bridge, found)
    return [float(spans.tops_m(np.flatnonzero(found.bridge == bridge)[:1], heights_m)[0, 0]) for bridge in range(len(found.centre))]


def of(*areas: shapely.Geometry, tagged_m: float = math.nan, share: float = 0.0) -> Decks:
    centres = np.array([area.centroid.coords[0] for area in areas])
    return decks(centres, np.full(len(areas), tagged_m), outlines(*areas, share=share))


def valley(east_m: float, _north_m: float) -> float:
    """Banks at 150 m above the sea, 90 m and more to both sides of a floor at 100 m."""
    return 150.0 if abs(east_m) > 90.0 else 100.0


def test_a_deck_counts_from_its_banks_and_from_the_ground_at_its_centre() -> None:
    assert tops_m(of(LONG), valley) == [150.0 + OVER_BANKS_M]
    assert tops_m(of(LONG), lambda east_m, north_m: 300.0 - valley(east_m, north_m)) == [200.0 + 30.0]
    assert tops_m(of(LONG, tagged_m=70.0), valley) == [170.0]
    assert tops_m(of(LONG, tagged_m=40.0), valley) == [150.0 + OVER_DECK_M]
    assert tops_m(of(LONG, tagged_m=6.0), valley) == [156.0]


def test_a_viaduct_that_is_mapped_in_parts_counts_from_the_banks_of_all() -> None:
    parts = [zone((x, -6.0), (x + 40.0, -6.0), (x + 40.0, 6.0), (x, 6.0)) for x in (-100.0, -60.0, -20.0, 20.0, 60.0)]
    assert tops_m(of(*parts), valley) == [150.0 + OVER_BANKS_M] * 5
    below = zone((-8.0, -80.0), (8.0, -80.0), (8.0, 80.0), (-8.0, 80.0))  # crosses under the middle one
    assert tops_m(of(parts[0], parts[2], below), valley)[2] == 130.0


@pytest.mark.parametrize(("radius_m", "corners"), [(200.0, 30), (1_500.0, 150)])
def test_bends_and_wide_bridges_count_from_their_highest_corner(radius_m: float, corners: int) -> None:
    bend = [(radius_m * math.cos(turn), radius_m * math.sin(turn)) for turn in np.linspace(0.0, math.pi / 2.0, corners)]
    ramp = shapely.Polygon([lonlat(place) for place in [*bend, *[(0.95 * x, 0.95 * y) for x, y in bend[::-1]]]])
    assert tops_m(of(ramp), lambda east_m, north_m: 160.0 if north_m < 1.0 else 100.0) == [180.0]
    assert tops_m(of(ramp), lambda east_m, north_m: 160.0 if east_m < 1.0 else 100.0) == [180.0]
    wide = zone((-16.0, -25.0), (16.0, -25.0), (16.0, 25.0), (-16.0, 25.0))
    assert tops_m(of(wide), lambda east_m, north_m: 150.0 if abs(east_m) > 15.0 else 100.0) == [170.0]


def test_unknown_ground_at_a_bank_is_not_passed_and_in_the_middle_does_not_matter() -> None:
    assert tops_m(of(LONG), lambda east_m, north_m: math.nan if abs(east_m) < 50.0 else 150.0) == [170.0]
    assert math.isnan(tops_m(of(LONG), lambda east_m, north_m: math.nan if east_m > 50.0 else 150.0)[0])


def test_pylons_of_unknown_height_are_a_share_of_the_longest_part() -> None:
    long = zone((-300.0, -9.0), (300.0, -9.0), (300.0, 9.0), (-300.0, 9.0))
    found = of_one(long, share=0.25)
    assert found.deck_over_banks_m.tolist() == pytest.approx([150.0], rel=0.01)
    assert found.node_height_m[found.node_kind == NodeKind.BRIDGE] == pytest.approx([150.0], rel=0.01)
    assert of_one(long, 40.0, share=0.25).deck_over_centre_m.tolist() == [40.0]
    far = shapely.MultiPolygon([LONG, zone((50_000.0, 0.0), (50_100.0, 0.0), (50_100.0, 9.0))])
    assert of_one(far, share=0.25).deck_over_banks_m.tolist() == pytest.approx([50.0], rel=0.02)
    assert tall_share([{"bridge:structure": "arch"}]) < tall_share([{"bridge:structure": "arch"}, {"bridge": "movable"}])
    assert tall_share([{"bridge:structure": "beam"}]) == 0.0


def test_what_has_no_area_is_left_to_its_node_and_nothing_hostile_stops_the_network() -> None:
    noisy = np.random.default_rng(1).normal((LON, LAT), 3e-4, (3_000, 2))
    areas = [
        shapely.from_wkt("POLYGON EMPTY"), shapely.from_wkt("MULTIPOLYGON EMPTY"), shapely.Point(LON, LAT), LONG,
        shapely.LineString([(LON, LAT), (LON + 0.001, LAT)]), shapely.Polygon(noisy), shapely.force_3d(LONG, 5.0),
        shapely.GeometryCollection([LONG, shapely.Point(LON, LAT)]),
    ]  # fmt: skip
    found = decks(np.tile((LON, LAT), (len(areas), 1)), np.full(len(areas), math.nan), outlines(*areas, share=0.25))
    assert len(found.centre) == 5
    assert len(found.line) < 3_000
    assert np.isfinite(found.line).all()


def test_decks_are_spans_that_nothing_is_inspected_below_and_survive_the_way_to_bytes() -> None:
    found = of_one(LONG)
    spans = spans_of(found)
    of_deck = spans.asset == DECK
    assert int(of_deck.sum()) == len(found.deck_line) == 4
    assert (spans.start[of_deck] == found.deck_line[:, 0]).all()
    assert (spans.bridge[of_deck] == 0).all()
    content = to_bytes(found)
    again = from_bytes(content, content_sha256=sha256(content).hexdigest())
    for name, array in found.decks._asdict().items():
        assert (getattr(again.decks, name) == array).all(), name


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(-260.0, 260.0), st.floats(-90.0, 90.0)), min_size=3, max_size=7, unique=True), st.booleans())
def test_no_place_of_a_deck_is_farther_from_a_piece_than_rings_lie_apart(corners: list[tuple[float, float]], has_hole: bool) -> None:
    area = shapely.MultiPoint([lonlat(corner) for corner in corners]).convex_hull
    if area.geom_type != "Polygon":
        return
    area = shapely.difference(area, zone((-100.0, -20.0), (100.0, -20.0), (100.0, 20.0), (-100.0, 20.0))) if has_hole else area
    if area.is_empty:
        return
    line = of(area).line
    metres = np.array([EAST_M, 111_320.0])
    pieces = shapely.union_all(shapely.linestrings((line - (LON, LAT)) * metres))
    west, south, east, north = area.bounds
    across, up = np.meshgrid(np.linspace(west, east, 40), np.linspace(south, north, 40))
    inside = np.column_stack([across.ravel(), up.ravel()])
    inside = inside[shapely.contains_xy(area, inside)]
    away_m = shapely.distance(shapely.points((inside - (LON, LAT)) * metres), pieces)
    assert float(away_m.max(initial=0.0)) <= RING_M * 1.05
