"""Deletes telemetry older than the configured retention, in batches, so that nothing waits for a long deletion."""

import time
from datetime import timedelta
from pathlib import Path

from django.conf import settings
from django.db import connection
from django.utils import timezone

from telemetry.models import FlightLog, VehicleText

ROWS_AT_ONCE = 5_000
MAX_DURATION_S = 20.0

_FORGET_RECORDS = """
DELETE FROM telemetry_telemetryrecord WHERE id = ANY(ARRAY(
    SELECT id FROM telemetry_telemetryrecord WHERE received_at < %s LIMIT %s FOR UPDATE SKIP LOCKED
))
"""
_FORGET_ESTIMATES = """
DELETE FROM telemetry_positionestimate WHERE id = ANY(ARRAY(
    SELECT id FROM telemetry_positionestimate WHERE estimated_for < %s ORDER BY id LIMIT %s FOR UPDATE SKIP LOCKED
))
"""
_FORGET_CAPTURES = """
WITH old AS MATERIALIZED (
    SELECT id FROM telemetry_capture WHERE received_at < %s ORDER BY id LIMIT %s FOR UPDATE SKIP LOCKED
), reports AS (DELETE FROM telemetry_capturereport WHERE capture_id IN (SELECT id FROM old))
DELETE FROM telemetry_capture WHERE id IN (SELECT id FROM old)
"""
_FORGET_STREAMS = """
DELETE FROM telemetry_telemetrystream stream WHERE started_at < %s
    AND NOT EXISTS (SELECT 1 FROM telemetry_telemetryrecord record WHERE record.stream_id = stream.id)
    AND NOT EXISTS (SELECT 1 FROM telemetry_capturereport report WHERE report.stream_id = stream.id)
    AND NOT EXISTS (SELECT 1 FROM telemetry_inspectionresult result WHERE result.stream_id = stream.id)
"""


def forget_old_telemetry() -> int:
    """Delete records, photos, estimates, texts and flight logs older than TELEMETRY_DAYS; 0 keeps all. Returns the deleted records.

    Inspection results are kept. Stops after a time limit; the next call continues.
    """
    if settings.TELEMETRY_DAYS <= 0:
        return 0
    before = timezone.now() - timedelta(days=settings.TELEMETRY_DAYS)
    forgotten, until_s = 0, time.monotonic() + MAX_DURATION_S
    with connection.cursor() as cursor:
        while time.monotonic() < until_s:
            cursor.execute(_FORGET_CAPTURES, [before, ROWS_AT_ONCE])
            if cursor.rowcount < ROWS_AT_ONCE:
                break
        while time.monotonic() < until_s:
            cursor.execute(_FORGET_RECORDS, [before, ROWS_AT_ONCE])
            forgotten += cursor.rowcount
            if cursor.rowcount < ROWS_AT_ONCE:
                cursor.execute(_FORGET_STREAMS, [before])
                break
        while time.monotonic() < until_s:
            cursor.execute(_FORGET_ESTIMATES, [before, ROWS_AT_ONCE])
            if cursor.rowcount < ROWS_AT_ONCE:
                break
    VehicleText.objects.filter(received_at__lt=before).delete()
    for log in FlightLog.objects.filter(ended_at__lt=before):
        (Path(settings.FLIGHT_LOG_DIR) / log.path).unlink(missing_ok=True)
        log.delete()
    return forgotten
