"""Which of two UAVs that come near each other is best held, and why: after the rules of the air for converging aircraft.

Regulation (EU) No 923/2012, SERA.3210 (c): who has the other on its right gives way; who overtakes keeps clear.
"""

import math
from enum import StrEnum
from typing import NamedTuple

STANDS_BELOW_MPS = 1.0
CLIMBS_ABOVE_MPS = 0.7
SAME_COURSE_DEG, HEAD_ON_DEG = 60.0, 150.0
HIGHER_M = 2.0


class Why(StrEnum):
    CLIMBS = "it climbs towards the other one"
    OTHER_STANDS = "the other one stands still"
    BEHIND = "it is behind"
    HIGHER = "it is higher"
    ON_ITS_RIGHT = "it has the other one on its right"
    EITHER = "either can be held"


class Flying(NamedTuple):
    """Place (east, north) [m], height [m], NaN: not known, and velocity [m/s]."""

    east_m: float
    north_m: float
    height_m: float
    east_mps: float
    north_mps: float
    climb_mps: float

    @property
    def speed_mps(self) -> float:
        return math.hypot(self.east_mps, self.north_mps)


def yielding(first: Flying, second: Flying) -> tuple[bool, Why]:
    """Return whether it is the first one that gives way, and why."""
    first_stands, second_stands = first.speed_mps < STANDS_BELOW_MPS, second.speed_mps < STANDS_BELOW_MPS
    for is_first, one, stands in ((True, first, first_stands), (False, second, second_stands)):
        if stands and one.climb_mps > CLIMBS_ABOVE_MPS:
            return is_first, Why.CLIMBS
    if first_stands != second_stands:
        return second_stands, Why.OTHER_STANDS
    if first_stands:
        return _higher(first, second)
    turn_deg = _angle_deg((first.east_mps, first.north_mps), (second.east_mps, second.north_mps))
    bearing_deg = _angle_deg((first.east_mps, first.north_mps), (second.east_m - first.east_m, second.north_m - first.north_m))
    if abs(turn_deg) < SAME_COURSE_DEG:
        return abs(bearing_deg) < 90.0, Why.BEHIND
    if abs(turn_deg) > HEAD_ON_DEG:
        return _higher(first, second)
    return bearing_deg > 0.0, Why.ON_ITS_RIGHT


def _higher(first: Flying, second: Flying) -> tuple[bool, Why]:
    above_m = first.height_m - second.height_m
    if math.isnan(above_m) or abs(above_m) < HIGHER_M:
        return False, Why.EITHER
    return above_m > 0.0, Why.HIGHER


def _angle_deg(one: tuple[float, float], other: tuple[float, float]) -> float:
    """From one direction to another, clockwise, -180 to 180."""
    turned = math.degrees(math.atan2(*other) - math.atan2(*one))
    return (turned + 180.0) % 360.0 - 180.0
