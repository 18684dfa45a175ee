"""Places along a line, at which the ground is looked at, and where it lies in an area."""

from dataclasses import dataclass
from math import ceil

import numpy as np
import shapely

from inspection.geodesy.wgs84 import FloatArray, distance_m

MAX_SAMPLES = 5_000
MIN_STEP_M = 1.0
SAME_PLACE_M = 0.01


@dataclass(frozen=True, eq=False)
class Samples:
    """distance_m of shape (n,) along the line, positions of shape (n, 2), lon lat [deg]; every vertex of the line is one of them."""

    distance_m: FloatArray
    positions: FloatArray


def samples_along(line: FloatArray, step_m: float) -> Samples:
    """Places on the line of shape (k, 2), k ≥ 2, straight in longitude and latitude between vertices, no farther apart than step_m.

    The step is widened where that would be more than MAX_SAMPLES.
    """
    lengths_m = distance_m(line[:-1], line[1:])
    step_m = max(step_m, MIN_STEP_M, float(lengths_m.sum()) / max(MAX_SAMPLES - len(line), 1))
    distances, places = [np.zeros(1)], [line[:1]]
    before_m = 0.0
    for start, end, length_m in zip(line[:-1], line[1:], lengths_m.tolist(), strict=True):
        shares = np.arange(1, max(1, ceil(length_m / step_m)) + 1) / max(1, ceil(length_m / step_m))
        distances.append(before_m + shares * length_m)
        places.append(start + shares[:, None] * (end - start))
        before_m += length_m
    return Samples(np.concatenate(distances), np.concatenate(places))


def stretches_inside(line: FloatArray, area: shapely.Geometry) -> list[tuple[float, float]]:
    """From where to where along the line [m] it lies in the area; stretches that meet at a vertex are one."""
    legs = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    lengths_m = distance_m(line[:-1], line[1:])
    before_m = np.concatenate([[0.0], np.cumsum(lengths_m)])
    shapely.prepare(area)
    found: list[tuple[float, float]] = []
    for leg in np.flatnonzero(shapely.intersects(legs, area) & (lengths_m > 0)).tolist():
        for part in shapely.get_parts(shapely.intersection(shapely.LineString(line[leg : leg + 2]), area)).tolist():
            ends = shapely.get_coordinates(part)[[0, -1]] - line[leg]
            along = line[leg + 1] - line[leg]
            shares = np.sort(np.clip(ends @ along / (along @ along), 0.0, 1.0))
            from_m, to_m = (float(before_m[leg] + share * lengths_m[leg]) for share in shares)
            if found and from_m - found[-1][1] < SAME_PLACE_M:
                found[-1] = found[-1][0], max(to_m, found[-1][1])
            else:
                found.append((from_m, to_m))
    return found
