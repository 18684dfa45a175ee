"""A timed route as straight pieces in place, height and time: the columns of `closest_approach`."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LON, LAT, HEIGHT, ARRIVAL, HOLD, ON_GROUND = range(6)  # columns of a route's table, as TimedRoute has them, a row for each waypoint
FOREVER_S = 1e7  # a UAV that hovers at its end keeps its place for so long, 115 days: no wait is longer
QUICKEST_S = 1e-6  # what a change of place takes at least


@njit(cache=True, nogil=True)
def runs_on(table: FloatArray, take_off_s: float, lands_s: float) -> bool:
    """Whether the times of a route are known and none is before the last; lands_s NaN where it hovers at its end."""
    now_s = take_off_s
    for place in range(len(table)):
        arrival_s, hold_s = table[place, ARRIVAL], table[place, HOLD]
        if not (arrival_s - now_s >= -QUICKEST_S and hold_s >= -QUICKEST_S):
            return False
        now_s = arrival_s + hold_s
    return bool(math.isnan(lands_s) or lands_s - now_s >= -QUICKEST_S)


@njit(cache=True, nogil=True)
def _near_lon(lon: float, about_lon: float) -> float:
    return about_lon + (lon - about_lon + 180.0) % 360.0 - 180.0


@njit(cache=True, nogil=True)
def route_pieces(
    table: FloatArray, take_off_s: float, take_off_m: float, lands_s: float, landing_m: float, about_lon: float
) -> tuple[FloatArray, IntArray]:
    """The climb after take-off, each hold and leg, and the descent or hover at the end: (k, 8), each of which lasts some time.

    lands_s is NaN where it hovers at its end for ever. Longitudes are taken within 180 degrees of about_lon where those of the route are
    not. With each piece's leg, (k,): leg i leads from waypoint i to the next; the climb belongs to the first, the end to the last.
    """
    count = len(table)
    pieces, leg = np.empty((2 * count + 1, 8)), np.empty(2 * count + 1, dtype=np.int64)
    size = 0
    is_far_round = False
    for place in range(count):
        is_far_round = is_far_round or abs(table[place, LON] - about_lon) > 180.0
    for number in range(-1, 2 * count):  # the climb; by turns the hold at a waypoint and the leg to the next; the end
        here = max(number, 0) // 2
        there = here
        from_m = to_m = table[here, HEIGHT]
        leaves_s = table[here, ARRIVAL] + table[here, HOLD]
        begin_s, end_s = leaves_s, leaves_s + FOREVER_S
        if number == -1:
            from_m, begin_s, end_s = take_off_m, take_off_s, table[0, ARRIVAL]
        elif number % 2 == 0:
            begin_s, end_s = table[here, ARRIVAL], leaves_s
            if table[here, ON_GROUND] != 0.0:
                continue
        elif here < count - 1:
            there = here + 1
            to_m, end_s = table[there, HEIGHT], max(table[there, ARRIVAL], leaves_s + QUICKEST_S)
        elif not math.isnan(lands_s):
            to_m, end_s = landing_m, lands_s
        if not end_s > begin_s:
            continue
        piece = pieces[size]
        piece[0], piece[1], piece[2], piece[3] = table[here, LON], table[here, LAT], from_m, begin_s
        piece[4], piece[5], piece[6], piece[7] = table[there, LON], table[there, LAT], to_m, end_s
        if is_far_round:
            piece[0], piece[4] = _near_lon(piece[0], about_lon), _near_lon(piece[4], about_lon)
        leg[size] = min(here, max(count - 2, 0))
        size += 1
    return pieces[:size], leg[:size]
