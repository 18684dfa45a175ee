"""Geodesic distances on WGS84."""

import math
from typing import NamedTuple

import numpy as np
from numba import float64, njit, types
from numpy.typing import NDArray
from pyproj import Geod

WGS84 = Geod(ellps="WGS84")
MAJOR_M, FLATTENING = 6_378_137.0, 1 / 298.257223563  # NIMA TR8350.2
MINOR_M = MAJOR_M * (1 - FLATTENING)
SHORT_DEG = 1.0  # up to here Vincenty's series is right to a millionth of a metre
MAX_ROUNDS = 12

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
    metres: FloatArray
    metres, is_short = _short_distances_m(np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64))
    if not is_short:
        _, _, metres = WGS84.inv(start[:, 0], start[:, 1], end[:, 0], end[:, 1])
    return np.asarray(metres, dtype=np.float64)


_ROWS = types.Array(float64, 2, "A", readonly=True)  # mapped and broadcast arrays, too


@njit(cache=True, nogil=True)
def short_distance_m(lon_1: float, lat_1: float, lon_2: float, lat_2: float) -> float:
    """Geodesic distance between two positions [deg]; for compiled code, which knows that they are near to one another.

    Source: T. Vincenty, Direct and Inverse Solutions of Geodesics on the Ellipsoid, Survey Review 23 (1975).
    """
    lon = math.radians(lon_2 - lon_1)
    tan_1 = (1 - FLATTENING) * math.tan(math.radians(lat_1))
    tan_2 = (1 - FLATTENING) * math.tan(math.radians(lat_2))
    cos_1, cos_2 = 1 / math.sqrt(1 + tan_1 * tan_1), 1 / math.sqrt(1 + tan_2 * tan_2)
    sin_1, sin_2 = tan_1 * cos_1, tan_2 * cos_2
    # sin(U2 - U1) in a form that does not cancel where both are near
    sin_gap = cos_1 * cos_2 * (tan_2 - tan_1)
    on_sphere = lon * (1 + FLATTENING * cos_1 * cos_2)  # which is nearly it for a short way
    for _ in range(MAX_ROUNDS):
        sin_half = math.sin(on_sphere / 2)
        bow = 2 * sin_half * sin_half
        across, along = cos_2 * math.sin(on_sphere), sin_gap + sin_1 * cos_2 * bow
        sin_arc = math.sqrt(across * across + along * along)
        if sin_arc == 0:
            return 0.0
        cos_arc = sin_1 * sin_2 + cos_1 * cos_2 * (1 - bow)
        arc = math.atan2(sin_arc, cos_arc)
        sin_azimuth = cos_1 * across / sin_arc
        cos2_azimuth = 1 - sin_azimuth * sin_azimuth
        cos_middle = cos_arc - 2 * sin_1 * sin_2 / cos2_azimuth if cos2_azimuth > 1e-15 else 0.0
        part = FLATTENING / 16 * cos2_azimuth * (4 + FLATTENING * (4 - 3 * cos2_azimuth))
        twist = cos_middle + part * cos_arc * (2 * cos_middle * cos_middle - 1)
        before = on_sphere
        on_sphere = lon + (1 - part) * FLATTENING * sin_azimuth * (arc + part * sin_arc * twist)
        if abs(on_sphere - before) < 1e-14:
            break
    squeeze = cos2_azimuth * (MAJOR_M * MAJOR_M - MINOR_M * MINOR_M) / (MINOR_M * MINOR_M)
    scale = 1 + squeeze / 16_384 * (4_096 + squeeze * (-768 + squeeze * (320 - 175 * squeeze)))
    wave = squeeze / 1_024 * (256 + squeeze * (-128 + squeeze * (74 - 47 * squeeze)))
    inner = cos_arc * (2 * cos_middle * cos_middle - 1) - wave / 6 * cos_middle * (4 * sin_arc * sin_arc - 3) * (
        4 * cos_middle * cos_middle - 3
    )
    return MINOR_M * scale * (arc - wave * sin_arc * (cos_middle + wave / 4 * inner))


@njit([(_ROWS, _ROWS)], cache=True, nogil=True)
def _short_distances_m(start: FloatArray, end: FloatArray) -> tuple[FloatArray, bool]:
    """The distances, and whether all are short enough for them to be right."""
    metres = np.empty(len(start))
    for pair in range(len(start)):
        if not (abs(end[pair, 0] - start[pair, 0]) <= SHORT_DEG and abs(end[pair, 1] - start[pair, 1]) <= SHORT_DEG):
            return metres, False
        metres[pair] = short_distance_m(start[pair, 0], start[pair, 1], end[pair, 0], end[pair, 1])
    return metres, True


def path_length_m(points: FloatArray) -> float:
    """Geodesic length of a path of shape (n, 2), columns lon, lat [deg]; 0 for fewer than two points."""
    points = np.asarray(points, dtype=np.float64)
    return float(distance_m(points[:-1], points[1:]).sum()) if len(points) > 1 else 0.0
