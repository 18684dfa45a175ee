"""A report as the mission report uses it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np

from inspection.geodesy import LonLat


@dataclass(frozen=True, slots=True)
class Fix:
    """Position of a UAV at a time [Unix s, by its corrected clock]. None: unknown.

    `altitude_relative_m` is above the take-off of its flight, `waypoint_sequence` the waypoint of the approved route that it flew to.
    `clock_s` is the vehicle's clock since the boot named by `boot`, if reported.
    """

    at_s: float
    position: LonLat
    altitude_relative_m: float | None = None
    battery_percent: float | None = None
    waypoint_sequence: int | None = None
    is_in_air: bool | None = None
    boot: int | None = None
    clock_s: float | None = None


def uav_s(before: Fix, after: Fix) -> float:
    """Return the seconds between two fixes by the vehicle's clock, which runs faster than the server's in faster simulations."""
    if before.clock_s is not None and after.clock_s is not None and before.boot == after.boot and after.clock_s > before.clock_s:
        return after.clock_s - before.clock_s
    return after.at_s - before.at_s


def in_order(fixes: Sequence[Fix]) -> list[Fix]:
    """Return the fixes sorted by time, one for each moment."""
    found: list[Fix] = []
    for fix in sorted(fixes, key=lambda fix: fix.at_s):
        if not found or fix.at_s > found[-1].at_s:
            found.append(fix)
    return found


def airborne(fixes: Sequence[Fix]) -> list[Fix]:
    """Return the fixes between each take-off and its landing; all if none reports whether it was in the air.

    A fix without that value takes it from the previous one; before the first value it counts as on the ground.
    """
    if all(fix.is_in_air is None for fix in fixes):
        return list(fixes)
    found, is_up = [], False
    for fix in fixes:
        is_up = is_up if fix.is_in_air is None else fix.is_in_air
        if is_up:
            found.append(fix)
    return found


def uav_span_s(tracks: Iterable[Sequence[Fix]]) -> float:
    """Return the time from the first fix of all tracks to the last [s]; each track is sorted.

    Each stretch is measured by the clock of a vehicle with fixes before and after it, else by the server's.
    """
    pairs = sorted((before.at_s, after.at_s, uav_s(before, after)) for track in tracks for before, after in pairwise(track))
    total_s, until_s = 0.0, pairs[0][0] if pairs else 0.0
    for began_s, ended_s, length_s in pairs:
        total_s += max(began_s - until_s, 0.0)
        until_s = max(until_s, began_s)
        if ended_s > until_s:
            total_s += length_s * (ended_s - until_s) / (ended_s - began_s)
            until_s = ended_s
    return total_s


def uav_after_s(track: Sequence[Fix], at_s: float) -> float:
    """Return the seconds from the first fix of a track to a moment [Unix s], by the vehicle's clock."""
    passed_s = list(accumulate((uav_s(before, after) for before, after in pairwise(track)), initial=0.0))
    return float(np.interp(at_s, [fix.at_s for fix in track], passed_s))
