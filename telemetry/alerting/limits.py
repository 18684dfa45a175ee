"""Thresholds of alerts: defaults, and the values of a UAV type or a mission."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any


class InvalidLimits(ValueError):
    """The limits are invalid; `place` names the entry as in the JSON."""

    def __init__(self, place: str, message: str) -> None:
        super().__init__(f"{place}: {message}")
        self.place = place
        self.message = message


def _limit(usual: float, low: float, high: float) -> Any:
    return field(default=usual, metadata={"from": low, "to": high})


@dataclass(frozen=True, slots=True)
class AlertLimits:
    """Thresholds; names end with their unit. Alerts clear at a share of the threshold that each detector defines.

    link_late_s        without a message: warning; with rare reports, two and a half of their intervals
    link_lost_s        likewise: critical; five intervals
    off_route_m        distance from the approved route: warning; off_route_critical_m: critical
    height_off_m       above or below the heights of the leg: warning; height_off_critical_m: critical
    zone_ahead_s       horizon of the zone prediction
    battery_margin_percent    of the full battery: a warning if the flight is expected to end this far below the reserve
    battery_critical_percent  expected at home and at the end of the route: critical below it, as below the reserve
    no_progress_s      without progress, beside the times planned for tasks
    separation_m, separation_height_m  minimum distances between two UAVs; a conflict falls below both
    converging_s       horizon of the conflict prediction
    least_satellites, most_hdop  of a good fix
    jump_mps           a faster movement of the position is a jump
    wind_share_percent maximum wind, as a share of its highest airspeed
    wind_mps           maximum wind; 0: only the share counts
    """

    link_late_s: float = _limit(5.0, 2.0, 600.0)
    link_lost_s: float = _limit(20.0, 5.0, 3_600.0)
    off_route_m: float = _limit(25.0, 5.0, 5_000.0)
    off_route_critical_m: float = _limit(100.0, 10.0, 10_000.0)
    height_off_m: float = _limit(12.0, 3.0, 500.0)
    height_off_critical_m: float = _limit(30.0, 5.0, 1_000.0)
    zone_ahead_s: float = _limit(30.0, 5.0, 300.0)
    battery_margin_percent: float = _limit(3.0, 0.0, 50.0)
    battery_critical_percent: float = _limit(5.0, 0.0, 50.0)
    no_progress_s: float = _limit(30.0, 10.0, 3_600.0)
    separation_m: float = _limit(15.0, 2.0, 1_000.0)
    separation_height_m: float = _limit(8.0, 1.0, 500.0)
    converging_s: float = _limit(20.0, 5.0, 120.0)
    least_satellites: float = _limit(7.0, 4.0, 40.0)
    most_hdop: float = _limit(2.5, 0.5, 20.0)
    jump_mps: float = _limit(60.0, 10.0, 500.0)
    wind_share_percent: float = _limit(70.0, 10.0, 100.0)
    wind_mps: float = _limit(0.0, 0.0, 60.0)

    def __post_init__(self) -> None:
        for lower, higher in _ORDERED:
            if getattr(self, lower) > getattr(self, higher):
                raise InvalidLimits(higher, f"must not be below {lower} ({getattr(self, lower):g})")


_ORDERED = (("link_late_s", "link_lost_s"), ("off_route_m", "off_route_critical_m"), ("height_off_m", "height_off_critical_m"))
BOUNDS = {entry.name: (entry.metadata["from"], entry.metadata["to"]) for entry in fields(AlertLimits)}


def checked_limits(value: Any) -> dict[str, float]:
    """Return the limits of a type or a mission. Raises InvalidLimits; `limits_of` checks whether they are consistent."""
    if not isinstance(value, Mapping):
        raise InvalidLimits("alert_limits", "must be an object")
    read: dict[str, float] = {}
    for key, entry in value.items():
        if key not in BOUNDS:
            raise InvalidLimits(str(key), "is not known")
        if entry is None:
            continue
        if isinstance(entry, bool) or not isinstance(entry, int | float):
            raise InvalidLimits(key, "must be a number")
        low, high = BOUNDS[key]
        if not low <= entry <= high:
            raise InvalidLimits(key, f"must be from {low:g} to {high:g}")
        read[key] = float(entry)
    return read


def limits_of(*stated: Any) -> AlertLimits:
    """Return the defaults overridden by the stated limits, later ones first. Raises InvalidLimits."""
    read: dict[str, float] = {}
    for value in stated:
        read |= checked_limits(value or {})
    return AlertLimits(**read)


def sound_limits(stated: Sequence[Mapping[str, float]]) -> AlertLimits:
    """Return the limits of a UAV's type and mission, in this order. Mission limits that contradict the type's are ignored."""
    for believed in (stated, stated[:1]):
        try:
            return limits_of(*believed)
        except InvalidLimits:
            continue
    return AlertLimits()
