"""How closely a flight followed its route, and which targets it reached."""

from dataclasses import dataclass
from itertools import groupby

import numpy as np

from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import Flight, FrozenWaypoint
from simulation.assessment.flown import AssessedRoute, FloatArray, FlownTrack, IntArray


@dataclass(frozen=True)
class Error:
    """Root mean square and maximum error [m]; None without samples."""

    rms_m: float | None
    max_m: float | None


@dataclass(frozen=True)
class Following:
    across: Error
    height: Error
    worst_across_waypoint: int | None  # the waypoint flown to at that moment
    worst_height_waypoint: int | None


def following_of(route: AssessedRoute) -> Following:
    """Return the errors of all flights between their first and last waypoint, without take-off and landing."""
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
    """Return metres across and in height for each moment on a leg, and the waypoint flown to; all (k,), not negative.

    A leg is straight in position and height. A moment belongs to the leg that ends at the waypoint flown to. It is also measured from the
    previous leg, and the smaller error counts, as corners are flown with a radius.
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
    before_across, before_height = _from_leg(flown, relative_m, line, level_m, _legs_before(line, level_m)[to])
    is_cut = np.hypot(before_across, before_height) < np.hypot(across_m, height_m)
    sequences = np.array([waypoint.sequence for waypoint in flight.waypoints], dtype=np.float64)
    return np.where(is_cut, before_across, across_m), np.where(is_cut, before_height, height_m), sequences[to]


def _legs_before(line: FloatArray, level_m: FloatArray) -> IntArray:
    """Return for each place the end of the leg before the one that leads there, without those between waypoints at one place."""
    is_leg = np.r_[False, (np.diff(line, axis=0) != 0.0).any(axis=1) | (np.diff(level_m) != 0.0)]
    last = np.maximum.accumulate(np.where(is_leg, np.arange(len(line)), 0))
    before: IntArray = np.maximum(np.r_[0, last[:-1]], 1)
    return before


def _from_leg(flown: FloatArray, relative_m: FloatArray, line: FloatArray, level_m: FloatArray, to: IntArray) -> tuple[FloatArray, ...]:
    start, end = line[to - 1], line[to]
    along = end - start
    squared = (along**2).sum(axis=1)
    share = np.clip(np.where(squared > 0, ((flown - start) * along).sum(axis=1) / np.maximum(squared, 1e-12), 1.0), 0.0, 1.0)
    nearest = start + share[:, None] * along
    across_m = np.hypot(*(flown - nearest).T)
    at_m = level_m[to - 1] + share * (level_m[to] - level_m[to - 1])
    # On a vertical leg any height between its ends is correct.
    low, high = np.minimum(level_m[to - 1], level_m[to]), np.maximum(level_m[to - 1], level_m[to])
    is_column = squared < 1.0
    height_m = np.where(is_column, np.maximum(np.maximum(low - relative_m, relative_m - high), 0.0), np.abs(relative_m - at_m))
    return across_m, height_m


def _error(metres: FloatArray) -> Error:
    return Error(float(np.sqrt((metres**2).mean())), float(metres.max()))


@dataclass(frozen=True)
class AssessedVisit:
    """The visit of one waypoint.

    closest_m is the distance in position and height, None if nothing was flown. at_s is its time after the mission's departure. late_s is
    at_s minus the planned time, None without one. held_s is the time within `within_m`.
    """

    waypoint: FrozenWaypoint
    flight: int
    closest_m: float | None
    at_s: float | None
    late_s: float | None
    held_s: float
    battery_percent: float | None


def visits_of(route: AssessedRoute, *, within_m: float) -> list[AssessedVisit]:
    """Return the visit of every waypoint of the route, in order."""
    found: list[AssessedVisit] = []
    for number, flown in enumerate(route.flights):
        for _place, here in groupby(flown.flight.waypoints, key=lambda waypoint: (waypoint.position, waypoint.altitude_relative_m)):
            waypoints = list(here)
            sequences = waypoints[0].sequence, waypoints[-1].sequence
            found += [_visit(waypoint, number, flown.track, within_m, sequences) for waypoint in waypoints]
    return found


def _visit(waypoint: FrozenWaypoint, number: int, track: FlownTrack | None, within_m: float, here: tuple[int, int]) -> AssessedVisit:
    """here: the first and the last of the waypoints one after another at this very place, such as where a stretch begins at the end of
    another; a vehicle knows one of them alone, or reaches both at once."""
    if track is None or not len(track):
        return AssessedVisit(waypoint, number, None, None, None, 0.0, None)
    rows = np.flatnonzero(track.is_in_air & _about(track, *here))
    if not len(rows):
        return AssessedVisit(waypoint, number, None, None, None, 0.0, None)
    frame = LocalFrame.around(*waypoint.position)
    flat = frame.to_metres(track.position[rows])
    places = np.column_stack([flat, track.relative_m[rows] - waypoint.altitude_relative_m])
    away_m = np.sqrt((places**2).sum(axis=1))
    nearest = int(np.argmin(away_m))
    closest_m, after = _between(places, nearest)
    held_s = float(np.diff(track.t_s[rows], append=track.t_s[rows[-1]])[away_m <= within_m].sum())
    at_s = float(track.t_s[rows[nearest]]) + after * _gap_s(track, rows, nearest)
    return AssessedVisit(
        waypoint,
        number,
        closest_m,
        at_s,
        None if waypoint.arrival_s is None else at_s - waypoint.arrival_s,
        held_s,
        float(track.battery_percent[rows[nearest]]),
    )


def _about(track: FlownTrack, first: int, last: int) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Return the rows from the leg to the waypoints `first` to `last` to the leg after them, as a route may pass a place twice.

    None without a leg to them: legs between waypoints at one place take no time.
    """
    to_them: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = (track.waypoint >= first) & (track.waypoint <= last)
    return to_them | (track.waypoint == last + 1) if to_them.any() else np.zeros(len(track), dtype=bool)


def _between(places: np.ndarray[tuple[int, ...], np.dtype[np.float64]], nearest: int) -> tuple[float, float]:
    """Return the smallest distance of the segments beside a row to the origin, and its place along the next segment."""
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
