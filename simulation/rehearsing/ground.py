"""Ground of rehearsals: terrain for UAVs that read a place many times per second, and a hash of the surroundings of routes."""

import hashlib
import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import FrozenRoute
from simulation.assessment.judging import AssessmentSurroundings

FloatArray = NDArray[np.float64]
STEP_DEG = 1.0 / 7_200.0  # half an arc second: 15 m to the north
BLOCK = 32  # steps along a side

Heights = Callable[[FloatArray], FloatArray]


class BlockedGround:
    """Heights interpolated on a fine grid, which is read from the terrain in blocks when a UAV first reaches them.

    Unknown terrain has the height `otherwise_m`, that of the take-off.
    """

    def __init__(self, heights_m: Heights | None, otherwise_m: float) -> None:
        self._heights_m = heights_m
        self._otherwise_m = otherwise_m
        self._blocks: dict[tuple[int, int], list[list[float]]] = {}

    def elevation_m(self, position: LonLat) -> float:
        if self._heights_m is None:
            return self._otherwise_m
        x, y = position[0] / STEP_DEG, position[1] / STEP_DEG
        column, row = math.floor(x), math.floor(y)
        block = column // BLOCK, row // BLOCK
        rows = self._blocks.get(block)
        if rows is None:
            rows = self._blocks[block] = self._read(*block)
        column, row, east, north = column - block[0] * BLOCK, row - block[1] * BLOCK, x - column, y - row
        low, high = rows[row], rows[row + 1]
        south_m = low[column] + east * (low[column + 1] - low[column])
        return south_m + north * (high[column] + east * (high[column + 1] - high[column]) - south_m)

    def _read(self, block_column: int, block_row: int) -> list[list[float]]:
        assert self._heights_m is not None  # noqa: S101 - checked by callers
        lon = (block_column * BLOCK + np.arange(BLOCK + 1)) * STEP_DEG
        lat = (block_row * BLOCK + np.arange(BLOCK + 1)) * STEP_DEG
        places = np.column_stack([np.tile(lon, BLOCK + 1), lat.repeat(BLOCK + 1)])
        found = self._heights_m(places)
        rows: list[list[float]] = np.where(np.isnan(found), self._otherwise_m, found).reshape(BLOCK + 1, BLOCK + 1).tolist()
        return rows


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
