"""Hash of the surroundings of routes: zones, terrain heights and obstacles."""

import hashlib
from collections.abc import Iterator, Sequence

import numpy as np

from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import FrozenRoute
from simulation.assessment.flown import FloatArray
from simulation.assessment.judging import AssessmentSurroundings

BESIDE_DEG = 0.02  # some 2 km beside the waypoints, the range in which assessments report zones
LOOK_EACH_M = 30.0  # sampling of heights along the routes
DEGREE_DIGITS, METRE_DIGITS = 7, 1


def ground_content(routes: Sequence[FrozenRoute], around: AssessmentSurroundings) -> str:
    """Return the SHA-256 of what an assessment of the routes uses; objects farther away do not change it."""
    hashed = hashlib.sha256()
    for part in (*_zones(routes, around), *_standing(around), _heights(routes, around)):
        hashed.update(part)
        hashed.update(b"\0")
    return hashed.hexdigest()


def _zones(routes: Sequence[FrozenRoute], around: AssessmentSurroundings) -> Iterator[bytes]:
    """Yield the zones independent of their names and order."""
    table, places = around.zones, _places(routes)
    (west, south), (east, north) = places.min(axis=0) - BESIDE_DEG, places.max(axis=0) + BESIDE_DEG
    box = table.box
    near = np.flatnonzero((box[:, 0] <= east) & (box[:, 2] >= west) & (box[:, 1] <= north) & (box[:, 3] >= south)).tolist()
    yield from sorted(table.wkb[row] + repr((tuple(table.limits[row]), table.schedules[row])).encode() for row in near)


def _standing(around: AssessmentSurroundings) -> Iterator[bytes]:
    standing = around.standing
    ends = np.round(np.hstack([standing.start, standing.end]), DEGREE_DIGITS)
    tops = np.round(np.column_stack([standing.start_top_m, standing.end_top_m]), METRE_DIGITS)
    rows = np.hstack([ends, tops]) + 0.0  # turns -0.0 into 0.0
    yield rows[np.lexsort(rows.T[::-1])].tobytes()


def _heights(routes: Sequence[FrozenRoute], around: AssessmentSurroundings) -> bytes:
    found = around.ground_amsl_m(np.vstack([_along(route) for route in routes]))
    return (np.round(found, METRE_DIGITS) + 0.0).tobytes()


def _along(route: FrozenRoute) -> FloatArray:
    """Return places (n, 2) lon, lat along a route, including its waypoints."""
    places = _places([route])
    frame = LocalFrame.around(*places[0].tolist())
    lengths_m = np.hypot(*np.diff(frame.to_metres(places), axis=0).T)
    parts = [
        start + np.linspace(0.0, 1.0, max(int(np.ceil(length_m / LOOK_EACH_M)), 1), endpoint=False)[:, None] * (end - start)
        for start, end, length_m in zip(places[:-1], places[1:], lengths_m, strict=True)
    ]
    along: FloatArray = np.vstack([*parts, places[-1:]])
    return along


def _places(routes: Sequence[FrozenRoute]) -> FloatArray:
    return np.array([waypoint.position for route in routes for waypoint in route.waypoints], dtype=np.float64)
