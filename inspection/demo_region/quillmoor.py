"""Quillmoor: a second synthetic region, small and mapped like real regions, with the irregularities that Elme Valley lacks.

It is in the same desert, 60 km west of Elme Valley. It is clipped to its box like `osmium extract --strategy=simple`: nodes beyond the box
are not in the file, and ways keep their references to them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from inspection.demo_region.layout import km
from inspection.demo_region.osm_file import FIRST_ID, OsmDrawing, Tags
from inspection.demo_region.place import DEFAULT_SEED, FloatArray, Point, distance_along, offset_path, piece_of, smooth_path, spans_between

GRID_OPERATOR = "Quillmoor Grid"
RUN = 4  # consecutive vertices that are tagged or untagged together: mappers omit whole stretches
NORTH_SUBSTATION = (-2_000.0, 3_500.0)
SOUTH_SUBSTATION = (-1_800.0, -3_400.0)
LONG_SPAN_M = 2_400.0  # its towers are not mapped
FORK = (4_300.0, 4_000.0)  # where three lines leave their common row


def _line(voltage_v: int, ref: str, **tags: str) -> dict[str, str]:
    return {"power": "line", "voltage": str(voltage_v), "ref": ref, "name": f"Line {ref}", "operator": GRID_OPERATOR} | tags


class _Mapper:
    """Draws rows of supports with one generator."""

    def __init__(self, drawing: OsmDrawing, generator: np.random.Generator) -> None:
        self.drawing = drawing
        self.generator = generator
        self.place_of: dict[int, FloatArray] = {}  # east and north [m] of the vertices

    def row(self, *corners: tuple[float, float], span_m: float, untagged_share: float = 0.2, support: str = "tower") -> list[int]:
        """Return the node ids of a row; the share of untagged vertices is in runs, and numbers start at 1 on each row.

        No support states its height.
        """
        points, _ = spans_between(np.array(corners), span_m, self.generator)
        runs = self.generator.random(len(points) // RUN + 1) < untagged_share
        node_ids = []
        for number, point in enumerate(points):
            tags = {} if runs[number // RUN] else {"power": support, "ref": str(number + 1)}
            node_ids.append(self.drawing.add_node(point, tags))
        self.place_of |= dict(zip(node_ids, points, strict=True))
        return node_ids

    def line(self, tags: dict[str, str], *corners: tuple[float, float], span_m: float = 270.0, untagged_share: float = 0.2) -> list[int]:
        node_ids = self.row(*corners, span_m=span_m, untagged_share=untagged_share)
        self.drawing.add_way(node_ids, tags)
        return node_ids


def draw_power(drawing: OsmDrawing, generator: np.random.Generator) -> None:
    mapper = _Mapper(drawing, generator)
    north, south = _draw_substations(drawing)
    _draw_lines_into_substations(mapper, north, south)
    _draw_common_row(mapper, north)
    _draw_parallel_rows(mapper)
    _draw_long_span(mapper)
    _draw_gaps(mapper)
    _draw_poles(mapper, south)
    _draw_what_is_not_flown(drawing)


def _draw_substations(drawing: OsmDrawing) -> tuple[list[int], list[int]]:
    """Draw two fences, the second with the older tag, and return their corner nodes; a third substation is one node."""
    fences = []
    for (east, north), tags in (
        (NORTH_SUBSTATION, {"power": "substation", "substation": "transmission", "voltage": "220000;110000"}),
        (SOUTH_SUBSTATION, {"power": "sub_station", "voltage": "110000"}),
    ):
        ring = [np.array([east + x * 70.0, north + y * 55.0]) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        drawing.add_area(ring, tags | {"name": "Quillmoor"})
        fences.append([node.id for node in drawing.nodes[-4:]])
    drawing.add_node((7_900.0, -2_300.0), {"power": "substation", "name": "Quillmoor"})
    return fences[0], fences[1]


def _draw_lines_into_substations(mapper: _Mapper, north: list[int], south: list[int]) -> None:
    """Line 7 is three ways of one name and ends inside the fence; Line 11 ends on the fence, at a corner of its outline."""
    drawing = mapper.drawing
    east, up = NORTH_SUBSTATION
    row = mapper.row((-13_500.0, 4_400.0), (-7_400.0, 4_900.0), (east - 400.0, up + 60.0), span_m=300.0)
    inside = drawing.add_node((east - 30.0, up + 10.0))
    thirds = [row[: len(row) // 3 + 1], row[len(row) // 3 : 2 * len(row) // 3 + 1], [*row[2 * len(row) // 3 :], inside]]
    for part in thirds:
        drawing.add_way(part, _line(220_000, "7", circuits="2", cables="6"))
    corner_to_corner = mapper.row((east + 40.0, up - 330.0), (-1_300.0, 600.0), (-1_500.0, -2_900.0), span_m=250.0)
    drawing.add_way([north[1], *corner_to_corner, south[3]], _line(110_000, "11"))
    portals = [drawing.add_node((east - 40.0 + 40.0 * number, up - 20.0), {"power": "portal"}) for number in range(3)]
    drawing.add_way([inside, *portals], {"power": "line", "line": "busbar", "voltage": "220000"})


def _draw_common_row(mapper: _Mapper, north: list[int]) -> None:
    """Three lines share the towers from the substation to the fork: one goes on beyond the box, one turns south, one north."""
    east, up = NORTH_SUBSTATION
    common = [north[2], *mapper.row((east + 350.0, up + 80.0), (1_200.0, 4_300.0), FORK, span_m=290.0, untagged_share=0.1)]
    onward = mapper.row((4_600.0, 4_020.0), (9_000.0, 4_700.0), (13_800.0, 4_100.0), span_m=300.0)
    southward = mapper.row((4_480.0, 3_700.0), (6_900.0, 1_700.0), (7_800.0, -2_260.0), span_m=240.0)
    northward = mapper.row((4_500.0, 4_250.0), (6_200.0, 6_100.0), (6_300.0, 9_200.0), span_m=240.0)
    mapper.drawing.add_way([*common, *onward], _line(220_000, "8", circuits="2"))
    mapper.drawing.add_way([*common, *southward], _line(110_000, "9"))
    mapper.drawing.add_way([*common, *northward], _line(110_000, "10"))


def _draw_parallel_rows(mapper: _Mapper) -> None:
    """Two rows of towers 45 m apart from one edge of the box to the other, both named Line 7 like the line in the north."""
    for side_m in (0.0, 45.0):
        mapper.line(_line(110_000, "7"), (8_900.0 + side_m, 9_000.0), (8_600.0 + side_m, 1_000.0), (9_500.0 + side_m, -9_000.0))


def _draw_long_span(mapper: _Mapper) -> None:
    """Line 12 leaves the box in the west and comes back, and crosses a marsh without a mapped tower."""
    west = mapper.row((-9_000.0, -7_300.0), (-12_700.0, -5_800.0), (-9_600.0, -4_200.0), (-7_000.0, -4_100.0), span_m=260.0)
    east = mapper.row((-7_000.0 + LONG_SPAN_M, -4_100.0), (SOUTH_SUBSTATION[0] - 300.0, -3_500.0), span_m=260.0)
    mapper.drawing.add_way([*west, *east, mapper.drawing.add_node(SOUTH_SUBSTATION)], _line(110_000, "12"))


def _draw_gaps(mapper: _Mapper) -> None:
    """Draw data issues: lines without towers, an end 4 m beside the line it belongs to, lone towers, a voltage in kV."""
    drawing = mapper.drawing
    mapper.line(_line(110_000, "13"), (-10_500.0, -1_800.0), (-8_300.0, -2_500.0), (-5_200.0, -2_200.0), untagged_share=1.0)
    through = mapper.line(_line(110_000, "14"), (-10_000.0, 7_000.0), (-6_000.0, 6_300.0), (-2_600.0, 6_600.0), untagged_share=0.0)
    east, up = mapper.place_of[through[8]]
    mapper.line(_line(110_000, "14"), (east, up - 4.0), (east - 300.0, 5_100.0), untagged_share=0.0)
    for number in range(4):
        drawing.add_node((-6_200.0 + 260.0 * number, 1_900.0), {"power": "tower"})
    mapper.line(_line(110, "15"), (1_800.0, -6_900.0), (4_600.0, -6_200.0), span_m=230.0)
    border = [drawing.add_node(point, {"power": "tower"}) for point in ((11_900.0, 6_500.0), (12_150.0, 6_550.0), (12_400.0, 6_600.0))]
    drawing.add_way(border, _line(110_000, "16"))  # one node of it is left


def _draw_poles(mapper: _Mapper, south: list[int]) -> None:
    """Minor lines on poles, of which many are not mapped, and a power=line on poles."""
    east, up = SOUTH_SUBSTATION
    tags = {"power": "minor_line", "voltage": "20000"}
    trunk = mapper.row((east + 200.0, up - 60.0), (1_200.0, -4_400.0), (3_900.0, -4_000.0), span_m=75.0, untagged_share=0.4, support="pole")
    mapper.drawing.add_way([south[1], *trunk], tags)
    for place, to in ((18, (-300.0, -6_800.0)), (40, (1_500.0, -2_600.0))):
        start = mapper.place_of[trunk[place]]
        first = start + 70.0 * (to - start) / np.hypot(*(to - start))
        branch = mapper.row((first[0], first[1]), to, span_m=70.0, untagged_share=0.4, support="pole")
        mapper.drawing.add_way([trunk[place], *branch], tags)
    poles = mapper.row((8_050.0, -2_400.0), (11_000.0, -4_600.0), span_m=110.0, support="pole")
    mapper.drawing.add_way(poles, _line(34_500, "17"))


def _draw_what_is_not_flown(drawing: OsmDrawing) -> None:
    east, up = SOUTH_SUBSTATION
    cable = {"power": "cable", "location": "underground", "voltage": "20000"}
    drawing.add_path([np.array([east, up]), np.array([east - 900.0, up - 700.0])], cable)
    old = [np.array([-4_000.0 + 250.0 * number, 7_400.0]) for number in range(8)]
    drawing.add_path(old, {"power": "line", "disused": "yes", "name": "Line 7", "voltage": "110000"})


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
    """One way of a bundle: its offset to the left of the bundle's path, and its tags."""

    offset_m: float
    tags: Tags


@dataclass(frozen=True)
class DemoBridge:
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
    bridges = [
        DemoBridge((4_000.0, 0.0), 120.0),
        DemoBridge((-7_000.0, 0.0), 13.0),
        DemoBridge((-4_000.0, 0.0), 9.0),
        DemoBridge((7_600.0, 0.0), 10.0),
    ]
    splits = [(-TURNOUT_M, 0.0), (TURNOUT_M, 0.0), (BRANCH_M, 0.0)]
    tracks = _draw_bundle(drawing, main, [Deck(offset_m, MAIN_LINE) for offset_m in MAIN_TRACKS_M], bridges, splits)
    northern, southern = tracks
    _draw_yard(drawing, southern[splits[0]], southern[splits[1]])
    branch = smooth_path(km((6, 0.0023), (6.8, 0.3), (7.4, 2.2), (9.6, 9)))
    single = Deck(0.0, MAIN_LINE | {"usage": "branch"})
    _draw_bundle(drawing, branch, [single], [DemoBridge((7_550.0, 2_700.0), 11.0)], starts=[northern[splits[2]]])
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
    harbour_bridge = DemoBridge((4_000.0, 24.0), 120.0, "Harbour Bridge", sides_m=(17.0, -32.0))
    _draw_bundle(drawing, harbour, decks, [harbour_bridge, DemoBridge((-7_500.0, 700.0), 10.0), DemoBridge((9_200.0, 500.0), 8.0)])

    north = smooth_path(km((-14, 6), (-5, 5.4), (3, 5.2), (8, 5.9), (14, 5.5)))
    tertiary = Deck(0.0, {"highway": "tertiary", "name": "Mill Road"})
    mill_bridge = DemoBridge((2_960.0, 5_300.0), 48.0, "Mill Bridge", sides_m=(8.0, -7.0))
    streams = [DemoBridge((east, 5_600.0), 6.0 + number) for number, east in enumerate((-10_500.0, -6_200.0, -500.0, 6_900.0, 10_600.0))]
    _draw_bundle(drawing, north, [tertiary, Deck(5.5, {"highway": "footway"})], [mill_bridge, *streams])

    south = smooth_path(km((-14, -5), (-6, -5.6), (0, -5), (5.4, -5.2), (9, -4.6), (14, -6)))
    mill_bridge = DemoBridge((5_450.0, -5_100.0), 50.0, "Mill Bridge", sides_m=(6.0, -6.0))
    streams = [DemoBridge((east, -5_200.0), 7.0) for east in (-11_000.0, -8_200.0, -3_000.0, 1_100.0, 7_800.0, 11_300.0)]
    _draw_bundle(drawing, south, [tertiary], [mill_bridge, *streams])

    yard_road = smooth_path(km((0.2, 6.4), (0.2, 2), (0.2, -2), (0.2, -6.6)))
    road = {"highway": "secondary", "name": "Yard Road"}
    yard_bridge = DemoBridge((200.0, -70.0), 95.0, "Yard Bridge", sides_m=(9.0, -9.0))
    mill_bridge = DemoBridge((200.0, 2_600.0), 9.0, "Mill Bridge", sides_m=(8.5, -8.5))
    walks = [Deck(side_m, {"highway": "footway"}) for side_m in (6.5, -6.5)]
    _draw_bundle(drawing, yard_road, [Deck(0.0, road), *walks], [yard_bridge, mill_bridge, DemoBridge((200.0, -3_900.0), 8.0)])
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
    bridges: Sequence[DemoBridge],
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


QUILLMOOR_NAME = "Quillmoor"
QUILLMOOR_CENTRE: Point = (-60_000.0, 0.0)  # east and north [m] of the centre of Elme Valley
QUILLMOOR_HALF_SIZE_M: Point = (12_000.0, 8_000.0)
QUILLMOOR_FIRST_ID = FIRST_ID + 1_000_000_000  # both regions can be in one database


def make_quillmoor(seed: int = DEFAULT_SEED) -> OsmDrawing:
    """Return the nodes and ways of Quillmoor; the seed moves supports along their lines and chooses those that are not tagged."""
    drawing = OsmDrawing(QUILLMOOR_CENTRE, QUILLMOOR_HALF_SIZE_M, QUILLMOOR_FIRST_ID)
    draw_power(drawing, np.random.default_rng(seed))
    draw_transport(drawing)
    return _clipped(drawing)


def _clipped(drawing: OsmDrawing) -> OsmDrawing:
    """Return the nodes inside the box and the ways that have at least one of them."""
    (west, south), (east, north) = drawing.corners()
    nodes = [node for node in drawing.nodes if west <= node.position.lon <= east and south <= node.position.lat <= north]
    inside = {node.id for node in nodes}
    return replace(drawing, nodes=nodes, ways=[way for way in drawing.ways if not inside.isdisjoint(way.node_ids)])
