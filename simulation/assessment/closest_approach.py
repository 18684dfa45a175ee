"""Closest points of approach of UAVs of one mission, at the same moment in the air."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from inspection.geodesy.local_frame import LocalFrame
from simulation.assessment.flown import AssessedRoute, FloatArray, FlownTrack, IntArray, TrackEnding, frame_of


@dataclass(frozen=True)
class ClosestApproach:
    """The closest point of approach of two UAVs, identified by their places in the mission."""

    uavs: tuple[int, int]
    beside_m: float
    height_m: float
    t_s: float

    @property
    def away_m(self) -> float:
        return math.hypot(self.beside_m, self.height_m)


def closest_approaches_of(routes: Sequence[AssessedRoute], *, step_s: float) -> list[ClosestApproach]:
    """Return one for each pair that was in the air at the same time. Tracks are sampled every step_s of mission time."""
    frame = frame_of(routes)
    if frame is None:
        return []
    ends_s = max(float(track.t_s[-1]) for route in routes for track in route.tracks if len(track))
    rows = [_by_step(route, frame, step_s, ends_s) for route in routes]
    found = []
    for one, other in combinations(range(len(routes)), 2):
        shared, own, others = np.intersect1d(rows[one][0], rows[other][0], return_indices=True)
        if not len(shared):
            continue
        by = rows[one][1][own] - rows[other][1][others]
        nearest = int(np.argmin((by**2).sum(axis=1)))
        east_m, north_m, up_m = by[nearest].tolist()
        pair = (routes[one].uav, routes[other].uav)
        found.append(ClosestApproach(pair, math.hypot(east_m, north_m), abs(up_m), float(shared[nearest]) * step_s))
    return found


def _by_step(route: AssessedRoute, frame: LocalFrame, step_s: float, ends_s: float) -> tuple[IntArray, FloatArray]:
    """Return the steps at which it was in the air, ascending, and east, north, up [m] at each. A hovering UAV stays until the end."""
    steps, places = [], []
    for track in route.tracks:
        if not len(track):
            continue
        until_s = ends_s if track.ending is TrackEnding.HOVERING else float(track.t_s[-1])
        wanted = np.arange(math.ceil(track.t_s[0] / step_s), math.floor(until_s / step_s) + 1)
        at = np.interp(wanted * step_s, track.t_s, np.arange(len(track)))
        is_up = track.is_in_air[np.rint(at).astype(np.int64)]
        flat = frame.to_metres(_at(track, wanted * step_s))
        up_m = np.interp(wanted * step_s, track.t_s, track.amsl_m)
        steps.append(wanted[is_up])
        places.append(np.column_stack([flat, up_m])[is_up])
    if not steps:
        return np.zeros(0, dtype=np.int64), np.zeros((0, 3))
    return np.concatenate(steps), np.concatenate(places)


def _at(track: FlownTrack, t_s: FloatArray) -> FloatArray:
    return np.column_stack([np.interp(t_s, track.t_s, track.position[:, 0]), np.interp(t_s, track.t_s, track.position[:, 1])])
