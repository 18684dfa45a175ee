"""The register of zones: what filters, sorts and counts them, and when each applies next."""

from collections import Counter
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Any

from django.contrib.gis.db.models.functions import AsWKB
from django.db.models import F, FloatField, Q, QuerySet, Value
from django.db.models.functions import Coalesce, Upper
from shapely import from_wkb

from inspection.selectors.assets import Box, DrawnZone, zones
from inspection.zones.activity import DAY_S, active_spans
from inspection.zones.activity import Box as ZoneBox
from inspection.zones.schedule import Schedule

AHEAD_S = 8 * DAY_S  # a weekly schedule begins or ends within this time
UNSTATED_M = 1e9  # a limit that is not stated counts as reaching: it sorts last
NOT_STATED = "not_stated"  # as value of a filter


@dataclass(frozen=True)
class ZoneFilter:
    """None or empty: any. NOT_STATED finds zones whose source states no restriction or reason."""

    box: Box | None = None
    text: str = ""
    zone_set: int | None = None
    restriction: str = ""
    reason: str = ""  # one of several
    active_at: datetime | None = None


@dataclass(frozen=True)
class Activity:
    """Whether a zone applies at a moment, and when this changes; changes_at is None if it does not within AHEAD_S."""

    is_active: bool
    changes_at: datetime | None


@dataclass(frozen=True)
class ZoneCounts:
    """Numbers of zones. Those of a fact disregard the filter by this fact; "" counts zones that do not state it."""

    total: int
    restrictions: dict[str, int]
    reasons: dict[str, int]
    zone_sets: dict[int | None, int]


def zones_that_match(wanted: ZoneFilter) -> QuerySet[DrawnZone]:
    found = zones(box=wanted.box, text=wanted.text, zone_set=wanted.zone_set)
    if wanted.restriction:
        found = found.filter(restriction="" if wanted.restriction == NOT_STATED else wanted.restriction)
    if wanted.reason == NOT_STATED:
        found = found.filter(reason="")
    elif wanted.reason:
        found = found.filter(_has_reason(wanted.reason))
    return found.filter(pk__in=_active(found, wanted.active_at)) if wanted.active_at is not None else found


def _has_reason(reason: str) -> Q:
    return Q(reason=reason) | Q(reason__startswith=f"{reason}, ") | Q(reason__endswith=f", {reason}") | Q(reason__contains=f", {reason}, ")


def _active(found: QuerySet[DrawnZone], moment: datetime) -> list[int]:
    """Return the keys of the zones that apply at the moment; those without a schedule always do."""
    rows = found.order_by().annotate(wkb=AsWKB("geometry")).values_list("pk", "schedule", "wkb")
    always = found.order_by().filter(schedule__isnull=True).values_list("pk", flat=True)
    timed = (key for key, schedule, wkb in rows.filter(schedule__isnull=False) if activity_of(schedule, _bounds(wkb), moment).is_active)
    return [*always, *timed]


def _bounds(wkb: Any) -> ZoneBox:
    west, south, east, north = from_wkb(bytes(wkb)).bounds
    return west, south, east, north


def activity_of(schedule: Schedule | None, box: ZoneBox, moment: datetime) -> Activity:
    """Return whether a zone in the box applies at the moment, and when this changes."""
    now_s = moment.timestamp()
    spans = active_spans(schedule, box, now_s, now_s + AHEAD_S)
    first = spans[0] if spans else None
    is_active = first is not None and first.from_s <= now_s
    change_s = None if first is None else first.to_s if is_active else first.from_s
    is_known = change_s is not None and change_s < now_s + AHEAD_S
    return Activity(is_active, datetime.fromtimestamp(change_s, UTC) if is_known and change_s is not None else None)


_ORDERS: dict[str, Any] = {
    "name": Upper("name"),
    "restriction": F("restriction"),
    "reason": F("reason"),
    "lower": Coalesce("lower_limit_m", Value(UNSTATED_M), output_field=FloatField()),
    "upper": Coalesce("upper_limit_m", Value(UNSTATED_M), output_field=FloatField()),
    "set": Coalesce(Upper("zone_set__name"), Value("")),
    "changed": F("updated_at"),
}
ZONE_ORDERS = tuple(_ORDERS)


def zones_in_order(found: QuerySet[DrawnZone], order: str) -> tuple[QuerySet[DrawnZone], tuple[str, ...]]:
    """Return the zones with what an order compares, and the names to sort by; "-" before it reverses the order."""
    sign = "-" if order.startswith("-") else ""
    return found.annotate(sort_value=_ORDERS[order.removeprefix("-")]), (f"{sign}sort_value", f"{sign}pk")


def zone_counts(wanted: ZoneFilter) -> ZoneCounts:
    """Count the zones of a filter with one query, and one more for zones that apply at times."""
    rows = zones_that_match(replace(wanted, zone_set=None, restriction="", reason="")).order_by()
    restrictions, reasons, zone_sets, total = Counter[str](), Counter[str](), Counter[int | None](), 0
    for restriction, reason, zone_set in rows.values_list("restriction", "reason", "zone_set"):
        stated = reason.split(", ") if reason else [""]
        of_set = wanted.zone_set is None or zone_set == wanted.zone_set
        of_restriction = not wanted.restriction or (restriction or NOT_STATED) == wanted.restriction
        of_reason = not wanted.reason or wanted.reason in stated or (wanted.reason == NOT_STATED and not reason)
        restrictions[restriction] += of_set and of_reason
        reasons.update(dict.fromkeys(stated, int(of_set and of_restriction)))
        zone_sets[zone_set] += of_restriction and of_reason
        total += of_set and of_restriction and of_reason
    return ZoneCounts(total, _some(restrictions), _some(reasons), {key: number for key, number in zone_sets.items() if number})


def _some(counted: Counter[str]) -> dict[str, int]:
    return {value: number for value, number in counted.items() if number}
