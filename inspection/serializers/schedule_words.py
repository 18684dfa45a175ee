"""When a zone applies, in words for people, in the language of whoever asks."""

from datetime import datetime
from typing import Any

from django.utils.formats import date_format
from django.utils.translation import gettext as _

from inspection.zones.schedule import DAYS, Schedule


def schedule_sentence(schedule: Schedule | None) -> str:
    """ "Mon to Fri 08:00 to 18:00 UTC, until 31 Dec 2026"."""
    if schedule is None:
        return _("Always")
    return "; ".join(_period_words(period) for period in schedule)


def _period_words(period: dict[str, Any]) -> str:
    times = ", ".join(_entry_words(entry) for entry in period["schedule"])
    if not times:
        return _dates_words(period["startDateTime"], period["endDateTime"])
    values = {"times": times, "start": _date_words(period["startDateTime"]), "end": _date_words(period["endDateTime"])}
    if values["start"] and values["end"]:
        return _("%(times)s, from %(start)s to %(end)s") % values
    if values["start"]:
        return _("%(times)s, from %(start)s") % values
    return _("%(times)s, until %(end)s") % values if values["end"] else times


def _dates_words(start: str | None, end: str | None) -> str:
    """ "21 Nov 2026, 14:00 to 17:00 UTC" of a few hours of one day."""
    values = {"start": _date_words(start), "end": _date_words(end)}
    if start and end:
        if start[:10] == end[:10]:
            return _("%(day)s, %(start)s to %(end)s UTC") % {"day": _day_words(start), "start": start[11:16], "end": end[11:16]}
        return _("from %(start)s to %(end)s") % values
    if start:
        return _("from %(start)s on") % values
    return _("until %(end)s") % values if end else _("all the time")


def _entry_words(entry: dict[str, Any]) -> str:
    values = {"days": _days_words(entry["day"]), "start": _side_words(entry, "start"), "end": _side_words(entry, "end")}
    if not values["start"] and not values["end"]:
        return _("%(days)s all day") % values
    values["start"] = values["start"] or _("the day begins")
    values["end"] = values["end"] or _("the day ends")
    words = _("%(days)s %(start)s to %(end)s") % values
    return f"{words} UTC" if entry["startTime"] or entry["endTime"] else words


def _side_words(entry: dict[str, Any], side: str) -> str:
    if event := entry[f"{side}Event"]:
        return _events()[event]
    return (entry[f"{side}Time"] or "")[:5]


def _events() -> dict[str, str]:
    return {
        "BMCT": _("morning civil twilight"),
        "SR": _("sunrise"),
        "SS": _("sunset"),
        "EECT": _("the end of evening civil twilight"),
    }


def _days_words(days: list[str]) -> str:
    if days == ["ANY"]:
        return _("daily")
    short = dict(zip(DAYS, (_("Mon"), _("Tue"), _("Wed"), _("Thu"), _("Fri"), _("Sat"), _("Sun")), strict=True))
    numbers = [DAYS.index(day) for day in days]
    if len(numbers) > 2 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return _("%(first)s to %(last)s") % {"first": short[days[0]], "last": short[days[-1]]}
    return ", ".join(short[day] for day in days)


def _date_words(moment: str | None) -> str:
    if moment is None:
        return ""
    clock = "" if moment[11:16] in {"00:00", "23:59"} else f" {moment[11:16]} UTC"
    return f"{_day_words(moment)}{clock}"


def _day_words(moment: str) -> str:
    return date_format(datetime.fromisoformat(moment.replace("Z", "+00:00")), "j M Y")
