"""Places along a line, at which the ground is looked at."""

from dataclasses import dataclass
from math import ceil

import numpy as np

from inspection.geodesy.wgs84 import FloatArray, distance_m

MOST_SAMPLES = 5_000
LEAST_STEP_M = 1.0


@dataclass(frozen=True, eq=False)
class Samples:
    """distance_m of shape (n,) along the line, positions of shape (n, 2), lon lat [deg]; every vertex of the line is one of them."""

    distance_m: FloatArray
    positions: FloatArray


def samples_along(line: FloatArray, step_m: float) -> Samples:
    """Places on the line of shape (k, 2), k ≥ 2, straight in longitude and latitude between vertices, no farther apart than step_m.

    The step is widened where that would be more than MOST_SAMPLES.
    """
    lengths_m = distance_m(line[:-1], line[1:])
    step_m = max(step_m, LEAST_STEP_M, float(lengths_m.sum()) / max(MOST_SAMPLES - len(line), 1))
    distances, places = [np.zeros(1)], [line[:1]]
    before_m = 0.0
    for start, end, length_m in zip(line[:-1], line[1:], lengths_m.tolist(), strict=True):
        shares = np.arange(1, max(1, ceil(length_m / step_m)) + 1) / max(1, ceil(length_m / step_m))
        distances.append(before_m + shares * length_m)
        places.append(start + shares[:, None] * (end - start))
        before_m += length_m
    return Samples(np.concatenate(distances), np.concatenate(places))
