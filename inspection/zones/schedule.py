"""Validated schedules of zones: periods with days and times of day, as in ED-318, in one form.

The form, which is also stored: a list of periods {"startDateTime", "endDateTime", "schedule"}; dates and times are UTC in RFC 3339 or null
for "open"; schedule is a list of {"day", "startTime", "startEvent", "endTime", "endEvent"}, empty for "all the time". None stands for a
zone that always applies. Source: EUROCAE ED-318, limitedApplicability; ED-269, applicability.
"""

import re
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from inspection.geodesy.geometry_validator import GeometryFault

DAYS = ("MON", "TUE", "WED", "THU", "FRI", "SAT", "SUN")
EVENTS = ("BMCT", "SR", "SS", "EECT")  # morning civil twilight, sunrise, sunset, end of evening civil twilight
MAX_PERIODS = 200
MAX_ENTRIES = 100
MAX_ENTRIES_IN_ALL = 1_000
_TIME = re.compile(r"(\d{2}):(\d{2})(?::(\d{2})(?:\.\d{1,9})?)?(Z|[+-]\d{2}:\d{2})?")
_MINUTES_A_DAY = 24 * 60

Schedule = list[dict[str, Any]]


def checked_schedule(value: Any, place: str) -> Schedule | None:
    """Return the periods in this form, or None if one of them is permanent. Raises GeometryFault with the place of the fault."""
    if value is None or value == []:
        return None
    if not isinstance(value, list):
        raise GeometryFault(place, "periods of applicability are a list")
    if len(value) > MAX_PERIODS:
        raise GeometryFault(place, f"there are {len(value)} periods; at most {MAX_PERIODS} are taken")
    periods = [_period(period, f"{place}[{index}]") for index, period in enumerate(value)]
    entries = sum(len(period["schedule"]) for period in periods)
    if entries > MAX_ENTRIES_IN_ALL:
        raise GeometryFault(place, f"there are {entries} entries in all periods; at most {MAX_ENTRIES_IN_ALL} are taken")
    always: dict[str, Any] = {"startDateTime": None, "endDateTime": None, "schedule": []}
    return None if always in periods else periods


def _period(period: Any, place: str) -> dict[str, Any]:
    if not isinstance(period, dict):
        raise GeometryFault(place, "a period is an object")
    permanent = period.get("permanent", "NO")
    if permanent not in ("YES", "NO", True, False):
        raise GeometryFault(f"{place}.permanent", "permanent is YES or NO")
    start, end = (moment_of(period.get(name), f"{place}.{name}") for name in ("startDateTime", "endDateTime"))
    if permanent in ("YES", True) and (start or end):
        raise GeometryFault(place, "a period that is permanent has no dates")
    if start is not None and end is not None and end <= start:
        raise GeometryFault(f"{place}.endDateTime", "the period ends before it begins")
    entries = period.get("schedule") or []
    if not isinstance(entries, list) or len(entries) > MAX_ENTRIES:
        raise GeometryFault(f"{place}.schedule", f"a schedule is a list of at most {MAX_ENTRIES} entries")
    return {
        "startDateTime": start, "endDateTime": end,
        "schedule": [_entry(entry, f"{place}.schedule[{index}]") for index, entry in enumerate(entries)],
    }  # fmt: skip


def moment_of(value: Any, place: str) -> str | None:
    """Return a date and time in UTC in RFC 3339; None if not stated. Raises GeometryFault."""
    if value is None or value == "":
        return None
    if not isinstance(value, str) or len(value) > 40:
        raise GeometryFault(place, "a date and time such as 2026-12-31T18:00:00Z is expected")
    try:
        moment = datetime.fromisoformat(value.replace("Z", "+00:00"))
    except ValueError as error:
        raise GeometryFault(place, f"{value!r} is no date and time such as 2026-12-31T18:00:00Z") from error
    if moment.tzinfo is None:
        raise GeometryFault(place, f"{value!r} does not say its time zone; Z stands for UTC")
    try:
        return moment.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    except OverflowError as error:
        raise GeometryFault(place, f"{value!r} lies beyond the calendar") from error


def _entry(entry: Any, place: str) -> dict[str, Any]:
    if not isinstance(entry, dict):
        raise GeometryFault(place, "an entry of a schedule is an object")
    days = entry.get("day", ["ANY"])
    if not isinstance(days, list) or not days or not all(isinstance(day, str) and day in (*DAYS, "ANY") for day in days):
        raise GeometryFault(f"{place}.day", f"days are a list of {', '.join(DAYS)} or ANY")
    checked: dict[str, Any] = {"day": ["ANY"] if "ANY" in days or len(set(days)) == 7 else [day for day in DAYS if day in days]}
    for side in ("start", "end"):
        time, event = entry.get(f"{side}Time"), entry.get(f"{side}Event")
        if time and event:
            raise GeometryFault(f"{place}.{side}Event", "an entry has a time or an event at each end, not both")
        if event is not None and event != "" and (not isinstance(event, str) or event not in EVENTS):
            raise GeometryFault(f"{place}.{side}Event", f"events are {', '.join(EVENTS)}")
        checked[f"{side}Time"] = _time_of_day(time, f"{place}.{side}Time")
        checked[f"{side}Event"] = event or None
    return {name: checked[name] for name in ("day", "startTime", "startEvent", "endTime", "endEvent")}


def _time_of_day(value: Any, place: str) -> str | None:
    """Return hh:mm:ssZ. Times of day are UTC; an offset is converted, and refused if it changes the day."""
    if value is None or value == "":
        return None
    match = _TIME.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        raise GeometryFault(place, "a time of day such as 08:00:00Z is expected")
    hour, minute, second, zone = int(match[1]), int(match[2]), int(match[3] or 0), match[4]
    if hour > 24 or minute > 59 or second > 59 or (hour == 24 and (minute or second)):
        raise GeometryFault(place, f"{value} is no time of day")
    if hour == 24:
        return "24:00:00Z"
    if zone in {None, "Z", "+00:00", "-00:00"}:
        return f"{hour:02}:{minute:02}:{second:02}Z"
    offset = (1 if zone[0] == "+" else -1) * (int(zone[1:3]) * 60 + int(zone[4:6]))
    utc = hour * 60 + minute - offset
    if not 0 <= utc < _MINUTES_A_DAY:
        raise GeometryFault(place, f"{value} is on another day in UTC; write the days and times in UTC")
    return f"{utc // 60:02}:{utc % 60:02}:{second:02}Z"


@dataclass(frozen=True)
class ZoneRules:
    time_margin_s: float = 300.0  # before a zone begins to apply and after it has ended
    height_margin_m: float = 10.0  # below a zone's lower limit and above its upper one

    def __post_init__(self) -> None:
        if not (self.time_margin_s >= 0 and self.height_margin_m >= 0):
            raise ValueError(f"margins ({self.time_margin_s} s, {self.height_margin_m} m) are at least 0")
