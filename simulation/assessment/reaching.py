"""Whether a UAV was at its waypoints and targets, how near, and how long it stayed."""

from dataclasses import dataclass

import numpy as np

from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import FrozenWaypoint
from simulation.assessment.flown import FlownRoute, FlownTrack


@dataclass(frozen=True)
class Visit:
    """What was flown of one waypoint.

    closest_m is in place and height, None where nothing was flown; at_s when that was, after the mission's departure; late_s is that less
    the planned time, None where none was planned. held_s counts the moments within `within_m`.
    """

    waypoint: FrozenWaypoint
    flight: int
    closest_m: float | None
    at_s: float | None
    late_s: float | None
    held_s: float
    battery_percent: float | None


def visits_of(route: FlownRoute, *, within_m: float) -> list[Visit]:
    """Of every waypoint of the route at which a UAV flies, in its order."""
    found = []
    for number, flown in enumerate(route.flights):
        for waypoint in flown.flight.waypoints:
            found.append(_visit(waypoint, number, flown.track, within_m))
    return found


def _visit(waypoint: FrozenWaypoint, number: int, track: FlownTrack | None, within_m: float) -> Visit:
    if track is None or not len(track):
        return Visit(waypoint, number, None, None, None, 0.0, None)
    rows = np.flatnonzero(track.is_in_air & _about(track, waypoint.sequence))
    if not len(rows):
        return Visit(waypoint, number, None, None, None, 0.0, None)
    frame = LocalFrame.around(*waypoint.position)
    flat = frame.to_metres(track.position[rows])
    places = np.column_stack([flat, track.relative_m[rows] - waypoint.altitude_relative_m])
    away_m = np.sqrt((places**2).sum(axis=1))
    nearest = int(np.argmin(away_m))
    closest_m, after = _between(places, nearest)
    held_s = float(np.diff(track.t_s[rows], append=track.t_s[rows[-1]])[away_m <= within_m].sum())
    at_s = float(track.t_s[rows[nearest]]) + after * _gap_s(track, rows, nearest)
    return Visit(
        waypoint,
        number,
        closest_m,
        at_s,
        None if waypoint.arrival_s is None else at_s - waypoint.arrival_s,
        held_s,
        float(track.battery_percent[rows[nearest]]),
    )


def _about(track: FlownTrack, sequence: int) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """From the leg to the waypoint to the one after it: a route may pass a place twice. Without such legs it was never on its way there."""
    own: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = (track.waypoint == sequence) | (track.waypoint == sequence + 1)
    return own if (track.waypoint == sequence).any() else np.zeros(len(track), dtype=bool)


def _between(places: np.ndarray[tuple[int, ...], np.dtype[np.float64]], nearest: int) -> tuple[float, float]:
    """The nearest that the straight lines beside a moment come to the origin, and how far along the one after it that is."""
    best, share = float(np.sqrt((places[nearest] ** 2).sum())), 0.0
    for other in (nearest - 1, nearest + 1):
        if not 0 <= other < len(places):
            continue
        by = places[other] - places[nearest]
        squared = float((by**2).sum())
        if squared == 0.0:
            continue
        along = min(max(float(-(places[nearest] * by).sum()) / squared, 0.0), 1.0)
        metres = float(np.sqrt(((places[nearest] + along * by) ** 2).sum()))
        if metres < best:
            best, share = metres, along * (other - nearest)
    return best, share


def _gap_s(track: FlownTrack, rows: np.ndarray[tuple[int, ...], np.dtype[np.int64]], nearest: int) -> float:
    if len(rows) < 2:
        return 0.0
    other = min(nearest + 1, len(rows) - 1)
    return float(track.t_s[rows[other]] - track.t_s[rows[other - 1]])
