"""How well a UAV kept to its line: across it, and in height, leg by leg."""

from dataclasses import dataclass

import numpy as np

from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import Flight
from simulation.assessment.flown import FloatArray, FlownRoute, FlownTrack, IntArray


@dataclass(frozen=True)
class Error:
    """Root mean square and greatest [m], of so many moments; None where there was none."""

    rms_m: float | None
    max_m: float | None


@dataclass(frozen=True)
class Following:
    across: Error
    height: Error
    worst_across_waypoint: int | None  # to which it was flying then
    worst_height_waypoint: int | None


def following_of(route: FlownRoute) -> Following:
    """Of all flights between their first and their last waypoint; the columns up and down are left out."""
    across, height, flown_to = [], [], []
    for flown in route.flights:
        if flown.track is not None and len(flown.track):
            errors = errors_along(flown.flight, flown.track)
            across.append(errors[0])
            height.append(errors[1])
            flown_to.append(errors[2])
    if not across or not sum(len(one) for one in across):
        return Following(Error(None, None), Error(None, None), None, None)
    across_m, height_m, waypoint = np.concatenate(across), np.concatenate(height), np.concatenate(flown_to)
    return Following(
        _error(across_m),
        _error(height_m),
        int(waypoint[np.argmax(across_m)]),
        int(waypoint[np.argmax(height_m)]),
    )


def errors_along(flight: Flight, track: FlownTrack) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Metres across and in height of each moment on a leg, and the waypoint that was flown to; all (k,), none below 0.

    A leg is straight in place and height. A moment belongs to the leg that leads to the waypoint flown to; on a corner that is cut it
    is measured from the leg before, too, and the nearer one counts: nobody flies round a corner without a radius.
    """
    first = flight.waypoints[0]
    frame = LocalFrame.around(*first.position)
    line = frame.to_metres(np.array([waypoint.position for waypoint in flight.waypoints]))
    level_m = np.array([waypoint.altitude_relative_m for waypoint in flight.waypoints])
    place_of = {waypoint.sequence: place for place, waypoint in enumerate(flight.waypoints)}
    place = np.array([place_of.get(sequence, -1) for sequence in track.waypoint.tolist()], dtype=np.int64)
    counted = track.is_in_air & ~track.is_coming_down & (place >= 1)
    flown, relative_m, to = frame.to_metres(track.position[counted]), track.relative_m[counted], place[counted]
    across_m, height_m = _from_leg(flown, relative_m, line, level_m, to)
    before_across, before_height = _from_leg(flown, relative_m, line, level_m, np.maximum(to - 1, 1))
    is_cut = np.hypot(before_across, before_height) < np.hypot(across_m, height_m)
    sequences = np.array([waypoint.sequence for waypoint in flight.waypoints], dtype=np.float64)
    return np.where(is_cut, before_across, across_m), np.where(is_cut, before_height, height_m), sequences[to]


def _from_leg(flown: FloatArray, relative_m: FloatArray, line: FloatArray, level_m: FloatArray, to: IntArray) -> tuple[FloatArray, ...]:
    start, end = line[to - 1], line[to]
    along = end - start
    squared = (along**2).sum(axis=1)
    share = np.clip(np.where(squared > 0, ((flown - start) * along).sum(axis=1) / np.maximum(squared, 1e-12), 1.0), 0.0, 1.0)
    nearest = start + share[:, None] * along
    across_m = np.hypot(*(flown - nearest).T)
    at_m = level_m[to - 1] + share * (level_m[to] - level_m[to - 1])
    # A leg that only climbs has any height between its ends.
    low, high = np.minimum(level_m[to - 1], level_m[to]), np.maximum(level_m[to - 1], level_m[to])
    is_column = squared < 1.0
    height_m = np.where(is_column, np.maximum(np.maximum(low - relative_m, relative_m - high), 0.0), np.abs(relative_m - at_m))
    return across_m, height_m


def _error(metres: FloatArray) -> Error:
    return Error(float(np.sqrt((metres**2).mean())), float(metres.max()))
