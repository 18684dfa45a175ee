"""The points that a UAV needs to follow a railway: of its vertices as few as it takes, and more on long straight legs."""

from dataclasses import dataclass
from math import asin, atan2, cos, hypot, pi, radians

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import distance_m
from inspection.network.build.joining import JoinedVertices
from inspection.network.infrastructure import InfrastructureWays

MAX_STRAY_M = 15.0  # how far a straight leg may pass from a vertex that it skips
METRES_PER_DEGREE = 111_695.0  # the most on WGS84 (of latitude, at a pole): what counts as short enough here is so on the ground

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class RailwayPoints:
    position: FloatArray  # (n, 2) lon, lat [deg]
    way: IntArray  # (n,) the first way at the point
    leg: IntArray  # (m, 2) points that follow one another
    way_of_leg: IntArray  # (m,)


def railway_points(ways: InfrastructureWays, joined: JoinedVertices, spacing_m: float) -> RailwayPoints:
    """Thin the vertices, then divide the legs that are longer than the spacing into equal pieces."""
    kept = np.flatnonzero(thin(ways, joined.node_of_vertex, spacing_m))
    nodes, point = np.unique(joined.node_of_vertex[kept], return_inverse=True)
    way_of_vertex = ways.way_of_vertex[kept]
    goes_on = np.flatnonzero((np.diff(way_of_vertex) == 0) & (np.diff(point) != 0))
    position, way = joined.position[nodes], joined.way[nodes]
    start, end, way_of_leg = point[goes_on], point[goes_on + 1], way_of_vertex[goes_on]

    pieces = np.maximum(np.ceil(distance_m(position[start], position[end]) / spacing_m), 1).astype(np.int64)
    pieces[np.abs(position[start, 0] - position[end, 0]) > 180.0] = 1
    leg = np.repeat(np.arange(len(pieces)), pieces)
    step = np.arange(len(leg)) - np.repeat(np.cumsum(pieces) - pieces, pieces)  # 0, 1, ... along each leg
    is_inner = step > 0
    fraction = (step / pieces[leg])[is_inner, None]
    inner = position[start[leg[is_inner]]] * (1 - fraction) + position[end[leg[is_inner]]] * fraction
    begins = start[leg]
    begins[is_inner] = len(nodes) + np.arange(len(inner))
    finishes = np.empty_like(begins)
    finishes[:-1] = begins[1:]
    finishes[np.cumsum(pieces) - 1] = end
    return RailwayPoints(
        position=np.concatenate([position, inner]),
        way=np.concatenate([way, way_of_leg[leg[is_inner]]]),
        leg=np.column_stack([begins, finishes]),
        way_of_leg=way_of_leg[leg],
    )


def thin(ways: InfrastructureWays, node_of_vertex: IntArray, spacing_m: float) -> BoolArray:
    """Which vertices stay: the ends of each way, nodes that several vertices share (junctions), and of the others as few as it takes.

    Between two that stay the track is at most spacing_m long, unless the way itself has no vertex for longer,
    and no skipped vertex is farther than MAX_STRAY_M from the straight leg.
    """
    keep = np.bincount(node_of_vertex, minlength=1)[node_of_vertex] > 1
    has_vertices = np.diff(ways.first) > 0
    keep[ways.first[:-1][has_vertices]] = True
    keep[ways.first[1:][has_vertices] - 1] = True
    for begin, end in zip(ways.first[:-1].tolist(), ways.first[1:].tolist(), strict=True):
        if end - begin > 2:
            _thin_way(ways.position[begin:end], keep[begin:end], spacing_m)
    return keep


def _thin_way(position: NDArray[np.float64], keep: BoolArray, spacing_m: float) -> None:
    """Mark more vertices to keep. From each kept one the leg reaches on as long as it lies in the sector of directions
    that pass within MAX_STRAY_M of every vertex skipped since (Reumann and Witkam's strip as a cone).
    """
    metres_per_degree_lon = METRES_PER_DEGREE * cos(radians(float(position[:, 1].mean())))
    east = ((position[:, 0] - position[0, 0]) * metres_per_degree_lon).tolist()
    north = ((position[:, 1] - position[0, 1]) * METRES_PER_DEGREE).tolist()
    kept = keep.tolist()
    anchor = 0
    along_m = farthest_m = 0.0
    middle, lowest, highest = None, -pi, pi  # the sector, relative to the direction of the first skipped vertex
    for vertex in range(1, len(east)):
        step_m = hypot(east[vertex] - east[vertex - 1], north[vertex] - north[vertex - 1])
        distance_m, turn = _polar(east, north, anchor, vertex, middle)
        reaches = along_m + step_m <= spacing_m and distance_m >= farthest_m and lowest <= turn <= highest
        if not reaches and vertex - 1 > anchor:
            anchor = vertex - 1
            kept[anchor] = True
            along_m = farthest_m = 0.0
            middle, lowest, highest = None, -pi, pi
            distance_m, turn = _polar(east, north, anchor, vertex, middle)
        if kept[vertex]:
            anchor = vertex
            along_m = farthest_m = 0.0
            middle, lowest, highest = None, -pi, pi
            continue
        along_m += step_m
        farthest_m = distance_m
        if distance_m > MAX_STRAY_M:
            if middle is None:
                middle, turn = turn, 0.0
            half_width = asin(MAX_STRAY_M / distance_m)
            lowest, highest = max(lowest, turn - half_width), min(highest, turn + half_width)
    keep[:] = kept


def _polar(east: list[float], north: list[float], anchor: int, vertex: int, middle: float | None) -> tuple[float, float]:
    """Distance from the anchor, and the direction relative to the middle of the sector (absolute while there is none)."""
    x, y = east[vertex] - east[anchor], north[vertex] - north[anchor]
    direction = atan2(y, x)
    if middle is not None:
        direction = (direction - middle + pi) % (2 * pi) - pi
    return hypot(x, y), direction
