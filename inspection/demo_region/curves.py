"""Smooth curves and even steps in the region's plane; paths have shape (n, 2), east and north [m]."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from inspection.demo_region.place import FloatArray, Point


def smooth_path(points: Sequence[Point], rounds: int = 4) -> FloatArray:
    """Chaikin's corner cutting with both ends kept: roads, railways and rivers bend, they do not break."""
    path = np.asarray(points, dtype=np.float64)
    for _ in range(rounds):
        near = 0.75 * path[:-1] + 0.25 * path[1:]
        far = 0.25 * path[:-1] + 0.75 * path[1:]
        path = np.vstack([path[:1], np.stack([near, far], axis=1).reshape(-1, 2), path[-1:]])
    return path


def distance_along(path: FloatArray) -> FloatArray:
    steps = np.diff(path, axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])


def point_along(path: FloatArray, at_m: float) -> FloatArray:
    along = distance_along(path)
    return np.array([np.interp(at_m, along, path[:, 0]), np.interp(at_m, along, path[:, 1])])


def piece_of(path: FloatArray, start_m: float, end_m: float) -> FloatArray:
    """The part of a path between two distances along it, its own vertices in between kept."""
    along = distance_along(path)
    inside = path[(along > start_m + 0.5) & (along < end_m - 0.5)]
    return np.vstack([point_along(path, start_m), inside, point_along(path, end_m)])


def offset_path(path: FloatArray, offset_m: float) -> FloatArray:
    """The path moved sideways, to the left for a positive offset; meant for short, nearly straight paths."""
    direction = np.gradient(path, axis=0)
    direction /= np.hypot(direction[:, 0], direction[:, 1])[:, None]
    return path + offset_m * np.column_stack([-direction[:, 1], direction[:, 0]])


def spans_between(corners: FloatArray, span_m: float, generator: np.random.Generator) -> tuple[FloatArray, set[int]]:
    """Supports from corner to corner, nearly even; returns the points and the indices of the corners."""
    points = [corners[0]]
    corner_indices = {0}
    for start, end in pairwise(corners):
        count = max(1, round(float(np.hypot(*(end - start))) / span_m))
        shares = np.arange(1, count) / count + generator.uniform(-0.09, 0.09, count - 1) / count
        points.extend(start + share * (end - start) for share in shares)
        points.append(end)
        corner_indices.add(len(points) - 1)
    return np.array(points), corner_indices
