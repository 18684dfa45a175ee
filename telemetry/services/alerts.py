"""Alerts: opened with their cause, closed with it."""

from typing import Any

from django.utils import timezone

from missions.models import Mission, Uav
from telemetry.models import Alert, AlertLevel

SECOND_SENDER = "second-sender"


def open_alert(
    *, uav: Uav, level: AlertLevel, code: str, message: str, mission: Mission | None = None, details: dict[str, Any] | None = None
) -> Alert:
    """Of one cause there is one open alert: opened again, it says the newer words."""
    now = timezone.now()
    alert = Alert(
        organisation_id=uav.organisation_id, uav=uav, mission=mission, level=level, code=code, message=message[:500],
        details=details or {}, opened_at=now,
    )  # fmt: skip
    inserted = Alert.objects.bulk_create([alert], ignore_conflicts=True)
    open_one = Alert.objects.filter(uav=uav, code=code, closed_at=None).first()
    if open_one is None:  # closed in this moment
        return inserted[0]
    if (open_one.message, open_one.details, open_one.level) != (alert.message, alert.details, alert.level):
        Alert.objects.filter(pk=open_one.pk).update(message=alert.message, details=alert.details, level=level)
        open_one.refresh_from_db()
    return open_one


def close_alert(*, uav: Uav, code: str) -> bool:
    """Whether one was open."""
    return bool(Alert.objects.filter(uav=uav, code=code, closed_at=None).update(closed_at=timezone.now()))


def tell_of_second_sender(*, uav_id: int, words: str) -> None:
    """Without words it is over."""
    uav = Uav.objects.filter(pk=uav_id).first()
    if uav is None:
        return
    if words:
        open_alert(uav=uav, level=AlertLevel.WARNING, code=SECOND_SENDER, message=words)
    else:
        close_alert(uav=uav, code=SECOND_SENDER)
