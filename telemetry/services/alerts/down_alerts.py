"""Alerts of UAVs that are down off plan: opened at once, and closed only by a user."""

from uuid import UUID

from django.db import transaction
from django.utils import timezone

from inspection.geodesy import LonLat
from missions.models import Approval, Uav
from telemetry.alerting.detectors import down
from telemetry.models import Alert, AlertLevel, AlertNote
from telemetry.selectors.alerts import BY_PERSON
from telemetry.services.alerts.alerts import CLOSED, alert_was_closed, note_alert, open_alert, step
from telemetry.services.approved_flights import flight_model
from workspace.models import User


class ClosedByItself(Exception):
    """An alert that closes with its cause cannot be closed by a user."""


def raise_failed_flight(*, uav_id: int, approval_id: UUID, flight: int) -> None:
    """Open the alert if a companion computer reports a failed flight and the UAV is away from its planned places."""
    model, uav = flight_model(approval_id, uav_id, flight), Uav.objects.get(pk=uav_id)
    position = LonLat(*uav.location.coords[:2])
    if model is None or (away_m := down.away_from_plan_m(model.line, position, model.rally_points)) < down.AWAY_M:
        return
    found = down.detection(uav.name, flight, position, away_m)
    open_alert(
        uav=uav, level=AlertLevel(found.level), code=found.code, message=found.message, values=found.values, details=found.details,
        mission=Approval.objects.select_related("mission").get(pk=approval_id).mission, subject=found.subject,
    )  # fmt: skip


def close_down_alert(*, alert: Alert, actor: User, reason: str) -> AlertNote | None:
    """Close the alert with a user's reason. Returns None if it is already closed. Raises ClosedByItself for any other alert."""
    if alert.code != down.CODE:
        raise ClosedByItself
    now = timezone.now()
    with transaction.atomic():
        held = Alert.objects.select_for_update().get(pk=alert.pk)
        if held.closed_at is not None:
            return None
        held.closed_at, held.close_reason, held.revision = now, BY_PERSON, held.revision + 1
        held.course = [*held.course, step(CLOSED, now, reason=BY_PERSON, by=actor.display_name)]
        if held.acknowledged_at is None:
            held.acknowledged_at, held.acknowledged_by = now, actor
        held.save(update_fields=["closed_at", "close_reason", "revision", "course", "acknowledged_at", "acknowledged_by"])
        alert_was_closed(held, actor, reason)
        return note_alert(alert=held, actor=actor, text=reason)
