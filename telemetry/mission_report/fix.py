"""A report as the record of a mission reads it."""

from collections.abc import Sequence
from dataclasses import dataclass

from inspection.geodesy import LonLat


@dataclass(frozen=True, slots=True)
class Fix:
    """Where a UAV was at a time [Unix s, by its own clock set right]. None is not known.

    `altitude_relative_m` is above the take-off of the flight it was on, `waypoint_sequence` the waypoint of the approved route that it
    flew to. `clock_s` is what the vehicle's clock showed since the boot that `boot` names, where it tells that.
    """

    at_s: float
    position: LonLat
    altitude_relative_m: float | None = None
    battery_percent: float | None = None
    waypoint_sequence: int | None = None
    is_in_air: bool | None = None
    boot: int | None = None
    clock_s: float | None = None


def own_s(before: Fix, after: Fix) -> float:
    """From one to a later one by the vehicle's clock, which runs faster than ours where it is flown faster than real time."""
    if before.clock_s is not None and after.clock_s is not None and before.boot == after.boot and after.clock_s > before.clock_s:
        return after.clock_s - before.clock_s
    return after.at_s - before.at_s


def in_order(fixes: Sequence[Fix]) -> list[Fix]:
    """By time, one of a moment."""
    found: list[Fix] = []
    for fix in sorted(fixes, key=lambda fix: fix.at_s):
        if not found or fix.at_s > found[-1].at_s:
            found.append(fix)
    return found
