"""Course through waypoints as lines and rounded corners, with the speed limit of each piece.

Lengths are metres in the east/north/up frame of the home. A corner is an arc that passes the waypoint within `corner_m`. Sharp turns are
thus flown slowly and slight ones fast; a reversal stops at the waypoint.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

Vector = tuple[float, float, float]

CORNER_M = 1.3  # how far inside a waypoint a corner may pass; ArduCopter's WPNAV_RADIUS is 2 m, PX4's NAV_ACC_RAD 10 m
STRAIGHT_RAD = 1e-3  # smaller turns are straight
REVERSAL_RAD = math.radians(150.0)  # larger turns are made at a stop
MIN_LEG_M = 0.05


@dataclass(frozen=True, slots=True)
class Via:
    """A point to fly to, at this ground speed. `mark` is reported when it is passed."""

    place: Vector
    speed_mps: float
    mark: int | None = None


@dataclass(frozen=True, slots=True)
class SpeedLimits:
    """Limits of the airframe."""

    climb_mps: float
    descent_mps: float
    acceleration_mps2: float
    corner_mps2: float


@dataclass(frozen=True, slots=True)
class Piece:
    """A line (radius 0) or an arc. `along` is its direction at the start; `inward` points to an arc's centre."""

    start: Vector
    along: Vector
    inward: Vector
    radius_m: float
    length_m: float
    fastest_mps: float
    end_mps: float  # maximum speed at its end
    mark: int | None  # reported at the middle of an arc, or at the end of a line

    def at(self, s_m: float) -> tuple[Vector, Vector, float]:
        """Return place, direction and curvature [1/m] after `s_m` metres."""
        if self.radius_m == 0.0:
            (x, y, z), (u, v, w) = self.start, self.along
            return (x + u * s_m, y + v * s_m, z + w * s_m), self.along, 0.0
        turned = s_m / self.radius_m
        sin, cos = math.sin(turned), math.cos(turned)
        r_sin, r_cos = self.radius_m * sin, self.radius_m * (1.0 - cos)
        (x, y, z), (u, v, w), (a, b, c) = self.start, self.along, self.inward
        place = (x + r_sin * u + r_cos * a, y + r_sin * v + r_cos * b, z + r_sin * w + r_cos * c)
        return place, (cos * u + sin * a, cos * v + sin * b, cos * w + sin * c), 1.0 / self.radius_m

    def bend(self, s_m: float) -> Vector:
        """Return the unit vector to the arc's centre after `s_m` metres."""
        turned = s_m / self.radius_m
        sin, cos = math.sin(turned), math.cos(turned)
        (u, v, w), (a, b, c) = self.along, self.inward
        return cos * a - sin * u, cos * b - sin * v, cos * c - sin * w


@dataclass(frozen=True, slots=True)
class _Leg:
    start: Vector
    along: Vector
    length_m: float
    fastest_mps: float
    mark: int | None


@dataclass(frozen=True, slots=True)
class _Corner:
    """Between two legs: the length that it takes from both, and its speed. Radius 0: no arc."""

    taken_m: float
    radius_m: float
    speed_mps: float
    turn_rad: float


def course(start: Vector, vias: Sequence[Via], speed_limits: SpeedLimits) -> tuple[Piece, ...]:
    """Return the course from `start` through all `vias` to a stop at the last. Coincident points are passed together, with all marks."""
    legs = _legs(start, vias, speed_limits)
    pieces: list[Piece] = []
    cut_m = 0.0  # length of this leg that the previous corner uses
    for number, leg in enumerate(legs):
        follows = legs[number + 1] if number + 1 < len(legs) else None
        corner = None if follows is None else _corner(leg, follows, speed_limits)
        taken_m = 0.0 if corner is None else corner.taken_m
        line_m = max(leg.length_m - cut_m - taken_m, 0.0)
        is_rounded = corner is not None and corner.radius_m > 0.0
        end_mps = 0.0 if corner is None else corner.speed_mps
        mark = None if is_rounded else leg.mark
        pieces.append(Piece(_ahead(leg.start, leg.along, cut_m), leg.along, leg.along, 0.0, line_m, leg.fastest_mps, end_mps, mark))
        if follows is not None and corner is not None and is_rounded:
            begin = _ahead(leg.start, leg.along, leg.length_m - corner.taken_m)
            inward = _inward(leg.along, follows.along, corner.turn_rad)
            length_m = corner.radius_m * corner.turn_rad
            pieces.append(Piece(begin, leg.along, inward, corner.radius_m, length_m, corner.speed_mps, corner.speed_mps, leg.mark))
        cut_m = taken_m
    return _slowed_in_time(pieces, speed_limits.acceleration_mps2)


def _legs(start: Vector, vias: Sequence[Via], speed_limits: SpeedLimits) -> list[_Leg]:
    legs: list[_Leg] = []
    here = start
    for via in vias:
        away = (via.place[0] - here[0], via.place[1] - here[1], via.place[2] - here[2])
        length_m = math.sqrt(away[0] ** 2 + away[1] ** 2 + away[2] ** 2)
        level_m = math.hypot(away[0], away[1])
        if length_m < MIN_LEG_M:
            legs.append(_Leg(here, legs[-1].along if legs else (0.0, 0.0, 1.0), 0.0, via.speed_mps, via.mark))
            continue
        limits = [(speed_limits.climb_mps if away[2] > 0 else speed_limits.descent_mps) * length_m / abs(away[2])] if away[2] else []
        if level_m > 1e-3 * length_m:
            limits.append(via.speed_mps * length_m / level_m)
        along = (away[0] / length_m, away[1] / length_m, away[2] / length_m)
        legs.append(_Leg(here, along, length_m, min(limits), via.mark))
        here = via.place
    return legs


def _corner(leg: _Leg, follows: _Leg, speed_limits: SpeedLimits) -> _Corner:
    cosine = sum(one * other for one, other in zip(leg.along, follows.along, strict=True))
    turn = math.acos(min(1.0, max(-1.0, cosine)))
    slower_mps = min(leg.fastest_mps, follows.fastest_mps)
    if turn < STRAIGHT_RAD or follows.length_m == 0.0:
        return _Corner(0.0, 0.0, slower_mps, 0.0)
    if turn > REVERSAL_RAD or leg.length_m == 0.0:
        return _Corner(0.0, 0.0, 0.0, turn)
    tangent = math.tan(turn / 2.0)
    # As wide as the speed needs, and as the waypoint and the legs permit.
    radius_m = min(
        CORNER_M / (1.0 / math.cos(turn / 2.0) - 1.0),
        slower_mps**2 / speed_limits.corner_mps2,
        0.5 * min(leg.length_m, follows.length_m) / tangent,
    )
    return _Corner(radius_m * tangent, radius_m, min(slower_mps, math.sqrt(speed_limits.corner_mps2 * radius_m)), turn)


def _inward(before: Vector, after: Vector, turn: float) -> Vector:
    cos, sin = math.cos(turn), math.sin(turn)
    return ((after[0] - before[0] * cos) / sin, (after[1] - before[1] * cos) / sin, (after[2] - before[2] * cos) / sin)


def _ahead(start: Vector, along: Vector, by_m: float) -> Vector:
    return start[0] + along[0] * by_m, start[1] + along[1] * by_m, start[2] + along[2] * by_m


def _slowed_in_time(pieces: Sequence[Piece], deceleration_mps2: float) -> tuple[Piece, ...]:
    """Limit the end speed of each piece so that braking suffices for all following pieces."""
    slowed: list[Piece] = []
    after_mps = 0.0
    for piece in reversed(pieces):
        end_mps = min(piece.end_mps, piece.fastest_mps, after_mps)
        slowed.append(replace(piece, end_mps=end_mps))
        after_mps = min(piece.fastest_mps, math.sqrt(end_mps**2 + 2.0 * deceleration_mps2 * piece.length_m))
    return tuple(reversed(slowed))
