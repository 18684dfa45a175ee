"""Distances and rays by plain formulas, sharing no code with the planner."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from planning.views.site import StandingSupport
from planning.views.view_flight import ViewFlight

FloatArray = NDArray[np.float64]

HOT_M, SWING_DEG = 800.0, 30.0  # of wires: constant of the catenary on a hot day, and swing in wind


def flown_places(flight: ViewFlight, step_m: float) -> FloatArray:
    """Places along a flight, no farther apart than this."""
    parts = [flight.position[:1]]
    for start, end in zip(flight.position[:-1], flight.position[1:], strict=True):
        count = max(int(np.ceil(np.linalg.norm(end - start) / step_m)), 1)
        parts.append(start + (end - start) * np.linspace(0.0, 1.0, count + 1)[1:, None])
    return np.concatenate(parts)


def to_triangles_m(places: FloatArray, triangles: FloatArray) -> FloatArray:
    """The distance of each place from the nearest triangle (C. Ericson, Real-Time Collision Detection, 5.1.5: regions of a triangle)."""
    nearest = np.full(len(places), np.inf)
    for one, two, three in triangles:
        normal = np.cross(two - one, three - one)
        normal /= np.linalg.norm(normal)
        height = (places - one) @ normal
        foot = places - height[:, None] * normal
        inside = np.ones(len(places), dtype=bool)
        for start, end in ((one, two), (two, three), (three, one)):
            inside &= np.cross(end - start, foot - start) @ normal >= 0.0
            nearest = np.minimum(nearest, to_segment_m(places, start, end))
        nearest = np.where(inside, np.minimum(nearest, np.abs(height)), nearest)
    return nearest


def to_segment_m(places: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    way = end - start
    share = np.clip((places - start) @ way / (way @ way), 0.0, 1.0)
    distance: FloatArray = np.linalg.norm(places - start - share[:, None] * way, axis=1)
    return distance


def to_wires_m(places: FloatArray, supports: Sequence[StandingSupport], start: int, end: int) -> FloatArray:
    """The distance from the places that wires between two supports, which are alike, have when they swing.

    Each wire is a parabola with any sag up to that of a catenary constant of HOT_M, turned about the line between its ends by angles up to
    SWING_DEG to both sides, which also swings the string that it hangs from; it is looked at every 0.25 m, which is 4 mm too far at 2 m.
    """
    one, other = (np.array([own.east_m, own.north_m, own.ground_m]) for own in (supports[start], supports[end]))
    length_m = float(np.linalg.norm((other - one)[:2]))
    right = np.array([other[1] - one[1], one[0] - other[0], 0.0]) / length_m
    own = supports[start].support
    if np.dot(right[:2], [np.cos(np.radians(own.bearing_deg)), -np.sin(np.radians(own.bearing_deg))]) < 0.0:
        right = -right
    share = np.arange(0.0, 1.0, 0.25 / length_m)[:, None]
    drop_m = 4.0 * length_m**2 / (8.0 * HOT_M) * share * (1.0 - share)
    levels_m = [level for level, _, _ in own.arms.arms]
    wires = []
    for across_m, height_m in (*own.arms.slots, *own.arms.earth):
        string_m = min((level for level in levels_m if level >= height_m), default=height_m) - height_m
        for part in (0.0, 0.5, 1.0):
            for angle in np.radians((-SWING_DEG, -SWING_DEG / 2, 0.0, SWING_DEG / 2, SWING_DEG)):
                side_m = across_m + (drop_m * part + string_m) * np.sin(angle)
                up_m = height_m + string_m - (drop_m * part + string_m) * np.cos(angle)
                wires.append(one + (other - one) * share + side_m * right + up_m * np.array([0.0, 0.0, 1.0]))
    distance_m, _ = KDTree(np.concatenate(wires)).query(places)
    return np.asarray(distance_m)


def first_hit(start: FloatArray, direction: FloatArray, triangles: FloatArray) -> tuple[NDArray[np.int64], FloatArray]:
    """The first triangle that each ray meets, -1 for none, and how far away (T. Möller and B. Trumbore, 1997)."""
    nearest, which = np.full(len(start), np.inf), np.full(len(start), -1, dtype=np.int64)
    for number, (one, two, three) in enumerate(triangles):
        edge, other = two - one, three - one
        across = np.cross(direction, other)
        measure = across @ edge
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / measure
            away = start - one
            u = np.einsum("ij,ij->i", away, across) * inverse
            turned = np.cross(away, edge)
            v = np.einsum("ij,ij->i", direction, turned) * inverse
            distance = (turned @ other) * inverse
        hit = (np.abs(measure) > 1e-12) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > 1e-9) & (distance < nearest)
        nearest, which = np.where(hit, distance, nearest), np.where(hit, number, which)
    return which, nearest
