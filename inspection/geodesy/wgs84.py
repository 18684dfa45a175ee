"""Geodesic distances on WGS84."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pyproj import Geod

WGS84 = Geod(ellps="WGS84")

FloatArray = NDArray[np.float64]


class LonLat(NamedTuple):
    """A position: longitude first, degrees, WGS84."""

    lon: float
    lat: float


def distance_m(start: FloatArray, end: FloatArray) -> FloatArray:
    """Geodesic distance between each pair of rows; both of shape (n, 2), columns lon, lat [deg]; returns shape (n,) [m]."""
    start, end = np.atleast_2d(start), np.atleast_2d(end)
    if len(start) == 0:
        return np.zeros(0)
    _, _, metres = WGS84.inv(start[:, 0], start[:, 1], end[:, 0], end[:, 1])
    return np.asarray(metres, dtype=np.float64)


def path_length_m(points: FloatArray) -> float:
    """Geodesic length of a path of shape (n, 2), columns lon, lat [deg]; 0 for fewer than two points."""
    points = np.asarray(points, dtype=np.float64)
    return float(distance_m(points[:-1], points[1:]).sum()) if len(points) > 1 else 0.0
