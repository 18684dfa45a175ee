"""Seconds that the turns of a drawn route take beside its legs: slowing down before a turn, rounding it, speeding up after it."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

CORNER_M = 1.3  # how far inside a waypoint it is rounded: ArduCopter's WPNAV_RADIUS is 2 m, PX4's NAV_ACC_RAD 10 m
STRAIGHT_COSINE = math.cos(1e-3)  # less of a turn is none
REVERSAL_RAD = math.radians(150.0)  # more of a turn is made standing
MIN_LEG_M = 0.05  # what is shorter is one place


@njit(cache=True, nogil=True)
def turning_s(
    leg_m: FloatArray, leg_s: FloatArray, is_stop: BoolArray, brake_s: FloatArray, acceleration_mps2: float, corner_mps2: float
) -> FloatArray:
    """Seconds that each leg takes beside its `leg_s` at one speed, (n,), at least 0.

    leg_m (n, 3) is how far each leg leads to east, north and up; leg_s (n,) are above 0 for legs with a length, and finite. is_stop
    (n + 1,) tells of each end of a leg whether the UAV stands there. `brake_s` (n,), for which that already counts at either end
    of a leg, is taken off.
    """
    count = len(leg_s)
    extra_s = np.zeros(count)
    if count == 0 or math.isinf(acceleration_mps2) or math.isinf(corner_mps2):
        return extra_s
    length_m, speed_mps, along = _courses(leg_m, leg_s)
    end_mps, taken_m, arc_m = _corners(length_m, speed_mps, along, is_stop, corner_mps2)
    # Each leg is half of the arc before it, a line, and half of the arc behind it.
    part_m, part_mps = np.empty(3 * count), np.empty(3 * count)
    node_mps = np.empty(3 * count + 1)
    node_mps[0::3] = end_mps
    for leg in range(count):
        line_m = max(length_m[leg] - taken_m[leg] - taken_m[leg + 1], 0.0)
        part_m[3 * leg], part_m[3 * leg + 1], part_m[3 * leg + 2] = 0.5 * arc_m[leg], line_m, 0.5 * arc_m[leg + 1]
        part_mps[3 * leg], part_mps[3 * leg + 1], part_mps[3 * leg + 2] = end_mps[leg], speed_mps[leg], end_mps[leg + 1]
        node_mps[3 * leg + 1], node_mps[3 * leg + 2] = end_mps[leg], end_mps[leg + 1]
    for part in range(3 * count):  # no faster than it can have become
        node_mps[part + 1] = min(node_mps[part + 1], math.sqrt(node_mps[part] ** 2 + 2.0 * acceleration_mps2 * part_m[part]))
    for part in range(3 * count - 1, -1, -1):  # and slow enough for what follows
        node_mps[part] = min(node_mps[part], math.sqrt(node_mps[part + 1] ** 2 + 2.0 * acceleration_mps2 * part_m[part]))
    for leg in range(count):
        if length_m[leg] == 0.0:
            continue
        seconds = 0.0
        for part in range(3 * leg, 3 * leg + 3):
            seconds += _line_s(part_m[part], node_mps[part], node_mps[part + 1], part_mps[part], acceleration_mps2)
        extra_s[leg] = max(seconds - leg_s[leg], 0.0)
    for end in range(count + 1):
        if is_stop[end]:
            if end > 0:
                _take_off_counted(extra_s, leg_m, end - 1, -1, brake_s[end - 1])
            if end < count:
                _take_off_counted(extra_s, leg_m, end, 1, brake_s[end])
    return extra_s


@njit(cache=True, nogil=True)
def _courses(leg_m: FloatArray, leg_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Length, speed and direction of each leg; one without a length has the speed and direction of the leg before it."""
    count = len(leg_s)
    length_m, speed_mps, along = np.zeros(count), np.zeros(count), np.zeros((count, 3))
    for leg in range(count):
        metres = math.sqrt(leg_m[leg, 0] ** 2 + leg_m[leg, 1] ** 2 + leg_m[leg, 2] ** 2)
        if metres >= MIN_LEG_M:
            length_m[leg], speed_mps[leg], along[leg] = metres, metres / leg_s[leg], leg_m[leg] / metres
        elif leg > 0:
            speed_mps[leg], along[leg] = speed_mps[leg - 1], along[leg - 1]
    return length_m, speed_mps, along


@njit(cache=True, nogil=True)
def _corners(
    length_m: FloatArray, speed_mps: FloatArray, along: FloatArray, is_stop: BoolArray, corner_mps2: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Speed at each end of a leg, metres that its arc takes of both legs, and the arc's length, (n + 1,) each.

    As wide as the speed needs, and as the waypoint and half of either leg leave room for.
    """
    count = len(length_m)
    end_mps, taken_m, arc_m = np.zeros(count + 1), np.zeros(count + 1), np.zeros(count + 1)
    if not is_stop[count]:
        end_mps[count] = speed_mps[count - 1]
    for end in range(1, count):
        if is_stop[end]:
            continue
        slower_mps = min(speed_mps[end - 1], speed_mps[end])
        one, other = along[end - 1], along[end]
        cosine = one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
        if cosine >= STRAIGHT_COSINE:
            end_mps[end] = slower_mps
            continue
        turn = math.acos(max(cosine, -1.0))
        if turn > REVERSAL_RAD or length_m[end - 1] == 0.0:
            continue
        tangent = math.tan(0.5 * turn)
        room_m = 0.5 * min(length_m[end - 1], length_m[end]) / tangent
        radius_m = min(CORNER_M / (1.0 / math.cos(0.5 * turn) - 1.0), slower_mps**2 / corner_mps2, room_m)
        end_mps[end] = min(slower_mps, math.sqrt(corner_mps2 * radius_m))
        taken_m[end], arc_m[end] = radius_m * tangent, radius_m * turn
    return end_mps, taken_m, arc_m


@njit(cache=True, nogil=True)
def _line_s(line_m: float, start_mps: float, end_mps: float, speed_mps: float, acceleration_mps2: float) -> float:
    """Seconds along a line: up to its speed, or to as much of it as there is room for, and down again."""
    if line_m <= 0.0:
        return 0.0
    peak_mps = min(speed_mps, math.sqrt(0.5 * (start_mps**2 + end_mps**2) + acceleration_mps2 * line_m))
    changing_s = (2.0 * peak_mps - start_mps - end_mps) / acceleration_mps2
    changing_m = (2.0 * peak_mps**2 - start_mps**2 - end_mps**2) / (2.0 * acceleration_mps2)
    return float(changing_s + max(line_m - changing_m, 0.0) / peak_mps)


@njit(cache=True, nogil=True)
def _take_off_counted(extra_s: FloatArray, leg_m: FloatArray, leg: int, step: int, counted_s: float) -> None:
    """Take seconds that a stop counts off the legs beside it: straight up and down, and the first that leads elsewhere."""
    while 0 <= leg < len(extra_s) and counted_s > 0.0:
        taken_s = min(extra_s[leg], counted_s)
        extra_s[leg] -= taken_s
        counted_s -= taken_s
        if math.hypot(leg_m[leg, 0], leg_m[leg, 1]) >= MIN_LEG_M:
            return
        leg += step
