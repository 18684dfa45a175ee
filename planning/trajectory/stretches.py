"""Places and stretches on a line or railway."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat, distance_m
from inspection.geodesy.local_frame import LocalFrame

FloatArray = NDArray[np.float64]


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
