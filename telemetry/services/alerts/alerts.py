"""Alerts: opened and closed with their cause, acknowledged and noted by users."""

from collections.abc import Collection
from datetime import datetime
from typing import Any

from django.db import transaction
from django.db.models import Exists, F, OuterRef, Q
from django.utils import timezone

from missions.models import Mission, Uav
from telemetry.alerting.detection import RANK
from telemetry.alerting.state_machine import CLEARED
from telemetry.models import Alert, AlertLevel, AlertNote
from telemetry.selectors.alerts import waiting_to_be_seen
from workspace.audit import record_change
from workspace.live.changes import publish_live
from workspace.models import Organisation, User

SECOND_SENDER = "second-sender"
SENDERS = "Two senders say that they are %(uav)s: %(believed)s, which is believed, and %(other)s."
COPIES = (
    "The signed frames of %(uav)s come from two addresses, %(believed)s and %(other)s. Both are answered; one may belong to a listener."
)
OPENED, ROSE, ACKNOWLEDGED, CLOSED = "opened", "rose", "acknowledged", "closed"
STILL_OPEN, UNKNOWN = "still-open", "unknown"  # beside ACKNOWLEDGED: outcomes of acknowledging an ended alert


class LevelRose(Exception):
    """The alert has risen above the level that the user saw. `alert` is its present state."""

    def __init__(self, alert: Alert) -> None:
        super().__init__(f"{alert.code} rose to {alert.level}")
        self.alert = alert


def step(what: str, at: Any, **facts: Any) -> dict[str, Any]:
    """Return an entry of an alert's history."""
    return {"at": at.isoformat(), "what": what, **facts}


def open_alert(
    *,
    uav: Uav,
    level: AlertLevel,
    code: str,
    message: str,
    values: dict[str, Any] | None = None,
    mission: Mission | None = None,
    details: dict[str, Any] | None = None,
    subject: str = "",
) -> Alert:
    """Open the alert of a cause, or update the open one. `message` is a template for the values.

    A change may lower or raise its level; raising it resets the acknowledgement.
    """
    now = timezone.now()
    alert = Alert(
        organisation_id=uav.organisation_id, uav=uav, mission=mission, level=level, code=code, subject=subject, message=message[:500],
        values=values or {}, details=details or {}, opened_at=now, written_at=now, course=[step(OPENED, now, level=str(level))],
    )  # fmt: skip
    with transaction.atomic():
        inserted = Alert.objects.bulk_create([alert], ignore_conflicts=True)
        open_one = Alert.objects.select_for_update().filter(uav=uav, code=code, subject=subject, closed_at=None).first()
        if open_one is None:  # closed at this moment
            return inserted[0]
        stated = (alert.message, alert.values, alert.details, alert.level)
        if (open_one.message, open_one.values, open_one.details, open_one.level) != stated:
            if RANK[level] > RANK[open_one.level]:
                open_one.acknowledged_at = open_one.acknowledged_by = None
                open_one.course = [*open_one.course, step(ROSE, now, level=str(level))]
            open_one.message, open_one.values, open_one.details, open_one.level = stated
            open_one.written_at, open_one.revision = now, open_one.revision + 1
            open_one.save()
        _notify(uav.organisation_id)
    return open_one


def close_alert(*, uav: Uav, code: str) -> bool:
    """Close the alert; return whether one was open."""
    now = timezone.now()
    with transaction.atomic():
        alert = Alert.objects.select_for_update().filter(uav=uav, code=code, closed_at=None).first()
        if alert is None:
            return False
        Alert.objects.filter(pk=alert.pk).update(
            closed_at=now, close_reason=CLEARED, revision=F("revision") + 1, course=[*alert.course, step(CLOSED, now, reason=CLEARED)]
        )
        _notify(uav.organisation_id)
    return True


def acknowledge_alert(*, alert: Alert, actor: User, note: str = "", seen_level: str | None = None) -> Alert:
    """Acknowledge an alert: it stays open and silent. A second acknowledgement keeps the first user and adds the note.

    Earlier ended alerts of the same cause are acknowledged with it. Raises LevelRose if its unacknowledged level is above `seen_level`;
    None: any level.
    """
    with transaction.atomic():
        held = _acknowledge_cause(alert, actor, note, seen_level)
        if note:
            note_alert(alert=held, actor=actor, text=note)
        _notify(held.organisation_id)
    return held


def acknowledge_ended(*, organisation: Organisation, alert_ids: Collection[int], actor: User) -> dict[int, str]:
    """Acknowledge critical alerts that have ended, one by one; return by id ACKNOWLEDGED, STILL_OPEN or UNKNOWN.

    Open alerts are left unchanged. Previously acknowledged ones count as acknowledged. Earlier ended ones of the same cause are
    acknowledged with them.
    """
    outcomes, now = dict.fromkeys(alert_ids, UNKNOWN), timezone.now()
    with transaction.atomic():
        own = Alert.objects.filter(organisation=organisation)
        cause = {name: OuterRef(name) for name in ("uav", "code", "subject")}
        later = own.filter(pk__in=alert_ids, closed_at__isnull=False, opened_at__gt=OuterRef("opened_at"), **cause)
        wanted = own.filter(Q(pk__in=alert_ids) | (waiting_to_be_seen() & Exists(later))).select_related("organisation")
        for alert in wanted.select_for_update(of=("self",)).order_by("pk"):
            is_new = alert.closed_at is not None and alert.acknowledged_at is None
            if is_new:
                _acknowledge(alert, actor, now)
            if alert.pk in outcomes:
                outcomes[alert.pk] = STILL_OPEN if alert.closed_at is None else ACKNOWLEDGED
                if is_new:
                    _record_acknowledged(alert, actor)
        _notify(organisation.pk)
    return outcomes


def _acknowledge_cause(alert: Alert, actor: User, note: str = "", seen_level: str | None = None) -> Alert:
    """Acknowledge the alert and earlier ended ones of its cause, all locked in one order. Raises LevelRose."""
    earlier = Q(organisation=alert.organisation_id, uav=alert.uav_id, code=alert.code, subject=alert.subject, opened_at__lt=alert.opened_at)
    same = earlier & waiting_to_be_seen()
    rows = {row.pk: row for row in Alert.objects.select_for_update().filter(Q(pk=alert.pk) | same).order_by("pk")}
    held, now = rows.pop(alert.pk), timezone.now()
    if held.acknowledged_at is not None:
        return held
    if seen_level is not None and RANK[held.level] > RANK[seen_level]:
        raise LevelRose(held)
    for row in (held, *rows.values()):
        _acknowledge(row, actor, now)
    _record_acknowledged(held, actor, note)
    return held


def _record_acknowledged(alert: Alert, actor: User, note: str = "") -> None:
    _record(alert, actor, "acknowledge", {"code": alert.code, "level": alert.level, "uav": alert.uav_id, "note": note})


def _acknowledge(alert: Alert, actor: User, now: datetime) -> None:
    alert.acknowledged_at, alert.acknowledged_by = now, actor
    alert.course = [*alert.course, step(ACKNOWLEDGED, now, by=actor.display_name)]
    alert.revision += 1
    alert.save(update_fields=["acknowledged_at", "acknowledged_by", "course", "revision"])


def note_alert(*, alert: Alert, actor: User, text: str) -> AlertNote:
    with transaction.atomic():
        Alert.objects.filter(pk=alert.pk).update(revision=F("revision") + 1)
        note = AlertNote.objects.create(alert=alert, author=actor, text=text)
        note.refresh_from_db()
        _record(alert, actor, "note", {"note": note.pk, "text": text})
        _notify(alert.organisation_id)
    return note


def alert_was_closed(alert: Alert, actor: User, reason: str) -> None:
    """Write the closing of an alert by a user to the audit log."""
    _record(alert, actor, "close", {"code": alert.code, "level": alert.level, "uav": alert.uav_id, "reason": reason})


def raise_second_sender(*, uav_id: int, believed: str = "", other: str = "", is_signed: bool = False) -> None:
    """Open the alert of a second sender, or close it without `other`."""
    uav = Uav.objects.filter(pk=uav_id).first()
    if uav is None:
        return
    if other:
        values = {"uav": uav.name, "believed": believed, "other": other}
        open_alert(uav=uav, level=AlertLevel.WARNING, code=SECOND_SENDER, message=COPIES if is_signed else SENDERS, values=values)
    else:
        close_alert(uav=uav, code=SECOND_SENDER)


def _record(alert: Alert, actor: User, action: str, after: dict[str, Any]) -> None:
    record_change(
        organisation=alert.organisation, actor=actor, action=action, subject_type="alert", subject_id=alert.pk, after=after
    )  # fmt: skip


def _notify(organisation_id: int) -> None:
    transaction.on_commit(lambda: publish_live(organisation_id))
