"""Where alerts begin, as somebody stated it for a UAV type or a mission."""

from typing import Any

from django.db import transaction

from missions.models import Mission, UavType
from telemetry.alerting.limits import checked_limits, limits_of
from workspace.models import User
from workspace.services import record_change


def state_alert_limits(*, row: UavType | Mission, limits: Any, actor: User) -> None:
    """All that differ from the usual ones. Nothing else of the row is touched. Raises InvalidLimits."""
    stated = checked_limits(limits)
    limits_of(stated)
    with transaction.atomic():
        rows = Mission.objects.filter(pk=row.pk) if isinstance(row, Mission) else UavType.objects.filter(pk=row.pk)
        held = rows.select_for_update(no_key=True).get()
        before, held.alert_limits = held.alert_limits, stated
        if before != stated:
            rows.update(alert_limits=stated)
            record_change(
                organisation=row.organisation, actor=actor, action="state-alert-limits",
                subject_type="mission" if isinstance(row, Mission) else "uav_type", subject_id=row.pk, before=before, after=stated,
            )  # fmt: skip
    row.alert_limits = stated
