"""When zones apply, instant by instant, and the sun by the short sunrise equation: for judges of plans, without the program's own rules."""

import math
from datetime import UTC, date, datetime, timedelta
from functools import lru_cache
from typing import Any

DAYS = ("MON", "TUE", "WED", "THU", "FRI", "SAT", "SUN")


def applies_at(schedule: list[dict[str, Any]], when: datetime, lon: float, lat: float, *, is_wide: bool = False) -> bool:
    """Whether a zone applies at a moment; where the sun bounds it, not within 4 min of that, which another formula may see otherwise.

    is_wide: a day that the sun opens or closes may also begin and end at the sun's midnight.
    """
    for period in schedule:
        begin, end = (None if period[name] is None else datetime.fromisoformat(period[name]) for name in ("startDateTime", "endDateTime"))
        if (begin is not None and when < begin) or (end is not None and when >= end):
            continue
        if not period["schedule"]:
            return True
        for entry in period["schedule"]:
            for back in (0, 1):
                day = when.date() - timedelta(days=back)
                if ("ANY" in entry["day"] or DAYS[day.weekday()] in entry["day"]) and _is_in_entry(
                    entry, day, when, lon, lat, is_wide=is_wide
                ):
                    return True
    return False


def _is_in_entry(entry: dict[str, Any], day: date, when: datetime, lon: float, lat: float, *, is_wide: bool) -> bool:
    starts, ends = _moments(entry, "start", day, lon, lat), _moments(entry, "end", day, lon, lat)
    if is_wide and (entry["startEvent"] or entry["endEvent"]):
        solar = timedelta(hours=lon / 15.0)
        starts += [] if entry["startEvent"] or entry["startTime"] else [start - solar for start in starts]
        ends = ends if entry["endEvent"] or entry["endTime"] else [max(end, end - solar) for end in ends]
    early, late = (timedelta(minutes=4 if entry[f"{side}Event"] else 0) for side in ("start", "end"))
    for start in starts:
        after = [end for end in ends if end > start]
        if after and start + early <= when < min(after) - late:
            return True
    return False


def _moments(entry: dict[str, Any], side: str, day: date, lon: float, lat: float) -> list[datetime]:
    """When an entry may begin on a day, or end after that."""
    midnight = datetime(day.year, day.month, day.day, tzinfo=UTC)
    event, time = entry[f"{side}Event"], entry[f"{side}Time"]
    if event:
        found = [sun(event, day + timedelta(days=more), lon, lat) for more in (-1, 0, 1, 2)]
        return [moment for moment in found if moment is not None and (side == "end" or moment.date() == day)]
    if time is None:
        return [midnight + timedelta(days=1 if side == "end" else 0)]
    hour, minute, second = (int(part) for part in time.rstrip("Z").split(":"))
    moment = midnight + timedelta(hours=hour, minutes=minute, seconds=second)
    return [moment, moment + timedelta(days=1)] if side == "end" else [moment]


@lru_cache(maxsize=10_000)
def sun(event: str, day: date, lon: float, lat: float) -> datetime | None:
    """Sunrise equation: mean anomaly, equation of the centre, declination, hour angle; right within two minutes."""
    below_deg = -0.833 if event in {"SR", "SS"} else -6.0
    number = (day - date(2000, 1, 1)).days
    noon = number + 0.0009 - lon / 360.0
    anomaly = math.radians((357.5291 + 0.98560028 * noon) % 360)
    centre = 1.9148 * math.sin(anomaly) + 0.02 * math.sin(2 * anomaly) + 0.0003 * math.sin(3 * anomaly)
    ecliptic = math.radians((math.degrees(anomaly) + centre + 282.9372) % 360)
    transit = noon + 0.0053 * math.sin(anomaly) - 0.0069 * math.sin(2 * ecliptic)
    tilt = math.asin(math.sin(ecliptic) * math.sin(math.radians(23.4397)))
    north = math.radians(lat)
    angle = (math.sin(math.radians(below_deg)) - math.sin(north) * math.sin(tilt)) / (math.cos(north) * math.cos(tilt))
    if abs(angle) > 1:
        return None
    turn = math.degrees(math.acos(angle)) / 360.0
    moment = transit + (turn if event in {"SS", "EECT"} else -turn)
    return datetime(2000, 1, 1, 12, tzinfo=UTC) + timedelta(days=moment)
