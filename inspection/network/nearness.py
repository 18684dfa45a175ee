"""Which positions are near to one another, in metres, wherever on the globe."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from inspection.geodesy import distance_m

EARTH_RADIUS_M = 6_371_008.8  # IUGG mean radius
SPHERE_SLACK = 1.01  # a distance on the sphere is within 0.6 % of the geodesic on WGS84

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]


def on_unit_sphere(position: FloatArray) -> FloatArray:
    """Positions (n, 2) lon, lat [deg] as points (n, 3) on the unit sphere, where nearness has no seam."""
    lon, lat = np.radians(np.asarray(position, dtype=np.float64)).T
    return np.column_stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])


def chord(radius_m: float) -> float:
    """How far apart on the unit sphere what lies within the radius can be, with slack: filter by the geodesic afterwards."""
    return radius_m * SPHERE_SLACK / EARTH_RADIUS_M


def pairs_within(position: FloatArray, radius_m: float) -> IntArray:
    """Index pairs (m, 2), the smaller first, of positions at most the radius apart; sorted."""
    if len(position) < 2 or radius_m <= 0:
        return np.zeros((0, 2), dtype=np.int64)
    pairs = cKDTree(on_unit_sphere(position)).query_pairs(chord(radius_m), output_type="ndarray").astype(np.int64)
    pairs = pairs[distance_m(position[pairs[:, 0]], position[pairs[:, 1]]) <= radius_m]
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def nearest_within(position: FloatArray, others: FloatArray, radius_m: float, *, count: int = 1) -> tuple[IntArray, IntArray, FloatArray]:
    """For each position up to `count` of the others within the radius.

    Returns index of the position, index of the other, and metres; sorted by position, then metres, then index of the other.
    """
    if not len(position) or not len(others) or radius_m <= 0:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0)
    ranks = np.arange(1, min(count, len(others)) + 1)
    _, found = cKDTree(on_unit_sphere(others)).query(on_unit_sphere(position), k=ranks, distance_upper_bound=chord(radius_m))
    found = np.asarray(found, dtype=np.int64)
    row, rank = np.nonzero(found < len(others))
    other = found[row, rank]
    metres = distance_m(position[row], others[other])
    near = metres <= radius_m
    row, other, metres = row[near], other[near], metres[near]
    order = np.lexsort((other, metres, row))
    return row[order].astype(np.int64), other[order], metres[order]
