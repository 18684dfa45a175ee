"""A flat frame in metres around a place, for work over a few kilometres."""

from dataclasses import dataclass
from math import cos, radians, sin, sqrt

import numpy as np

from inspection.geodesy.wgs84 import WGS84, FloatArray, LonLat


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
