"""Telemetry is kept for as long as the settings say."""

from datetime import timedelta

import pytest
from django.contrib.gis.geos import Point
from django.utils import timezone

from missions.models import Uav
from telemetry.models import FlightLog, TelemetryRecord, TelemetryStream, VehicleText
from telemetry.services import forget_old_telemetry, retention, store_records
from telemetry.tasks import forget_old_telemetry as forget_task
from tests.telemetry.records import record

pytestmark = pytest.mark.django_db


@pytest.fixture
def uav(settings, tmp_path) -> Uav:
    settings.TELEMETRY_DAYS, settings.FLIGHT_LOG_DIR = 30, tmp_path
    return Uav.objects.create(name="One", location=Point(0, 0))


def test_what_is_older_goes_and_the_rest_stays(uav, tmp_path, monkeypatch):
    monkeypatch.setattr(retention, "ROWS_AT_ONCE", 3)
    now = timezone.now()
    store_records([record(uav, number, stream="old" if number < 10 else "new") for number in range(20)])
    TelemetryRecord.objects.update(received_at=now)
    TelemetryRecord.objects.filter(stream__key="old").update(received_at=now - timedelta(days=31))
    TelemetryStream.objects.filter(key="old").update(started_at=now - timedelta(days=31))
    for days in (29, 31):
        at = now - timedelta(days=days)
        VehicleText.objects.create(uav=uav, severity=4, text=str(days), received_at=at)
        (tmp_path / f"{days}.tlog").write_text("")
        FlightLog.objects.create(uav=uav, path=f"{days}.tlog", started_at=at, ended_at=at)
    assert forget_old_telemetry() == 10
    assert list(TelemetryRecord.objects.order_by("sequence").values_list("sequence", flat=True)) == list(range(10, 20))
    assert [stream.key for stream in TelemetryStream.objects.all()] == ["new"]
    assert [text.text for text in VehicleText.objects.all()] == ["29"]
    assert [log.path for log in FlightLog.objects.all()] == ["29.tlog"]
    assert [path.name for path in tmp_path.iterdir()] == ["29.tlog"]


def test_it_may_be_kept_for_ever(uav, settings):
    settings.TELEMETRY_DAYS = 0
    store_records([record(uav, 1)])
    TelemetryRecord.objects.update(received_at="2000-01-01T00:00:00Z")
    forget_task()
    assert TelemetryRecord.objects.count() == 1
