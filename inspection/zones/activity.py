"""When a zone applies, computed from its schedule. It errs on the long side: an unknown schedule always applies."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from datetime import date, datetime, timedelta
from functools import lru_cache
from math import degrees
from typing import Any, NamedTuple

from astral import SunDirection
from astral.julian import julianday, julianday_to_juliancentury
from astral.sun import eq_of_time, hour_angle, sun_declination

from inspection.zones.schedule import DAYS, Schedule

DAY_S = 86_400.0
EPOCH = date(1970, 1, 1)
SUNRISE_ZENITH_DEG = 90 + 50 / 60  # 34' of refraction and the sun's radius of 16': U.S. Naval Observatory, "Rise, Set, and Twilight"
TWILIGHT_ZENITH_DEG = 96.0  # the same, civil twilight
MAX_LAT_DEG = 89.8  # nearer to a pole the equations are invalid
ROUNDS = 3  # iterations for the moving sun; the third changes less than a second below 65 degrees of latitude

_ZENITH_AND_DIRECTION: Mapping[str, tuple[float, SunDirection]] = {
    "BMCT": (TWILIGHT_ZENITH_DEG, SunDirection.RISING),
    "SR": (SUNRISE_ZENITH_DEG, SunDirection.RISING),
    "SS": (SUNRISE_ZENITH_DEG, SunDirection.SETTING),
    "EECT": (TWILIGHT_ZENITH_DEG, SunDirection.SETTING),
}
SUN_ALLOWANCE_S = 120.0  # for errors of the equations, refraction and a raised observer
BOX_STEP_DEG = 0.1  # the sun is computed on the corners of such a grid, so that neighbouring zones share values; 24 s of the sun's movement
MAX_WINDOW_S = 400 * DAY_S  # over more days a zone that applies at times counts as always applying
EPOCH_WEEKDAY = DAYS.index("THU")  # of 1970-01-01
_TIME = re.compile(r"(\d{2}):(\d{2}):(\d{2})Z")
Box = tuple[float, float, float, float]  # west, south, east, north [deg]
Place = tuple[float, float]


@lru_cache(maxsize=100_000)
def sun_event_s(event: str, day: int, lon_deg: float, lat_deg: float) -> float | None:
    """Return seconds since the epoch of an event (schedule.EVENTS) on a solar day at sea level; None where it does not happen.

    day counts from 1970-01-01 by the place's mean solar time, so that sunrise comes before sunset everywhere. Accurate to a minute below 65
    degrees of latitude. Raises KeyError for another event. Source: NOAA solar equations as in the library astral, after J. Meeus,
    Astronomical Algorithms.
    """
    zenith_deg, direction = _ZENITH_AND_DIRECTION[event]
    latitude = min(max(lat_deg, -MAX_LAT_DEG), MAX_LAT_DEG)
    midnight = julianday(EPOCH + timedelta(days=day))
    minutes = 720.0 - 4.0 * lon_deg
    for _ in range(ROUNDS):
        century = julianday_to_juliancentury(midnight + minutes / 1440.0)
        try:
            angle_deg = degrees(hour_angle(latitude, sun_declination(century), zenith_deg, direction))
        except ValueError:  # its cosine exceeds 1: the sun stays above or below all day
            return None
        minutes = 720.0 - 4.0 * (lon_deg + angle_deg) - eq_of_time(century)
    return day * DAY_S + minutes * 60.0


class TimeSpan(NamedTuple):
    """A span of time, its end excluded; seconds since the epoch, UTC."""

    from_s: float
    to_s: float


def active_spans(schedule: Schedule | None, box: Box, from_s: float, to_s: float, margin_s: float = 0.0) -> tuple[TimeSpan, ...]:
    """Return when a zone in the box applies between two moments: disjoint spans in order, each wider by the margin on both sides.

    schedule is in the form of checked_schedule; None applies always. Days and times of day are UTC. With the sun, "Monday" is Monday in UTC
    as well as at the place, and the span reaches from the earliest start to the latest end in the box. Where an event does not happen at
    all, the zone applies that whole day; where it happens only in a part of the box, until the end of the third day after.
    """
    if not from_s < to_s:
        return ()
    always = (TimeSpan(from_s, to_s),)
    if not schedule:
        return always
    try:
        spans = [span for period in schedule for span in _of_period(period, box, from_s - margin_s, to_s + margin_s)]
    except (ArithmeticError, AttributeError, KeyError, TypeError, ValueError):
        return always
    return merged((TimeSpan(max(start - margin_s, from_s), min(end + margin_s, to_s)) for start, end in spans))


def merged(spans: Iterable[TimeSpan]) -> tuple[TimeSpan, ...]:
    """Return the same time in as few spans as possible, in order; empty ones are omitted."""
    joined: list[TimeSpan] = []
    for span in sorted(span for span in spans if span.from_s < span.to_s):
        if joined and span.from_s <= joined[-1].to_s:
            joined[-1] = TimeSpan(joined[-1].from_s, max(joined[-1].to_s, span.to_s))
        else:
            joined.append(span)
    return tuple(joined)


def _of_period(period: dict[str, Any], box: Box, from_s: float, to_s: float) -> Iterator[TimeSpan]:
    start, end = _moment_s(period["startDateTime"], -math.inf), _moment_s(period["endDateTime"], math.inf, is_end=True)
    first, last = max(start, from_s), min(end, to_s)
    if not first < last:
        return
    entries = period["schedule"]
    if not entries:
        yield TimeSpan(first, last)
        return
    if last - first > MAX_WINDOW_S:
        raise ValueError("too many days to look at")
    for entry in entries:
        weekdays = _weekdays(entry["day"])
        # An entry may begin half a day before its day in UTC, and last two and a half days.
        for day in range(math.floor(first / DAY_S) - 3, math.floor(last / DAY_S) + 2):
            if (day + EPOCH_WEEKDAY) % 7 in weekdays:
                yield from (TimeSpan(max(span.from_s, first), min(span.to_s, last)) for span in _of_entry(entry, day, box))


def _of_entry(entry: dict[str, Any], day: int, box: Box) -> Iterator[TimeSpan]:
    start_s, end_s = _time_s(entry["startTime"]), _time_s(entry["endTime"], is_end=True)
    start_event, end_event = entry["startEvent"], entry["endEvent"]
    if (start_s is not None and start_event) or (end_s is not None and end_event):
        raise ValueError("a time and an event at one end")
    midnight = day * DAY_S
    if not start_event and not end_event:
        start = midnight + (start_s or 0.0)
        yield TimeSpan(start, _after(start, midnight + (DAY_S if end_s is None else end_s)))
        return
    places = _places(box)
    for starts in _starts(start_event, start_s, day, places):
        known = [(place, start) for place, start in zip(places, starts, strict=True) if start is not None]
        ends = [_end(end_event, end_s, place, start, day) for place, start in known]
        if known:
            if len(known) < len(places):  # it begins somewhere in between, and its end may be as late as where it never happens
                ends.append((day + 3) * DAY_S)
            early, late = SUN_ALLOWANCE_S if start_event else 0.0, SUN_ALLOWANCE_S if end_event else 0.0
            yield TimeSpan(min(start for _place, start in known) - early, max(ends) + late)
    for lon, lat in places:
        if any(event and sun_event_s(event, day, lon, lat) is None for event in (start_event, end_event)):
            yield TimeSpan(midnight + min(0.0, -_solar_s(lon)), midnight + DAY_S + max(0.0, -_solar_s(lon)))


def _starts(event: str | None, time_s: float | None, day: int, places: list[Place]) -> Iterator[list[float | None]]:
    """Yield for each reading of "on that day" the start at each place: by UTC, and by the sun at the place."""
    midnight = day * DAY_S
    if event:
        for solar_day in (day - 1, day, day + 1):
            starts = [sun_event_s(event, solar_day, lon, lat) for lon, lat in places]
            if solar_day == day or any(start is not None and math.floor(start / DAY_S) == day for start in starts):
                yield starts
        return
    yield [midnight + (time_s or 0.0)] * len(places)
    if time_s is None:
        yield [midnight - _solar_s(lon) for lon, _lat in places]


def _end(event: str | None, time_s: float | None, place: Place, start: float, day: int) -> float:
    """Return the first end after a start; if the sun gives none, three days later."""
    lon, lat = place
    if event:
        moments = (sun_event_s(event, solar_day, lon, lat) for solar_day in range(day - 2, day + 4))
        return next((moment for moment in moments if moment is not None and moment > start), (day + 3) * DAY_S)
    midnight = day * DAY_S
    return _after(start, midnight + (DAY_S + max(0.0, -_solar_s(lon)) if time_s is None else time_s))


def _after(start: float, end: float) -> float:
    """Return the end on its day, or on the first later day, that is after the start."""
    return end if end > start else end + DAY_S * (math.floor((start - end) / DAY_S) + 1)


def _solar_s(lon_deg: float) -> float:
    """Return how far a place's mean solar time is ahead of UTC."""
    return lon_deg * DAY_S / 360.0


def _places(box: Box) -> list[Place]:
    """Return corners and centre of the box, extended to whole steps."""
    west, south = (math.floor(edge / BOX_STEP_DEG) * BOX_STEP_DEG for edge in box[:2])
    east, north = (math.ceil(edge / BOX_STEP_DEG) * BOX_STEP_DEG for edge in box[2:])
    return [(west, south), (east, south), (west, north), (east, north), ((west + east) / 2, (south + north) / 2)]


def _weekdays(days: list[str]) -> frozenset[int]:
    return frozenset(range(7)) if "ANY" in days else frozenset(DAYS.index(day) for day in days)


def _moment_s(value: str | None, otherwise: float, *, is_end: bool = False) -> float:
    if value is None:
        return otherwise
    moment = datetime.fromisoformat(value.replace("Z", "+00:00"))
    if moment.tzinfo is None:
        raise ValueError("a moment without a time zone")
    return moment.timestamp() + (1.0 if is_end and moment.second == 59 else 0.0)


def _time_s(value: str | None, *, is_end: bool = False) -> float | None:
    """Return seconds after midnight. An end in the last second of a minute, or in a day's last minute, means the start of the next one."""
    if value is None:
        return None
    match = _TIME.fullmatch(value)
    if match is None:
        raise ValueError("no time of day")
    hour, minute, second = int(match[1]), int(match[2]), int(match[3])
    if is_end and (hour, minute) == (23, 59):
        return DAY_S
    return hour * 3600.0 + minute * 60.0 + second + (1.0 if is_end and second == 59 else 0.0)
