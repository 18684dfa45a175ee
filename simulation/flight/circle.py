"""A circle as a chain of points."""

import math

from simulation.flight.course import Vector

INSIDE_M = 0.1  # by which the chords may lie inside the circle
WIDEST_RAD = math.radians(15.0)  # of one chord


def around(centre: Vector, start: Vector, turns: float, radius_m: float) -> list[Vector]:
    """From the point nearest to `start`, at the height of the centre, clockwise from above, with a radius below 0 the other way.

    The first point is also the only one where there is nothing to turn.
    """
    radius = abs(radius_m)
    begin = math.atan2(start[0] - centre[0], start[1] - centre[1])
    whole = 2.0 * math.pi * turns
    widest = min(WIDEST_RAD, 2.0 * math.acos(max(1.0 - INSIDE_M / radius, 0.0))) if radius > 0.0 else whole
    chords = max(math.ceil(whole / widest), 1) if whole > 0.0 and radius > 0.0 else 0
    step = math.copysign(whole / chords, radius_m) if chords else 0.0
    bearings = [begin + step * number for number in range(chords + 1)]
    return [(centre[0] + radius * math.sin(bearing), centre[1] + radius * math.cos(bearing), centre[2]) for bearing in bearings]
