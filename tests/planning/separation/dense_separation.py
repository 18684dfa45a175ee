"""How near UAVs come, by looking at where each of them is every fraction of a second. Shares no code with what it checks."""

from itertools import pairwise

import numpy as np

METRES_PER_DEGREE = 111_195.0  # of latitude; used around the equator, where a degree of longitude is as long within 0.7 %


def moments_of(route, step_s, hover_s):
    """Columns time [s], east, north and height [m] of a route from take-off to landing; a hover at the end lasts hover_s."""
    knots = [(route.take_off_s, *route.position[0], route.take_off_m)]
    for place, arrival_s, hold_s, height_m in zip(route.position, route.arrival_s, route.hold_s, route.height_m, strict=True):
        knots += [(arrival_s, *place, height_m), (arrival_s + hold_s, *place, height_m)]
    end_s = knots[-1][0] + hover_s if route.lands_s is None else route.lands_s
    knots.append((end_s, *route.position[-1], route.height_m[-1] if route.lands_s is None else route.landing_m))
    seen = []
    for (from_s, *here), (to_s, *there) in pairwise(knots):
        count = max(1, int(np.ceil((to_s - from_s) / step_s)))
        share = np.arange(count + 1)[:, None] / count
        seen.append(np.hstack([from_s + share * (to_s - from_s), here + share * (np.array(there) - here)]))
    moments = np.concatenate(seen)
    moments[:, 1:3] *= METRES_PER_DEGREE
    return moments


def least_seconds_apart(one, other, lateral_m, vertical_m):
    """The least time between a moment of one and a moment of the other at which their places lie within both limits; inf for none."""
    least_s = np.inf
    for time_s, east_m, north_m, height_m in one:
        near = np.hypot(other[:, 1] - east_m, other[:, 2] - north_m) < lateral_m
        near &= ~(np.abs(other[:, 3] - height_m) >= vertical_m)  # an unknown height is near to all
        if near.any():
            least_s = min(least_s, np.abs(other[near, 0] - time_s).min())
    return float(least_s)
