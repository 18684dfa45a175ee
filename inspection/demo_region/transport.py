"""Roads, railways, waters, and the bridges at their crossings."""

from dataclasses import dataclass, field

import numpy as np
import shapely

from inspection.demo_region.layout import (
    BRANCH_JUNCTION_SHARE,
    BRANCH_RAILWAY,
    MAIN_RAILWAY,
    RAILWAY_OPERATOR,
    RIVER,
    ROADS,
    STREAMS_PER_BANK,
    TOWNS,
    DemoCourse,
)
from inspection.demo_region.osm_file import OsmDrawing
from inspection.demo_region.place import FloatArray, distance_along, offset_path, piece_of, point_along, smooth_path

BRIDGES = 60
BRIDGE_SPACING_M = 150.0  # between the middles of two bridges
ABUTMENTS_M = 14.0  # extra length of a bridge beyond what it spans
PATH_WIDTH_M = 3.0


@dataclass(frozen=True, eq=False)
class Strand:
    """A road, railway or water as a curve, with the bridges that carry it."""

    course: DemoCourse
    path: FloatArray
    bridges: list["Crossing"] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Crossing:
    over: Strand
    under: Strand
    at_m: float  # along the strand above
    place: FloatArray
    length_m: float

    @property
    def rank(self) -> int:
        """Return a sort key: the river first, then rails with roads, then streams; the rest are level crossings or culverts."""
        return {"river": 0, "rail": 1}.get(
            self.under.course.kind, 1 if self.over.course.kind == "rail" and self.under.course.kind != "stream" else 2
        )


def draw_transport(drawing: OsmDrawing, generator: np.random.Generator) -> None:
    river = Strand(RIVER, smooth_path(RIVER.points))
    streams = _streams(river, generator)
    roads = [Strand(road, smooth_path(road.points)) for road in ROADS]
    main_path = smooth_path(MAIN_RAILWAY.points, rounds=5)
    junction = int(np.argmin(np.abs(distance_along(main_path) - BRANCH_JUNCTION_SHARE * distance_along(main_path)[-1])))
    branch_path = smooth_path((tuple(main_path[junction]), *BRANCH_RAILWAY.points), rounds=5)
    railways = [Strand(MAIN_RAILWAY, main_path), Strand(BRANCH_RAILWAY, branch_path)]

    crossings = [crossing for over in railways for under in [river, *streams, *roads] for crossing in _crossings(over, under)]
    crossings += [crossing for over in roads for under in [river, *streams] for crossing in _crossings(over, under)]
    for crossing in _choose(crossings):
        crossing.over.bridges.append(crossing)

    drawing.add_path(river.path, {"waterway": "river", "name": RIVER.name, "width": f"{RIVER.width_m:.0f}"})
    for stream in streams:
        drawing.add_path(stream.path, {"waterway": "stream"})
    shared_nodes: dict[tuple[float, float], int] = {}
    for strand in [*railways, *roads]:
        _draw_strand(drawing, strand, shared_nodes)


def _streams(river: Strand, generator: np.random.Generator) -> list[Strand]:
    """Return slightly winding streams from both ridges down to the river."""
    streams = []
    for bank in (1.0, -1.0):
        mouths = np.linspace(-18_000.0, 18_000.0, STREAMS_PER_BANK) + generator.uniform(-800.0, 800.0, STREAMS_PER_BANK)
        for mouth_east in mouths:
            mouth = np.array([mouth_east, np.interp(mouth_east, river.path[:, 0], river.path[:, 1])])
            spring = np.array([mouth_east + generator.uniform(-2_500.0, 2_500.0), bank * generator.uniform(9_500.0, 11_500.0)])
            course = [spring + share * (mouth - spring) for share in np.linspace(0.0, 1.0, 7)]
            for point in course[1:-1]:
                point += generator.uniform(-450.0, 450.0, 2)
            points = tuple((float(east), float(north)) for east, north in course)
            stream = DemoCourse("", "stream", points, float(generator.uniform(5.0, 11.0)))
            streams.append(Strand(stream, smooth_path(points, rounds=3)))
    return streams


def _crossings(over: Strand, under: Strand) -> list[Crossing]:
    upper, lower = shapely.LineString(over.path), shapely.LineString(under.path)
    length_m = upper.length
    found = []
    for point in shapely.get_parts(upper.intersection(lower)):
        if point.geom_type != "Point":
            continue
        at_m = float(upper.project(point))
        if not 100.0 < at_m < length_m - 100.0:
            continue
        below_m = float(lower.project(point))
        direction = point_along(over.path, at_m + 5.0) - point_along(over.path, at_m - 5.0)
        across = point_along(under.path, min(below_m + 5.0, lower.length)) - point_along(under.path, max(below_m - 5.0, 0.0))
        sine = abs(float(direction[0] * across[1] - direction[1] * across[0])) / float(np.hypot(*direction) * np.hypot(*across))
        span_m = under.course.width_m / max(sine, 0.35) + ABUTMENTS_M
        found.append(Crossing(over, under, at_m, np.array([point.x, point.y]), span_m))
    return found


def _choose(crossings: list[Crossing]) -> list[Crossing]:
    """Return the BRIDGES highest-ranked crossings that keep BRIDGE_SPACING_M from one another, by rank."""
    chosen: list[Crossing] = []
    for crossing in sorted(crossings, key=lambda crossing: crossing.rank):
        if len(chosen) == BRIDGES:
            break
        if all(np.hypot(*(crossing.place - other.place)) >= BRIDGE_SPACING_M for other in chosen):
            chosen.append(crossing)
    return chosen


def _draw_strand(drawing: OsmDrawing, strand: Strand, shared_nodes: dict[tuple[float, float], int]) -> None:
    """Draw the strand as a chain of ways, one per bridge and one per stretch between them, as OSM splits them."""
    course = strand.course
    if course.kind == "rail":
        tags = {"railway": "rail", "electrified": "contact_line", "voltage": "15000", "frequency": "16.7", "gauge": "1435"}
        tags |= {"name": course.name, "operator": RAILWAY_OPERATOR, "usage": "main" if course is MAIN_RAILWAY else "branch"}
    else:
        tags = {"highway": course.kind, "name": course.name}
    position_m = 0.0
    end_m = float(distance_along(strand.path)[-1])
    previous: int | None = None
    for bridge in sorted(strand.bridges, key=lambda crossing: crossing.at_m):
        start_m, stop_m = bridge.at_m - bridge.length_m / 2, bridge.at_m + bridge.length_m / 2
        previous = _draw_piece(drawing, piece_of(strand.path, position_m, start_m), tags, previous, shared_nodes)
        deck = piece_of(strand.path, start_m, stop_m)
        previous = _draw_bridge(drawing, bridge, deck, tags, previous, shared_nodes)
        position_m = stop_m
    _draw_piece(drawing, piece_of(strand.path, position_m, end_m), tags, previous, shared_nodes)


def _draw_piece(
    drawing: OsmDrawing, path: FloatArray, tags: dict[str, str], previous: int | None, shared_nodes: dict[tuple[float, float], int]
) -> int:
    """Draw a way from the previous one's last node that shares existing nodes of another strand (the junction); returns its last node."""
    node_ids = [] if previous is None else [previous]
    for point in path if previous is None else path[1:]:
        place = (float(point[0]), float(point[1]))
        if place not in shared_nodes:
            shared_nodes[place] = drawing.add_node(point)
        node_ids.append(shared_nodes[place])
    drawing.add_way(node_ids, tags)
    return node_ids[-1]


def _draw_bridge(
    drawing: OsmDrawing,
    bridge: Crossing,
    deck: FloatArray,
    tags: dict[str, str],
    previous: int | None,
    shared_nodes: dict[tuple[float, float], int],
) -> int:
    width_m = bridge.over.course.width_m
    is_long = bridge.under.course is RIVER
    bridge_tags = {"bridge": "viaduct" if is_long and bridge.over.course.kind == "rail" else "yes", "layer": "1", "width": f"{width_m:g}"}
    last = _draw_piece(drawing, deck, tags | bridge_tags, previous, shared_nodes)
    if is_long:
        _draw_bridge_area(drawing, bridge, deck, width_m)
    return last


def _draw_bridge_area(drawing: OsmDrawing, bridge: Crossing, deck: FloatArray, width_m: float) -> None:
    """Draw the outline of a whole bridge over the river, with a path beside the road or rails on the same outline."""
    footpath = offset_path(deck, width_m / 2 + PATH_WIDTH_M / 2)
    drawing.add_path(footpath, {"highway": "path", "bridge": "yes", "layer": "1", "width": f"{PATH_WIDTH_M:g}"})
    if bridge.over.course.kind == "secondary":
        other_path = offset_path(deck, -(width_m / 2 + PATH_WIDTH_M / 2))
        drawing.add_path(other_path, {"highway": "cycleway", "bridge": "yes", "layer": "1", "width": f"{PATH_WIDTH_M:g}"})
    half_m = width_m / 2 + PATH_WIDTH_M + 1.0
    ends = np.diff(deck, axis=0)[[0, -1]]
    ends /= np.hypot(ends[:, 0], ends[:, 1])[:, None]
    longer = np.vstack([deck[0] - 2.0 * ends[0], deck[1:-1], deck[-1] + 2.0 * ends[1]])
    left, right = offset_path(longer, half_m), offset_path(longer, -half_m)
    town = min(TOWNS, key=lambda town: float(np.hypot(*(np.array(town.at) - bridge.place))))
    what = "Railway Bridge" if bridge.over.course.kind == "rail" else "Bridge"
    ring = [*left, *right[::-1]]
    drawing.add_area(ring, {"man_made": "bridge", "layer": "1", "name": f"{town.name} {what}"})
