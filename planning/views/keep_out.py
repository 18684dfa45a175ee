"""Where a UAV may not be beside wires and structures: columns from the ground to above what stands there, widened by the clearance.

A UAV passes wires above them or along their outer side, and is never under or between them. All places in x east, y north, z up [m].
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planning.views.ground_band import BoolArray, GroundBand
from planning.views.solids import FloatArray

# EN 50110-1:2013, table A.1: the outer limit of the vicinity zone D_V [m] by nominal voltage [kV].
VICINITY_M = ((10.0, 1.15), (20.0, 1.22), (30.0, 1.32), (110.0, 2.0), (220.0, 3.0), (380.0, 4.0), (480.0, 6.1), (700.0, 8.4))
USUAL_KV = 110.0  # where nothing is known of a line, its next class up counts
SWING_DEG = 30.0  # of wires and strings to each side, in winds in which UAVs fly: own assumption
SITE_M = 150.0  # around the inspected asset: what of wires and supports is looked at, if nothing else is asked for
PIECE_M = 25.0  # of a span, with the height of its higher end
DIRECTIONS = 16  # in which a column is bounded
_ANGLES = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
NORMALS = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])


@dataclass(frozen=True)
class ClearanceRules:
    """floor_m: the least distance that an organisation keeps. position_sd_m: of the UAV's position, counted three times.

    map_error_m: of supports on the map. uav_radius_m: from the antenna to the tips of the rotors. gust_mps: by how much a gust carries the
    UAV off for reaction_s.
    """

    floor_m: float = 5.0
    position_sd_m: float = 0.5
    map_error_m: float = 1.5
    uav_radius_m: float = 0.8
    gust_mps: float = 3.0
    reaction_s: float = 0.7


def vicinity_m(voltage_v: float | None) -> float:
    """The outer limit of the vicinity zone [m] of the voltage's class, or of the next one up; an unknown voltage is above USUAL_KV."""
    for kilovolts, limit_m in VICINITY_M:
        if (voltage_v is not None and voltage_v <= kilovolts * 1000.0) or (voltage_v is None and kilovolts > USUAL_KV):
            return limit_m
    kilovolts, limit_m = VICINITY_M[-1]
    return limit_m * (voltage_v or 0.0) / 1000.0 / kilovolts


def clearance_m(voltage_v: float | None, rules: ClearanceRules) -> float:
    """The least distance [m] that a UAV keeps from wires and supports of this voltage, without the swing of the wires."""
    errors_m = 3.0 * rules.position_sd_m + rules.map_error_m + rules.uav_radius_m
    return max(rules.floor_m, vicinity_m(voltage_v) + errors_m + rules.gust_mps * rules.reaction_s)


@dataclass(frozen=True)
class Span:
    """Wires from one support to the next: where both stand (x, y), their outermost wires (left negative, right), and their highest points.

    sag_m: of the lowest wire at its hottest; string_m: of the longest string that it hangs from. By both the wind carries them aside.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    left_m: float
    right_m: float
    start_top_m: float
    end_top_m: float
    sag_m: float = 0.0
    string_m: float = 0.0


@dataclass(frozen=True, eq=False)
class Obstacle:
    """Anything that stands there: the column over the convex hull of places (n, 2), wider by half_width_m, up to top_m."""

    places: FloatArray
    half_width_m: float
    top_m: float


@dataclass(frozen=True, eq=False)
class KeepOut:
    """Columns: bound float64 (c, DIRECTIONS), how far each reaches along NORMALS [m]; top_m (c,). band: heights over the ground."""

    bound: FloatArray
    top_m: FloatArray
    band: GroundBand

    def __len__(self) -> int:
        return len(self.top_m)

    def holds(self, points: FloatArray) -> BoolArray:
        """Whether each point, (n, 3), is in a column, or at a height that is not allowed over the ground."""
        return np.asarray(self.in_column(points) | self.band.leaves_out(points))

    def in_column(self, points: FloatArray) -> BoolArray:
        along = points[:, :2] @ NORMALS.T
        inside = np.zeros(len(points), dtype=bool)
        for bound, top_m in zip(self.bound, self.top_m.tolist(), strict=True):
            low = np.flatnonzero(~inside & (points[:, 2] < top_m))
            inside[low] = (along[low] < bound).all(axis=1)
        return inside

    def meets(self, start: FloatArray, end: FloatArray) -> BoolArray:
        """Whether the straight way from each start to its end, (n, 3) each, leads through a column or a height that is not allowed."""
        met = self.band.left_between(start, end)
        for bound, top_m in zip(self.bound, self.top_m.tolist(), strict=True):
            near = np.flatnonzero(~met & (np.minimum(start[:, 2], end[:, 2]) < top_m))
            met[near] = _clips(start[near], end[near], bound, top_m)
        return met

    def top_at(self, place: FloatArray) -> float:
        """The top of the highest column [m] over a place, (2,), -inf where there is none."""
        over = (NORMALS @ place < self.bound).all(axis=1)
        return float(self.top_m[over].max(initial=-math.inf))

    def tops_between(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """The top of the highest column [m] that each line from start to end, (n, 3), crosses on the map, -inf where there is none."""
        tops_m = np.full(len(start), -np.inf)
        for bound, top_m in zip(self.bound, self.top_m.tolist(), strict=True):
            lower = np.flatnonzero(tops_m < top_m)
            tops_m[lower[_clips(start[lower], end[lower], bound, math.inf)]] = top_m
        return tops_m


def keep_out(
    obstacles: Sequence[Obstacle], spans: Sequence[Span], clearance: float, band: GroundBand, around_m: float = SITE_M
) -> KeepOut:  # fmt: skip
    """Return the columns of what stands within around_m and of the wires there, clearance [m] wider and higher than they are."""
    columns = [_column(own.places, own.half_width_m, own.top_m, clearance) for own in obstacles if _is_near(own.places, around_m)]
    for span in spans:
        columns += [_column(places, 0.0, top_m, clearance) for places, top_m in _span_pieces(span) if _is_near(places, around_m)]
    bound = np.array([bound for bound, _ in columns]).reshape(-1, DIRECTIONS)
    return KeepOut(bound, np.array([top_m for _, top_m in columns]), band)


def _is_near(places: FloatArray, around_m: float) -> bool:
    """Whether the box of the places comes so near."""
    low, high = places.min(axis=0), places.max(axis=0)
    return bool((low <= around_m).all() and (high >= -around_m).all())


def _column(places: FloatArray, half_width_m: float, top_m: float, clearance: float) -> tuple[FloatArray, float]:
    return (places @ NORMALS.T).max(axis=0) + half_width_m + clearance, top_m + clearance


def _span_pieces(span: Span) -> list[tuple[FloatArray, float]]:
    """Corners and top of each piece, as wide as the wires swing there, and as high as the straight line between the highest points."""
    start, end = np.array(span.start), np.array(span.end)
    length_m = float(np.linalg.norm(end - start))
    if length_m == 0.0:
        return []
    along = (end - start) / length_m
    right = np.array([along[1], -along[0]])
    pieces = []
    cuts_m = np.linspace(0.0, length_m, math.ceil(length_m / PIECE_M) + 1)
    for low_m, high_m in zip(cuts_m[:-1].tolist(), cuts_m[1:].tolist(), strict=True):
        swings_m = [_swing_m(span, at_m, length_m) for at_m in (low_m, high_m)]
        swing_m = _swing_m(span, length_m / 2.0, length_m) if low_m < length_m / 2.0 < high_m else max(swings_m)
        sides_m = (span.left_m - swing_m, span.right_m + swing_m)
        places = np.array([start + along * at_m + right * side_m for at_m in (low_m, high_m) for side_m in sides_m])
        tops_m = [span.start_top_m + (span.end_top_m - span.start_top_m) * at_m / length_m for at_m in (low_m, high_m)]
        pieces.append((places, max(tops_m)))
    return pieces


def _swing_m(span: Span, at_m: float, length_m: float) -> float:
    """By how much the lowest point of the wires' arc here moves to the side."""
    share = at_m / length_m
    return (4.0 * span.sag_m * share * (1.0 - share) + span.string_m) * math.sin(math.radians(SWING_DEG))


def _clips(start: FloatArray, end: FloatArray, bound: FloatArray, top_m: float) -> BoolArray:
    """Which lines have a part strictly inside of one convex column (Cyrus and Beck's clipping)."""
    normals = np.column_stack([np.vstack([NORMALS, [0.0, 0.0]]), np.append(np.zeros(DIRECTIONS), 1.0)])
    limit = np.append(bound, top_m)
    before = start @ normals.T - limit  # (n, planes), negative inside
    change = (end - start) @ normals.T
    outside = (before >= 0.0) & (change >= 0.0)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        share = -before / change
    enters = np.where(change < 0.0, share, 0.0).max(axis=1, initial=0.0)
    leaves = np.where(change > 0.0, share, 1.0).min(axis=1, initial=1.0)
    clipped: BoolArray = ~outside.any(axis=1) & (enters < leaves)
    return clipped
