"""Distances for judges of plans, without the program's own geodesy."""

import math
from typing import Any

import numpy as np

EARTH_M = 6_371_008.8  # IUGG mean radius


def apart_m(start: Any, end: Any) -> float:
    """On the sphere of mean radius, by the haversine."""
    (lon, lat), (to_lon, to_lat) = np.radians(start), np.radians(end)
    share = math.sin((to_lat - lat) / 2) ** 2 + math.cos(lat) * math.cos(to_lat) * math.sin((to_lon - lon) / 2) ** 2
    return 2 * EARTH_M * math.asin(math.sqrt(share))


def east_north(start: Any, end: Any) -> tuple[float, float]:
    """Metres from one place to another on a plane that touches the sphere between them."""
    middle = math.radians((start[1] + end[1]) / 2)
    return math.radians(end[0] - start[0]) * EARTH_M * math.cos(middle), math.radians(end[1] - start[1]) * EARTH_M
