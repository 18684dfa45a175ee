"""How far a track was beside its route, worked out without the code that guides or scores: by geodesics to points close on the route."""

from itertools import pairwise

import numpy as np
from scipy.spatial import cKDTree

from inspection.geodesy import LonLat
from tests.simulation.flight.lists import EARTH

EACH_M = 0.1


def beside_m(track: np.ndarray, waypoints: list[LonLat]) -> np.ndarray:
    """Distance of each point of a track (n, 2) from the nearest of the points each 0.1 m along the route [m], (n,).

    The route is drawn straight in longitude and latitude. At most 2 mm too far where the track is within 0.6 m.
    """
    route = []
    for start, end in pairwise(waypoints):
        length_m = EARTH.inv(start.lon, start.lat, end.lon, end.lat)[2]
        route.append(np.linspace(start, end, max(int(length_m / EACH_M), 1) + 1))
    points = np.concatenate(route)
    scale = np.array([np.cos(np.radians(points[0, 1])), 1.0])  # only to find the nearest
    _, nearest = cKDTree(points * scale).query(track * scale)
    found = points[nearest]
    return np.asarray(EARTH.inv(track[:, 0], track[:, 1], found[:, 0], found[:, 1])[2])
