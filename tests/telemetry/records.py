"""Records for tests: one second after another, at one place unless told."""

from datetime import UTC, datetime, timedelta
from typing import Any

from django.utils import timezone

from mavlink.decoding.measurement import Measurement
from missions.models import LinkKind, Uav
from telemetry.models import UavLink
from telemetry.services import NewRecord
from telemetry.services.ingest import store_records

START = datetime(2026, 11, 22, 12, tzinfo=UTC)


def at(seconds: float) -> datetime:
    return START + timedelta(seconds=seconds)


def record(uav: Uav, sequence: int, *, measured_s: float | None = None, received_s: float | None = None, **values: Any) -> NewRecord:
    """Measured at its sequence number's second unless told, received then too."""
    measured_s = float(sequence) if measured_s is None else measured_s
    stream = values.pop("stream", "boot")
    measurement = Measurement(**{"longitude_deg": 10.0, "latitude_deg": 55.0, **values})
    received_s = measured_s if received_s is None else received_s
    return NewRecord(uav.pk, LinkKind.MAVLINK, stream, sequence, at(measured_s), at(received_s), measurement)


def received(*uavs: Uav, **measured: Any) -> None:
    """Each of these stands at its take-off place and is connected: a link, and a report of now."""
    for uav in uavs:
        UavLink.objects.update_or_create(uav=uav, defaults={"last_message_at": timezone.now(), "is_in_air": False})
        start = uav.mission_uavs.get().start
        values = {"longitude_deg": start.x, "latitude_deg": start.y, "gps_fix": 3, "battery_percent": 98.0} | measured
        store_records([record(uav, 1, measured_s=(timezone.now() - START).total_seconds(), **values)])
