"""What a flight to one node takes of time and battery beside the way along the network: access legs, climbs, and what is done there.

The arithmetic is that of `assignment_costs.py`, node by node instead of visit by visit, without knowing the ground's height.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy.local_frame import short_vector_m
from planning.energy.conditions import air_density
from planning.energy.leg_cost import Air, landing_taken, leg_taken, stay_taken, take_off_taken

FloatArray = NDArray[np.float64]

DONE, UP, LANDING_THERE = range(3)
TAKE_OFF, LANDING = range(2)


def both_directions(
    start: FloatArray, start_agl_m: FloatArray, end: FloatArray, end_agl_m: FloatArray, length_m: FloatArray, air: Air
) -> FloatArray:
    """Seconds and joules of legs from starts (k, 2) to ends (k, 2), and back: (k, 2, 2), endless where the wind is too strong.

    Heights are above ground; length_m is that of the leg, which is more than straight where it goes round something.
    """
    taken: FloatArray = _both_directions(start, start_agl_m, end, end_agl_m, length_m, air)
    return taken


def at_nodes(level_m: FloatArray, transit_agl_m: float, hold_s: FloatArray, air: Air) -> tuple[FloatArray, FloatArray]:
    """Seconds and joules (n, 3, 2) at nodes inspected at these heights above ground, and (2, 2) of take-off and landing.

    Of each node: the way down to it from transit height with what is done there; up again; the landing there.
    """
    done, columns = _at_nodes(level_m, float(transit_agl_m), hold_s, air)
    return done, columns


@njit(cache=True, nogil=True)
def _both_directions(
    start: FloatArray, start_agl_m: FloatArray, end: FloatArray, end_agl_m: FloatArray, length_m: FloatArray, air: Air
) -> FloatArray:
    taken = np.empty((len(start), 2, 2))
    density = air_density(0.0, air.temperature_c)
    for leg in range(len(start)):
        east, north = short_vector_m(start[leg, 0], start[leg, 1], end[leg, 0], end[leg, 1])
        straight_m = math.hypot(east, north)
        if straight_m > 0.0:
            east, north = east / straight_m, north / straight_m
        rise_m = end_agl_m[leg] - start_agl_m[leg]
        for way in range(2):
            sign = 1.0 - 2.0 * way
            taken[leg, way, 0], taken[leg, way, 1] = leg_taken(
                length_m[leg], sign * east, sign * north, start_agl_m[leg], end_agl_m[leg], sign * rise_m, density, air
            )
    return taken


@njit(cache=True, nogil=True)
def _at_nodes(level_m: FloatArray, transit_m: float, hold_s: FloatArray, air: Air) -> tuple[FloatArray, FloatArray]:
    taken, columns = np.empty((len(level_m), 3, 2)), np.empty((2, 2))
    density = air_density(0.0, air.temperature_c)
    columns[0, 0], columns[0, 1] = leg_taken(0.0, 0.0, 0.0, 0.0, transit_m, transit_m, density, air)
    columns[1, 0], columns[1, 1] = leg_taken(0.0, 0.0, 0.0, transit_m, 0.0, -transit_m, density, air)
    lifting, touching = take_off_taken(transit_m, density, air), landing_taken(transit_m, density, air)
    for part in range(2):
        columns[TAKE_OFF, part] += lifting[part]
        columns[LANDING, part] += touching[part]
    for node in range(len(level_m)):
        level = level_m[node]
        if node > 0 and level == level_m[node - 1] and hold_s[node] == hold_s[node - 1]:
            taken[node] = taken[node - 1]
            continue
        low_m = min(level, transit_m)
        held_s, held_j = stay_taken(hold_s[node], level, density, air)
        down_s, down_j = leg_taken(0.0, 0.0, 0.0, transit_m, low_m, low_m - transit_m, density, air)
        taken[node, 0, 0], taken[node, 0, 1] = held_s + down_s, held_j + down_j
        up = leg_taken(0.0, 0.0, 0.0, low_m, transit_m, transit_m - low_m, density, air)
        landing = leg_taken(0.0, 0.0, 0.0, level, 0.0, -level, density, air)
        touching = landing_taken(level, density, air)
        taken[node, 1, 0], taken[node, 1, 1] = up
        taken[node, 2, 0], taken[node, 2, 1] = landing[0] + touching[0], landing[1] + touching[1]
    return taken, columns
