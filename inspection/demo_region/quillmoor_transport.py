"""Railways, roads and bridges of Quillmoor: a marshalling yard, parallel tracks, and bridges that carry several ways on one outline."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from inspection.demo_region.curves import distance_along, offset_path, piece_of, smooth_path
from inspection.demo_region.layout import km
from inspection.demo_region.osm_objects import OsmDrawing, Tags
from inspection.demo_region.place import FloatArray, Point

RAILWAY_NAME = "Quillmoor Line"
YARD_TRACKS = 30
TRACK_SPACING_M = 4.6
LADDER_STEP_M = 27.6  # along the yard from one switch to the next: the ladder leaves it at 1 in 6
YARD_HALF_M = 1_100.0  # of the longest track
YARD_NORTH_M = -9.0
MAIN_TRACKS_M = (2.3, -2.3)
TURNOUT_M = 1_300.0  # from the middle of the yard to where its leads join the main line
BRANCH_M = 6_000.0  # where the branch leaves the main line
MAIN_LINE = {"railway": "rail", "usage": "main", "name": RAILWAY_NAME, "electrified": "contact_line", "voltage": "25000"}
SIDING = {"railway": "rail", "service": "yard", "name": "Quillmoor Yard"}
RIVER = smooth_path(km((2.5, 9), (3, 5), (4, 1.5), (4, -1.5), (5.5, -5), (5, -9)))


@dataclass(frozen=True, eq=False)
class Deck:
    """One way of a bundle: how far it lies to the left of the bundle's path, and its tags."""

    offset_m: float
    tags: Tags


@dataclass(frozen=True)
class Bridge:
    """A bridge of a bundle: the middle and half the length of its decks; named bridges have an outline."""

    middle: Point
    half_m: float
    name: str = ""
    sides_m: tuple[float, float] = (0.0, 0.0)  # of the outline: to the left and to the right of the path


def draw_transport(drawing: OsmDrawing) -> None:
    drawing.add_path(RIVER, {"waterway": "river", "name": "Quill", "width": "60"})
    _draw_railways(drawing)
    _draw_roads(drawing)
    _draw_border_bridge(drawing)


def _draw_railways(drawing: OsmDrawing) -> None:
    main = smooth_path(km((-14, -1.4), (-9, 0), (-8, 0), (8, 0), (9, 0), (14, 1.6)))
    bridges = [Bridge((4_000.0, 0.0), 120.0), Bridge((-7_000.0, 0.0), 13.0), Bridge((-4_000.0, 0.0), 9.0), Bridge((7_600.0, 0.0), 10.0)]
    splits = [(-TURNOUT_M, 0.0), (TURNOUT_M, 0.0), (BRANCH_M, 0.0)]
    tracks = _draw_bundle(drawing, main, [Deck(offset_m, MAIN_LINE) for offset_m in MAIN_TRACKS_M], bridges, splits)
    northern, southern = tracks
    _draw_yard(drawing, southern[splits[0]], southern[splits[1]])
    branch = smooth_path(km((6, 0.0023), (6.8, 0.3), (7.4, 2.2), (9.6, 9)))
    single = Deck(0.0, MAIN_LINE | {"usage": "branch"})
    _draw_bundle(drawing, branch, [single], [Bridge((7_550.0, 2_700.0), 11.0)], starts=[northern[splits[2]]])
    out_of_use = [np.array(point) for point in km((-6.5, -0.4), (-5.8, -1.4), (-5.9, -3))]
    drawing.add_path(out_of_use, {"railway": "disused", "name": RAILWAY_NAME})
    drawing.add_path([np.array(point) for point in km((2.2, 0.6), (2.4, 1.3), (2.1, 2.4))], {"railway": "tram"})


def _draw_yard(drawing: OsmDrawing, west_turnout: int, east_turnout: int) -> None:
    """Draw the tracks between two ladders, each a way from switch to switch; the ladders lead to the main line."""
    ends: dict[int, list[int]] = {-1: [], 1: []}
    for number in range(YARD_TRACKS):
        north_m, half_m = YARD_NORTH_M - TRACK_SPACING_M * number, YARD_HALF_M - LADDER_STEP_M * number
        for side, switches in ends.items():
            switches.append(drawing.add_node((side * half_m, north_m), {"railway": "switch"}))
        between = [drawing.add_node((share * half_m, north_m)) for share in (-0.3, 0.3)]
        drawing.add_way([ends[-1][-1], *between, ends[1][-1]], SIDING | {"railway:track_ref": str(number % 10 + 1)})
    for turnout, switches in ((west_turnout, ends[-1]), (east_turnout, ends[1])):
        drawing.add_way([turnout, *switches], SIDING)


def _draw_roads(drawing: OsmDrawing) -> None:
    """Draw a dual carriageway beside the railway, with which it shares the river bridge, and three more roads."""
    carriageway = {"highway": "primary", "oneway": "yes", "lanes": "2", "name": "Harbour Road"}
    decks = [Deck(5.0, carriageway), Deck(-5.0, carriageway), Deck(12.0, {"highway": "cycleway"}), Deck(-12.0, {"highway": "footway"})]
    harbour = smooth_path(km((-14, 0.9), (-4, 0.6), (2.2, 0.024), (3, 0.024), (5, 0.024), (5.6, 0.024), (9, 0.5), (14, 0.3)))
    harbour_bridge = Bridge((4_000.0, 24.0), 120.0, "Harbour Bridge", sides_m=(17.0, -32.0))
    _draw_bundle(drawing, harbour, decks, [harbour_bridge, Bridge((-7_500.0, 700.0), 10.0), Bridge((9_200.0, 500.0), 8.0)])

    north = smooth_path(km((-14, 6), (-5, 5.4), (3, 5.2), (8, 5.9), (14, 5.5)))
    tertiary = Deck(0.0, {"highway": "tertiary", "name": "Mill Road"})
    mill_bridge = Bridge((2_960.0, 5_300.0), 48.0, "Mill Bridge", sides_m=(8.0, -7.0))
    streams = [Bridge((east, 5_600.0), 6.0 + number) for number, east in enumerate((-10_500.0, -6_200.0, -500.0, 6_900.0, 10_600.0))]
    _draw_bundle(drawing, north, [tertiary, Deck(5.5, {"highway": "footway"})], [mill_bridge, *streams])

    south = smooth_path(km((-14, -5), (-6, -5.6), (0, -5), (5.4, -5.2), (9, -4.6), (14, -6)))
    mill_bridge = Bridge((5_450.0, -5_100.0), 50.0, "Mill Bridge", sides_m=(6.0, -6.0))
    streams = [Bridge((east, -5_200.0), 7.0) for east in (-11_000.0, -8_200.0, -3_000.0, 1_100.0, 7_800.0, 11_300.0)]
    _draw_bundle(drawing, south, [tertiary], [mill_bridge, *streams])

    yard_road = smooth_path(km((0.2, 6.4), (0.2, 2), (0.2, -2), (0.2, -6.6)))
    road = {"highway": "secondary", "name": "Yard Road"}
    yard_bridge = Bridge((200.0, -70.0), 95.0, "Yard Bridge", sides_m=(9.0, -9.0))
    mill_bridge = Bridge((200.0, 2_600.0), 9.0, "Mill Bridge", sides_m=(8.5, -8.5))
    walks = [Deck(side_m, {"highway": "footway"}) for side_m in (6.5, -6.5)]
    _draw_bundle(drawing, yard_road, [Deck(0.0, road), *walks], [yard_bridge, mill_bridge, Bridge((200.0, -3_900.0), 8.0)])
    quay = [np.array([3_300.0 + east, 2_600.0 + north]) for east, north in ((0, 0), (40, 3), (38, 16), (-2, 13))]
    drawing.add_area(quay, {"man_made": "bridge", "name": "Old Quay"})  # carries nothing


def _draw_border_bridge(drawing: OsmDrawing) -> None:
    """Draw a bridge over the edge of the box: two nodes of its way and of its outline are left."""
    edge_m = drawing.half_size_m[0]
    deck = [np.array([edge_m + east, 2_000.0]) for east in (-80.0, -20.0, 30.0)]
    drawing.add_path(deck, {"highway": "tertiary", "bridge": "yes", "name": "Mill Road"})
    ring = [np.array([edge_m + east, 2_000.0 + north]) for east, north in ((-82, -6), (32, -6), (32, 6), (-82, 6))]
    drawing.add_area(ring, {"man_made": "bridge", "name": "Mill Bridge"})


def _draw_bundle(
    drawing: OsmDrawing,
    path: FloatArray,
    decks: Sequence[Deck],
    bridges: Sequence[Bridge],
    splits: Sequence[Point] = (),
    starts: Sequence[int | None] = (),
) -> list[dict[Point, int]]:
    """Draw parallel ways along a path, cut at bridges and splits; return for each way the nodes at the splits.

    starts holds the nodes that the ways begin with, for a path that leaves another one.
    """
    line = shapely.LineString(path)
    middles = [(bridge, float(line.project(shapely.Point(bridge.middle)))) for bridge in bridges]
    spans = [(middle - bridge.half_m, middle + bridge.half_m) for bridge, middle in middles]
    split_at = {float(line.project(shapely.Point(split))): split for split in splits}
    cuts = sorted([0.0, float(distance_along(path)[-1]), *split_at, *(end for span in spans for end in span)])
    found = []
    for number, deck in enumerate(decks):
        last = starts[number] if starts else None
        nodes: dict[Point, int] = {}
        for start_m, end_m in pairwise(cuts):
            is_bridge = any(first <= start_m and end_m <= end for first, end in spans)
            piece = offset_path(piece_of(path, start_m, end_m), deck.offset_m)
            node_ids = [] if last is None else [last]
            node_ids += [drawing.add_node(point) for point in piece[len(node_ids) :]]
            last = node_ids[-1]
            drawing.add_way(node_ids, {**deck.tags, "bridge": "yes", "layer": "1"} if is_bridge else deck.tags)
            if end_m in split_at:
                nodes[split_at[end_m]] = last
        found.append(nodes)
    for (bridge, _), (start_m, end_m) in zip(middles, spans, strict=True):
        if bridge.name:
            outer = piece_of(path, start_m - 2.0, end_m + 2.0)
            left, right = (offset_path(outer, side_m) for side_m in bridge.sides_m)
            drawing.add_area([*left, *right[::-1]], {"man_made": "bridge", "layer": "1", "name": bridge.name})
    return found
