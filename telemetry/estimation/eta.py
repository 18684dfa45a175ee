"""ETA of a UAV at the waypoints of its route."""

import math

import numpy as np

from telemetry.estimation.along_track_filter import clock_of
from telemetry.estimation.estimate import Arrival
from telemetry.estimation.motion import State, Track
from telemetry.estimation.state_estimate import NORMAL_95

SURE_S = 2.0
LASTS_SHARE = 0.1  # relative uncertainty of the speed of a whole flight that observation does not reduce, such as rising wind


def arrivals_of(state: State, track: Track) -> tuple[Arrival, ...]:
    """Return the arrival at the first waypoint of each remaining target, as predicted right after the report."""
    profile = track.profile
    first = [
        number for number, target in enumerate(profile.target) if target >= 0 and (number == 0 or profile.target[number - 1] != target)
    ]
    return tuple(_arrivals(state, track, first)) if first else ()


def end_of(state: State, track: Track) -> Arrival | None:
    """Return the end of the flight: the landing, or the last waypoint if it hovers there."""
    found = _arrivals(state, track, [len(track.profile.sequence) - 1])
    return found[0] if found else None


def at_reading(state: State, track: Track, knot: int) -> float:
    """Return the predicted time at a knot of the profile; in the past for a knot behind the UAV."""
    clock = clock_of(track.profile, track.along_track)
    return state.report_s + float(clock[knot]) - float(np.interp(track.along_track.nominal_s, track.profile.nominal_s, clock).mean())


def _arrivals(state: State, track: Track, nodes: list[int]) -> list[Arrival]:
    profile, along_track = track.profile, track.along_track
    clock = clock_of(profile, along_track)
    here_s = np.interp(along_track.nominal_s, profile.nominal_s, clock)
    middle_s = float(here_s.mean())
    reached = profile.reached[nodes]
    to_go_s = clock[reached] - middle_s
    moving_s = (profile.moving_s[reached] - float(np.interp(middle_s, clock, profile.moving_s))) / along_track.speed_factor
    slack_s2 = profile.variance_s2[reached] - float(np.interp(middle_s, clock, profile.variance_s2))
    uncertainty_s = np.sqrt(
        SURE_S**2
        + float(here_s.var())
        + np.maximum(slack_s2, 0.0)
        + (along_track.variance + LASTS_SHARE**2) * np.maximum(moving_s, 0.0) ** 2
    )
    found = []
    for number, to_go, uncertainty in zip(nodes, to_go_s.tolist(), uncertainty_s.tolist(), strict=True):
        if to_go <= 0.0 or not math.isfinite(to_go):
            continue
        at_s, target = state.report_s + to_go, int(profile.target[number])
        within_s = NORMAL_95 * uncertainty
        sequence = int(profile.sequence[number])
        found.append(Arrival(sequence, None if target < 0 else target, at_s, max(at_s - within_s, state.report_s), at_s + within_s))
    return found
