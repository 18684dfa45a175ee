"""Writes alert rows in bulk and counts each change."""

import json
from collections.abc import Collection, Mapping, Sequence
from datetime import datetime, timedelta
from typing import Any

from django.db import connection, transaction
from django.db.models import Exists, F, OuterRef
from django.db.models.functions import Now

from missions.models import MissionState
from telemetry.alerting.advice import answer_of, figures_of
from telemetry.alerting.detection import RANK, Detection
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.detectors import down
from telemetry.alerting.state_machine import Closed, Opened
from telemetry.models import Alert
from telemetry.selectors.alerts import WORST, OpenRow
from telemetry.services.alerts.alerts import CLOSED, OPENED, step

WORDS_STAND_FOR = timedelta(seconds=5)  # minimum interval between updates with newer values of the same cause
WATCHED_STATES = (MissionState.DISPATCHED, MissionState.ACTIVE)
MISSION_ENDED = "mission-ended"

_RENEW = """
UPDATE telemetry_alert alert
SET level = reported.level, message = reported.message, "values" = reported.vals::jsonb, details = reported.details::jsonb, written_at = %s,
    revision = alert.revision + 1,
    course = CASE WHEN reported.is_raised THEN alert.course || jsonb_build_object('at', %s::text, 'what', 'rose', 'level', reported.level)
        ELSE alert.course END,
    acknowledged_at = CASE WHEN reported.is_raised THEN NULL ELSE alert.acknowledged_at END,
    acknowledged_by_id = CASE WHEN reported.is_raised THEN NULL ELSE alert.acknowledged_by_id END
FROM unnest(%s::bigint[], %s::text[], %s::text[], %s::text[], %s::text[], %s::bool[])
    AS reported(id, level, message, vals, details, is_raised)
WHERE alert.id = reported.id AND alert.closed_at IS NULL
"""

_CLOSE = """
UPDATE telemetry_alert SET closed_at = %s, close_reason = %s, revision = revision + 1, course = course || %s::jsonb
WHERE id = ANY(%s) AND closed_at IS NULL
"""


def settle(found: Sequence[tuple[WatchedUav, Opened | Closed]], *, open_rows: Mapping[int, Sequence[OpenRow]], now: datetime) -> set[int]:
    """Write the changes. Returns the organisations whose alerts changed."""
    rows = {(row.uav_id, row.code, row.subject): row for of_uav in open_rows.values() for row in of_uav}
    new, renewed, closed = [], [], []
    organisations = set()
    for uav, change in found:
        if isinstance(change, Closed):
            row = rows.get((uav.uav_id, change.code, change.subject))
            if row is not None:
                closed.append((row.id, change.reason))
                organisations.add(uav.organisation_id)
            continue
        detection = change.detection
        row = rows.get((uav.uav_id, detection.code, detection.subject))
        if row is None:
            new.append(
                Alert(
                    organisation_id=uav.organisation_id, uav_id=uav.uav_id, mission_id=uav.mission_id, level=detection.level,
                    code=detection.code, subject=detection.subject, message=detection.message, values=detection.values,
                    details=_with_worst(detection, None, now), opened_at=now, written_at=now,
                    course=[step(OPENED, now, level=detection.level)],
                )
            )  # fmt: skip
            organisations.add(uav.organisation_id)
        elif (written := _words_to_write(row, change, now)) is not None:
            is_raised = RANK[detection.level] > RANK[row.level]
            details = json.dumps(_with_worst(detection, row.worst, now))
            message, values = written
            renewed.append((row.id, detection.level, message, json.dumps(values), details, is_raised))
            organisations.add(uav.organisation_id)
    if not organisations:
        return organisations
    with transaction.atomic():
        Alert.objects.bulk_create(new, ignore_conflicts=True)
        if renewed:
            with connection.cursor() as cursor:
                cursor.execute(_RENEW, [now, now.isoformat(), *(list(column) for column in zip(*sorted(renewed), strict=True))])
        for reason in {reason for _, reason in closed}:
            _close([row_id for row_id, of_row in closed if of_row == reason], reason, now)
    return organisations


def close_alerts_of_ended_missions(*, codes: Collection[str], but: Collection[int], now: datetime) -> set[int]:
    """Close them unless an estimator still monitors their UAVs; this process monitors those of `but`. Returns the organisations."""
    is_away = Exists(Alert.objects.filter(uav=OuterRef("uav"), code=down.CODE, closed_at=None))  # such a UAV's alerts stay open
    over = Alert.objects.filter(~is_away, closed_at=None, code__in=codes, mission__isnull=False)
    over = over.exclude(mission__state__in=WATCHED_STATES)
    over = over.exclude(uav__in=but).exclude(uav__watch__mission=F("mission"), uav__watch__lease_expires_at__gt=Now())
    found = dict(over.values_list("pk", "organisation_id"))
    if found:
        _close(list(found), MISSION_ENDED, now)
    return set(found.values())


def _close(ids: Sequence[int], reason: str, now: datetime) -> None:
    with connection.cursor() as cursor:
        cursor.execute(_CLOSE, [now, reason, json.dumps([step(CLOSED, now, reason=reason)]), list(ids)])


def is_worse(detection: Detection, worst: Mapping[str, Any] | None) -> bool:
    """Return whether the detection is worse than the worst one stored with its alert."""
    return worst is None or (RANK[detection.level], detection.severity) > (RANK[worst["level"]], worst["severity"])


def _with_worst(detection: Detection, worst: Mapping[str, Any] | None, now: datetime) -> dict[str, Any]:
    """Return the details of an alert with its worst message so far; without one for causes whose values cannot be compared."""
    if detection.severity == 0.0:
        return detection.details
    if is_worse(detection, worst):
        worst = {
            "level": detection.level, "severity": detection.severity, "message": detection.message, "values": detection.values,
            "at": now.isoformat(),
        }  # fmt: skip
    return detection.details | {WORST: worst}


def _words_to_write(row: OpenRow, change: Opened, now: datetime) -> tuple[str, Mapping[str, Any]] | None:
    """Return message and values to write to an open alert, with the detection's details; None: nothing to write.

    An alert that keeps a worse level keeps that level's message. Its acts are always the present ones.
    """
    detection = change.detection
    is_answered_otherwise = answer_of(detection.details) != row.answer
    is_due = now - row.written_at >= WORDS_STAND_FOR
    has_other_figures = figures_of(detection.details) != row.figures
    if change.is_held and detection.message != row.message:
        return (row.message, row.values) if is_answered_otherwise or (has_other_figures and is_due) else None
    is_other = is_answered_otherwise or detection.level != row.level or detection.message != row.message
    has_changed = detection.values != row.values or has_other_figures
    is_worst = detection.severity != 0.0 and is_worse(detection, row.worst)
    return (detection.message, detection.values) if is_other or (has_changed and (is_worst or is_due)) else None
