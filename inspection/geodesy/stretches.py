"""Places and stretches on a line or railway, and its parts that UAVs can share."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat, distance_m
from inspection.geodesy.local_frame import LocalFrame

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MAX_PARTS = 24  # of one line: a mission takes 500 targets
SAME_LENGTH_M = 0.1
NEAR, NEAR_STRAIGHT = 0.5, 0.3  # of a part's length: how far from its wanted place it is cut at a support, and where the line is straight
STRAIGHT_DEG = 3.0


@dataclass(frozen=True)
class PlaceOnLine:
    """The point of a line that is nearest to a position; `share` is how far along the segment it lies, from 0 to 1."""

    segment: int
    share: float
    position: LonLat
    distance_m: float


def nearest_on_line(line: FloatArray, position: LonLat) -> PlaceOnLine:
    """line has shape (n, 2), n >= 2, columns lon, lat [deg]. Near the position the answer is right to 0.1 %."""
    frame = LocalFrame.around(position.lon, position.lat)
    metres = frame.to_metres(line)  # the position is the origin
    start, along = metres[:-1], np.diff(metres, axis=0)
    squared = (along**2).sum(axis=1)
    share = np.clip(-(start * along).sum(axis=1) / np.where(squared > 0, squared, 1.0), 0.0, 1.0)
    gap_m = np.hypot(*(start + share[:, None] * along).T)
    segment = int(gap_m.argmin())
    at = line[segment] + share[segment] * (line[segment + 1] - line[segment])
    place = LonLat(float(at[0]), float(at[1]))
    return PlaceOnLine(segment, float(share[segment]), place, float(distance_m(np.array(place), np.array(position))[0]))


def stretch_between(line: FloatArray, first: PlaceOnLine, second: PlaceOnLine) -> tuple[LonLat, ...]:
    """The line's course between two places on it, in the line's own direction, without repeated points."""
    if (second.segment, second.share) < (first.segment, first.share):
        first, second = second, first
    inner = line[first.segment + 1 : second.segment + 1]
    course = [first.position, *(LonLat(float(lon), float(lat)) for lon, lat in inner), second.position]
    return tuple(place for number, place in enumerate(course) if number == 0 or place != course[number - 1])


@dataclass(frozen=True)
class LinePart:
    """A part of a line; from_m and to_m are along the line, from its first vertex."""

    start: LonLat
    end: LonLat
    from_m: float
    to_m: float

    @property
    def length_m(self) -> float:
        return self.to_m - self.from_m


def part_count(length_m: float, part_m: float) -> int:
    """Return into how many parts of about `part_m` metres a length is divided, from 1 to MAX_PARTS."""
    return max(1, min(MAX_PARTS, round(length_m / part_m)))


def line_end(line: FloatArray, which: int) -> PlaceOnLine:
    """Return the first place of a line (0) or the last one (-1)."""
    at = LonLat(float(line[which][0]), float(line[which][1]))
    return PlaceOnLine(0, 0.0, at, 0.0) if which == 0 else PlaceOnLine(len(line) - 2, 1.0, at, 0.0)


def vertex_lengths_m(line: FloatArray) -> FloatArray:
    """Return how far along a line each vertex lies, metres."""
    return np.concatenate([[0.0], np.cumsum(distance_m(line[:-1], line[1:]))])


def part_between(line: FloatArray, first: PlaceOnLine, second: PlaceOnLine, vertex_m: FloatArray | None = None) -> LinePart:
    """Return the part of a line between two places on it, in the line's direction. vertex_m: as of vertex_lengths_m, if it is known."""
    if (second.segment, second.share) < (first.segment, first.share):
        first, second = second, first
    lengths_m = vertex_lengths_m(line) if vertex_m is None else vertex_m
    from_m, to_m = (
        float(lengths_m[place.segment] + distance_m(line[place.segment], np.array(place.position))[0]) for place in (first, second)
    )
    return LinePart(first.position, second.position, from_m, to_m)


def place_along(line: FloatArray, vertex_m: FloatArray, along_m: float) -> LonLat:
    """Return the place of a line that lies so far along it; vertex_m: as of vertex_lengths_m."""
    lon, lat = (float(np.interp(along_m, vertex_m, line[:, column])) for column in (0, 1))
    return LonLat(lon, lat)


def newest_along(parts: Sequence[tuple[float, float]], length_m: float) -> list[tuple[float, float, int | None]]:
    """Return a line in pieces from its first vertex to its last: from [m], to [m], and the number of the last part that covers it.

    parts: from and to along the line, metres, oldest first; None is what no part covers. Pieces under SAME_LENGTH_M join a piece beside.
    """
    ends_m = np.unique(np.clip([0.0, length_m, *(end_m for part in parts for end_m in part)], 0.0, length_m))
    if len(ends_m) < 2:
        return [(0.0, length_m, len(parts) - 1 if parts else None)]
    newest = np.full(len(ends_m) - 1, -1)
    for number, part in enumerate(parts):
        first, last = np.searchsorted(ends_m, np.clip(sorted(part), 0.0, length_m))
        newest[first:last] = number
    pieces: list[tuple[float, float, int | None]] = []
    for (from_m, to_m), number in zip(pairwise(ends_m.tolist()), newest.tolist(), strict=True):
        covered_by = None if number < 0 else number
        if pieces and (covered_by == pieces[-1][2] or to_m - from_m < SAME_LENGTH_M):
            pieces[-1] = (pieces[-1][0], to_m, pieces[-1][2])
        elif pieces and pieces[-1][1] - pieces[-1][0] < SAME_LENGTH_M:  # the first one
            pieces[-1] = (pieces[-1][0], to_m, covered_by)
        else:
            pieces.append((from_m, to_m, covered_by))
    return pieces


def parts_of_line(
    line: FloatArray, part_m: float, *, ends: tuple[PlaceOnLine, PlaceOnLine] | None = None, at: Sequence[int] | IntArray = ()
) -> list[LinePart]:
    """Return a line, or its stretch between two places, cut at vertices into at most MAX_PARTS parts of about `part_m` metres.

    at: the vertices where it is cut if they are near, such as those with a support; else it is cut at any. Vertices where the line goes
    straight on come first: a UAV slows down where one part ends and the next begins in another direction. A stretch is stored as its two
    ends: where these would lead to another part, as on a line that meets itself, the whole is returned as one part.
    """
    vertex_m = vertex_lengths_m(line)
    whole = part_between(line, *(ends or (line_end(line, 0), line_end(line, -1))), vertex_m)
    count = part_count(whole.length_m, part_m)
    inside = np.flatnonzero((vertex_m > whole.from_m + SAME_LENGTH_M) & (vertex_m < whole.to_m - SAME_LENGTH_M))
    if count < 2 or not len(inside):
        return [whole]
    wanted_m = whole.from_m + whole.length_m * np.arange(1, count) / count
    nearest = _nearest(vertex_m, inside, wanted_m)
    supports = np.intersect1d(inside, np.asarray(at, dtype=np.int64))
    straight = _straight_vertices(line)
    usual = supports if len(supports) else inside
    for preferred, within in ((supports, NEAR), (np.intersect1d(usual, straight), NEAR_STRAIGHT)):
        if len(preferred):
            found = _nearest(vertex_m, preferred, wanted_m)
            is_near = np.abs(vertex_m[found] - wanted_m) < within * whole.length_m / count
            nearest = np.where(is_near, found, nearest)
    cuts = np.unique(nearest)
    places = [whole.start, *(LonLat(float(lon), float(lat)) for lon, lat in line[cuts]), whole.end]
    lengths_m = [whole.from_m, *vertex_m[cuts].tolist(), whole.to_m]
    parts = [LinePart(*places_of, *along_m) for places_of, along_m in zip(pairwise(places), pairwise(lengths_m), strict=True)]
    return parts if all(leads_back(line, vertex_m, part) for part in parts) else [whole]


def _straight_vertices(line: FloatArray) -> IntArray:
    """Return the vertices at which a line goes on in about the same direction, in order."""
    east = np.diff(line[:, 0]) * np.cos(np.radians(line[:-1, 1]))
    turn_deg = np.degrees(np.diff(np.arctan2(east, np.diff(line[:, 1]))))
    return 1 + np.flatnonzero(np.abs((turn_deg + 180.0) % 360.0 - 180.0) <= STRAIGHT_DEG)


def _nearest(vertex_m: FloatArray, candidates: IntArray, wanted_m: FloatArray) -> IntArray:
    """Return for each length the candidate that is nearest to it, (n,); candidates are in order."""
    found: IntArray = candidates[np.abs(vertex_m[candidates] - wanted_m[:, None]).argmin(axis=1)]
    return found


def leads_back(line: FloatArray, vertex_m: FloatArray, part: LinePart) -> bool:
    """Return whether the ends of the part, looked up on the line, give the part itself: not always where a line meets itself."""
    found = part_between(line, nearest_on_line(line, part.start), nearest_on_line(line, part.end), vertex_m)
    return abs(found.from_m - part.from_m) < SAME_LENGTH_M and abs(found.to_m - part.to_m) < SAME_LENGTH_M
