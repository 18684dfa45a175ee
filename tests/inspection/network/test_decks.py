"""Areas of bridges as pieces that flights pass above: nothing of a deck is far from a piece, and its height counts from its banks."""

import math
from dataclasses import replace
from hashlib import sha256

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from inspection.network.build.decks import OVER_DECK_M, PYLON_SHARE, RING_M, decks
from inspection.network.build.network import Network, network
from inspection.network.infrastructure import BridgeOutlines
from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import LinkingRules
from inspection.network.snapshot_file import from_bytes, to_bytes
from inspection.network.spans import DECK, spans_of
from tests.inspection.network.drawn_ground import LAT, LON, ground, lonlat, places, zone

EAST_M = math.cos(math.radians(LAT)) * 111_320.0
LONG = zone((-100.0, -6.0), (100.0, -6.0), (100.0, 6.0), (-100.0, 6.0))


def outlines(area: shapely.Geometry, *, is_tall: bool = False) -> BridgeOutlines:
    return BridgeOutlines(np.array([area], dtype=object), np.array([is_tall]))


def of_one(area: shapely.Geometry, height_m: float = math.nan, *, is_tall: bool = False) -> Network:
    bridge = places([(0.0, 0.0)], first_asset=7, heights=[height_m])
    return network(replace(ground(bridges=bridge), bridge_outlines=outlines(area, is_tall=is_tall)), LinkingRules())


def heights_by_place(found: Network) -> dict[str, float]:
    """The height over the ground at the centre and at both ends."""
    east_m = np.round((found.deck_ground[:, 0] - LON) * EAST_M).astype(int)
    return {name: float(found.deck_height_m[abs(east_m - at) <= 1].max()) for name, at in (("west", -100), ("centre", 0), ("east", 100))}


def test_a_deck_without_a_stated_height_is_30_m_over_the_ground_at_its_centre_and_its_ends():
    found = of_one(LONG)
    assert heights_by_place(found) == {"west": 30.0, "centre": 30.0, "east": 30.0}
    assert len(found.deck_line) == 3 * 4


def test_a_stated_height_counts_from_the_centre_and_the_traffic_from_the_ends():
    assert heights_by_place(of_one(LONG, 70.0)) == {"west": OVER_DECK_M, "centre": 70.0, "east": OVER_DECK_M}
    assert heights_by_place(of_one(LONG, 6.0)) == {"west": 6.0, "centre": 6.0, "east": 6.0}


def test_pylons_of_unknown_height_are_a_quarter_of_the_length_everywhere():
    long = zone((-300.0, -9.0), (300.0, -9.0), (300.0, 9.0), (-300.0, 9.0))
    found = of_one(long, is_tall=True)
    assert np.unique(found.deck_height_m).tolist() == pytest.approx([PYLON_SHARE * 600.0], rel=0.01)
    assert found.node_height_m[found.node_kind == NodeKind.BRIDGE] == pytest.approx([PYLON_SHARE * 600.0], rel=0.01)
    assert np.unique(of_one(long, 40.0, is_tall=True).deck_height_m).tolist() == [OVER_DECK_M, 40.0]


def test_decks_are_spans_that_nothing_is_inspected_below_and_survive_the_way_to_bytes():
    found = of_one(LONG)
    spans = spans_of(found)
    of_deck = spans.asset == DECK
    assert int(of_deck.sum()) == len(found.deck_line)
    assert (spans.start[of_deck] == found.deck_line[:, 0]).all()
    assert (spans.start_ground[of_deck] == found.deck_ground).all()
    content = to_bytes(found)
    again = from_bytes(content, content_sha256=sha256(content).hexdigest())
    assert (again.deck_line == found.deck_line).all()
    assert (again.deck_height_m == found.deck_height_m).all()


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(-260.0, 260.0), st.floats(-90.0, 90.0)), min_size=3, max_size=7, unique=True))
def test_no_place_of_a_deck_is_farther_from_a_piece_than_flights_keep(corners: list[tuple[float, float]]) -> None:
    area = shapely.MultiPoint([lonlat(corner) for corner in corners]).convex_hull
    if area.geom_type != "Polygon":
        return
    line, over, height_m = decks(np.array([lonlat((0.0, 0.0))]), np.array([math.nan]), outlines(area))
    assert len(line) == len(over) == len(height_m)
    metres = np.array([EAST_M, 111_320.0])
    pieces = shapely.union_all(shapely.linestrings((line - (LON, LAT)) * metres))
    west, south, east, north = area.bounds
    across, up = np.meshgrid(np.linspace(west, east, 40), np.linspace(south, north, 40))
    inside = np.column_stack([across.ravel(), up.ravel()])
    inside = inside[shapely.contains_xy(area, inside)]
    away_m = shapely.distance(shapely.points((inside - (LON, LAT)) * metres), pieces)
    assert float(away_m.max(initial=0.0)) <= RING_M * 1.01
