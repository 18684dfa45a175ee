"""Flown tracks of missions and UAVs, downloaded."""

import json
from datetime import timedelta
from io import BytesIO
from typing import Any

import pytest
from django.http import StreamingHttpResponse
from django.test import Client

from missions.models import Mission, Uav
from telemetry.models import TelemetryRecord
from telemetry.services import store_records
from tests.accounts.users import a_user, client_of
from tests.missions.commands.outbox import a_uav
from tests.telemetry.records import record
from workspace.models import Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.VIEWER))


@pytest.fixture
def mission() -> Mission:
    mission = Mission.objects.create(name="Bexley / spring: <1>")
    for name in ("Kite", "Tern"):
        uav = a_uav(name)
        store_records([record(uav, number, altitude_amsl_m=120.0) for number in range(5)])
    store_records([record(uav, 99)])
    TelemetryRecord.objects.filter(sequence__lt=99).update(mission=mission)
    return mission


def body_of(answer: Any) -> bytes:
    assert answer.status_code == 200
    assert isinstance(answer, StreamingHttpResponse)
    return BytesIO(b"".join(answer.streaming_content)).getvalue()  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("kind", "media_type"),
    [
        ("csv", "text/csv; charset=utf-8"), ("gpx", "application/gpx+xml"), ("kml", "application/vnd.google-earth.kml+xml"),
        ("geojson", "application/geo+json"),
    ],
)  # fmt: skip
def test_a_mission_is_downloaded_in_each_form(client: Client, mission: Mission, kind: str, media_type: str) -> None:
    answer = client.get(f"/api/v1/missions/{mission.pk}/telemetry.{kind}", headers={"Accept": "text/html"})
    assert answer["Content-Type"] == media_type
    assert answer["Content-Disposition"] == f'attachment; filename="Bexley-spring-1-telemetry.{kind}"'
    written = body_of(answer).decode()
    assert written.count("12:00:03.000Z") >= 2
    assert "12:01:39.000Z" not in written


def test_a_uavs_log_is_downloaded_for_a_span_of_time(client: Client, mission: Mission) -> None:
    tern = Uav.objects.get(name="Tern")
    query = "from=2026-11-22T12:00:03Z&to=2026-11-22T13:00:00Z"
    read = json.loads(body_of(client.get(f"/api/v1/uavs/{tern.pk}/telemetry.geojson?{query}")))
    assert [feature["properties"]["sequence"] for feature in read["features"]] == [3, 4, 99]


def test_a_file_has_one_record_a_second_unless_more_are_asked_for(client: Client, mission: Mission) -> None:
    tern = Uav.objects.get(name="Tern")
    first = TelemetryRecord.objects.filter(uav=tern).order_by("measured_at")[0]
    for number, row in enumerate(TelemetryRecord.objects.filter(uav=tern, sequence__lt=5).order_by("sequence")):
        row.measured_at, row.altitude_amsl_m = first.measured_at + timedelta(milliseconds=200 * number), 120.000000024
        row.save()
    address = f"/api/v1/uavs/{tern.pk}/telemetry.csv"
    assert [len(body_of(client.get(address + query)).splitlines()) - 1 for query in ("", "?every_s=0", "?every_s=0.2")] == [3, 6, 6]
    assert b"120.0," in body_of(client.get(address))
    for wrong in ("-1", "nan", "inf", "x", "3601"):
        assert client.get(f"{address}?every_s={wrong}").status_code == 400


def test_what_is_not_there_is_not_found(client: Client, mission: Mission) -> None:
    mission.deleted_at = mission.updated_at
    mission.save()
    assert client.get(f"/api/v1/missions/{mission.pk}/telemetry.csv").status_code == 404
    assert client.get("/api/v1/uavs/0/telemetry.csv").status_code == 404
    assert client.get(f"/api/v1/missions/{mission.pk}/telemetry.exe").status_code == 404
    assert client.get(f"/api/v1/uavs/{Uav.objects.get(name='Tern').pk}/telemetry.csv?from=x").status_code == 400


def test_a_stranger_downloads_nothing(mission: Mission) -> None:
    assert Client().get(f"/api/v1/missions/{mission.pk}/telemetry.csv").status_code == 401


@pytest.mark.parametrize("kind", ["csv", "gpx", "kml", "geojson"])
def test_nothing_is_exported_empty(client: Client, mission: Mission, kind: str) -> None:
    TelemetryRecord.objects.filter(mission=mission).update(mission=None)
    answer = client.get(f"/api/v1/missions/{mission.pk}/telemetry.{kind}")
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "nothing_recorded")
    silent = a_uav("Rook")
    assert client.get(f"/api/v1/uavs/{silent.pk}/telemetry.{kind}").status_code == 409
    assert client.get(f"/api/v1/missions/{mission.pk}/results.{kind if kind != 'gpx' else 'xlsx'}").status_code == 409
    assert client.get(f"/api/v1/missions/{mission.pk}/record.zip").status_code == 409


@pytest.mark.parametrize("kind", ["gpx", "kml"])
def test_a_log_without_places_has_no_track(client: Client, mission: Mission, kind: str) -> None:
    TelemetryRecord.objects.filter(mission=mission).exclude(sequence=0).update(position=None)
    TelemetryRecord.objects.filter(mission=mission, sequence=0).update(is_from_future=True)
    answer = client.get(f"/api/v1/missions/{mission.pk}/telemetry.{kind}")
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "nothing_recorded")
    assert client.get(f"/api/v1/missions/{mission.pk}/telemetry.csv").status_code == 200
