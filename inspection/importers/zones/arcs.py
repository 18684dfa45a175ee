"""Arcs and circles around a centre on the ellipsoid, as vertices so near to each other that the sides keep to the curve."""

from math import acos, ceil, cos, pi

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.geometry_validator import GeometryFault
from inspection.geodesy.wgs84 import WGS84, FloatArray

FARTHEST_M = 0.5  # that a side may be from the curve; in aeronautical files radii themselves are rounded to 19 m and more
MOST_DIFFERENT_RADII = 0.2  # of the two ends of an arc; more is another centre
_LEAST_SIDES = 8


def arc(centre: LonLat, radius_m: float, start_deg: float, end_deg: float, is_clockwise: bool, place: str) -> FloatArray:
    """From one direction to another (degrees from north), ends included; shape (n, 2), lon lat."""
    return _path(centre, radius_m, radius_m, start_deg, _turn(start_deg, end_deg, is_clockwise), place)


def arc_between(centre: LonLat, start: LonLat, end: LonLat, is_clockwise: bool, place: str) -> FloatArray:
    """From one position to another; where they are not equally far from the centre, the radius goes over from one to the other."""
    start_deg, _, start_m = WGS84.inv(centre.lon, centre.lat, start.lon, start.lat)
    end_deg, _, end_m = WGS84.inv(centre.lon, centre.lat, end.lon, end.lat)
    if min(start_m, end_m) < FARTHEST_M:
        raise GeometryFault(place, "an end of the arc lies in its centre", start)
    if abs(start_m - end_m) > MOST_DIFFERENT_RADII * max(start_m, end_m):
        raise GeometryFault(
            place, f"the ends of the arc are {start_m:.0f} m and {end_m:.0f} m from its centre: another centre is meant", start
        )
    path = _path(centre, start_m, end_m, start_deg, _turn(start_deg, end_deg, is_clockwise), place)
    path[0], path[-1] = start, end
    return path


def circle_ring(centre: LonLat, radius_m: float, place: str) -> FloatArray:
    """A closed ring around the circle: it holds all of it, and is nowhere farther than FARTHEST_M outside."""
    sides = _sides(radius_m, 2 * pi)
    _check_not_at_a_pole(centre, radius_m, place)
    bearings = np.arange(sides, dtype=np.float64) * (360.0 / sides)
    points = _at(centre, np.full(sides, radius_m / cos(pi / sides)), bearings)
    return np.vstack([points, points[:1]])


def _turn(start_deg: float, end_deg: float, is_clockwise: bool) -> float:
    """The angle to turn through, in degrees, positive clockwise; a whole turn where both directions are the same."""
    turn = (end_deg - start_deg) % 360.0
    if turn < 1e-9:
        turn = 360.0
    return turn if is_clockwise else turn - 360.0 if turn < 360.0 else -360.0


def _path(centre: LonLat, start_m: float, end_m: float, start_deg: float, turn_deg: float, place: str) -> FloatArray:
    _check_not_at_a_pole(centre, max(start_m, end_m), place)
    shares: FloatArray = np.linspace(0.0, 1.0, _sides(max(start_m, end_m), abs(turn_deg) * pi / 180.0) + 1, dtype=np.float64)
    return _at(centre, start_m + shares * (end_m - start_m), start_deg + shares * turn_deg)


def _sides(radius_m: float, angle_rad: float) -> int:
    """How many sides keep within FARTHEST_M of the curve."""
    step = 2.0 * acos(max(1.0 - FARTHEST_M / radius_m, 0.0))
    return max(ceil(angle_rad / step), ceil(_LEAST_SIDES * angle_rad / (2 * pi)), 1)


def _at(centre: LonLat, distances_m: FloatArray, bearings_deg: FloatArray) -> FloatArray:
    lon, lat, _ = WGS84.fwd(np.full(len(bearings_deg), centre.lon), np.full(len(bearings_deg), centre.lat), bearings_deg, distances_m)
    return np.column_stack([np.asarray(lon), np.asarray(lat)])


def _check_not_at_a_pole(centre: LonLat, radius_m: float, place: str) -> None:
    pole_m = min(WGS84.inv(centre.lon, centre.lat, centre.lon, latitude)[2] for latitude in (90.0, -90.0))
    if pole_m <= radius_m * 1.2:
        raise GeometryFault(place, "the arc comes too near to a pole", centre)
