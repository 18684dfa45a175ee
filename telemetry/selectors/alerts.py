"""Reads of alerts."""

from collections import defaultdict
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import TYPE_CHECKING, Any, TypedDict
from uuid import UUID

from django.db.models import Count, Q, QuerySet

from telemetry.alerting.advice import answer_of, figures_of
from telemetry.models import Alert, AlertLevel
from workspace.models import Organisation

MIXED, OTHER_LIST = "mission-mixed", "other-list-on-board"  # codes
WORST = "worst"  # in the details of an alert: its worst message so far
BY_PERSON = "by-person"  # close reason


@dataclass(frozen=True, slots=True)
class OpenRow:
    """An open alert with the fields that the estimator needs."""

    id: int
    uav_id: int
    code: str
    subject: str
    level: str
    message: str
    values: Mapping[str, Any]
    written_at: datetime
    worst: Mapping[str, Any] | None = None  # services/alerts/rows.py
    answer: tuple[Any, ...] = (None, None, None)  # as returned by answer_of
    figures: Mapping[str, Any] = field(default_factory=dict)  # as returned by figures_of


def open_alerts_of(uav_ids: Collection[int], codes: Collection[str]) -> dict[int, list[OpenRow]]:
    found: dict[int, list[OpenRow]] = defaultdict(list)
    rows = Alert.objects.filter(uav__in=uav_ids, code__in=codes, closed_at=None)
    for row in rows.values_list("pk", "uav_id", "code", "subject", "level", "message", "values", "written_at", "details"):
        found[row[1]].append(OpenRow(*row[:8], worst=row[8].get(WORST), answer=answer_of(row[8]), figures=figures_of(row[8])))
    return found


def waiting_to_be_seen() -> Q:
    """Return the condition for critical alerts that ended unacknowledged, however old (ANSI/ISA-18.2: unacknowledged, returned to normal).

    Its terms match the index alert_waits_to_be_seen_idx.
    """
    return Q(level=AlertLevel.CRITICAL, acknowledged_at=None, closed_at__isnull=False)


def unanswered_counts(organisation: Organisation) -> dict[str, int]:
    """Return the number of unacknowledged alerts by level: open ones, and critical ones that have ended."""
    rows = Alert.objects.filter(Q(closed_at=None, acknowledged_at=None) | waiting_to_be_seen(), organisation=organisation)
    return dict.fromkeys(AlertLevel.values, 0) | dict(rows.order_by().values_list("level").annotate(Count("pk")))


class NotesOfAlert(TypedDict):
    note_count: int


if TYPE_CHECKING:
    from django_stubs_ext import WithAnnotations

    AlertWithNotes = WithAnnotations[Alert, NotesOfAlert]
else:
    AlertWithNotes = Alert


def alerts_of_organisation(organisation: Organisation) -> QuerySet[AlertWithNotes]:
    return Alert.objects.filter(organisation=organisation).select_related("acknowledged_by", "uav").annotate(note_count=Count("notes"))


@dataclass(frozen=True, slots=True)
class AlertFilter:
    """None or empty: any value."""

    is_open: bool | None = None
    is_acknowledged: bool | None = None
    levels: tuple[str, ...] = ()
    codes: tuple[str, ...] = ()
    uav_id: int | None = None
    mission_id: UUID | None = None
    opened_from: datetime | None = None
    opened_before: datetime | None = None


def alerts_that_match(organisation: Organisation, wanted: AlertFilter) -> QuerySet[AlertWithNotes]:
    alerts = alerts_of_organisation(organisation)
    if wanted.is_open is not None:
        alerts = alerts.filter(closed_at__isnull=wanted.is_open)
    if wanted.is_acknowledged is not None:
        alerts = alerts.filter(acknowledged_at__isnull=not wanted.is_acknowledged)
    values: dict[str, Any] = {
        "level__in": wanted.levels, "code__in": wanted.codes, "uav": wanted.uav_id, "mission": wanted.mission_id,
        "opened_at__gte": wanted.opened_from, "opened_at__lt": wanted.opened_before,
    }  # fmt: skip
    return alerts.filter(**{name: value for name, value in values.items() if value})
