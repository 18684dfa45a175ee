"""Photos of a mission over the API and in its files, and those of a logged flight."""

import csv
import io
import json
import struct
import zipfile
from pathlib import Path

import pytest
from django.core.management import call_command
from django.test import Client
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.decoding.flight_log import frames_of_tlog
from missions.models import Mission, Uav
from telemetry.models import Capture, CaptureReport, FlightLog, TelemetryRecord
from telemetry.services import store_records
from telemetry.services.captures import store_captures
from tests.accounts.users import a_user, client_of
from tests.mavlink.decoding.photos import BOOTED_S, LON_E7, NOW_S, attitude, captured, feedback, gimbal, position
from tests.missions.commands.outbox import a_uav
from tests.telemetry.records import at, record
from tests.telemetry.test_captures import new, photo
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def uav() -> Uav:
    return a_uav("Tern")


@pytest.fixture
def mission(uav) -> Mission:
    """With five photos, of which one failed, and one photo that belongs to nothing."""
    mission = Mission.objects.create(name="Bexley / spring", organisation=uav.organisation)
    store_captures([message for number in range(4) for message in photo(uav, number, mission_id=mission.pk)])
    store_captures([new(uav, captured(9, result=0, lat_e7=0, lon_e7=0), 60.0, mission_id=mission.pk), new(uav, captured(10), 80.0)])
    return mission


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.VIEWER))


def test_photos_are_features_in_pages_by_time(client, mission, uav):
    first = client.get(f"/api/v1/missions/{mission.pk}/captures?limit=3").json()
    rest = client.get(first["next"]).json()
    features = [*first["features"], *rest["features"]]
    assert (len(first["features"]), len(features), rest["next"]) == (3, 5, None)
    assert [feature["properties"]["image_index"] for feature in features] == [0, 1, 2, 3, 9]
    second = features[1]
    assert second["geometry"] == {"type": "Point", "coordinates": [pytest.approx((LON_E7 + 1_000) / 1e7), 55.0]}
    told = second["properties"]
    assert (told["uav"], told["uav_name"], told["mission"]) == (uav.pk, "Tern", str(mission.pk))
    assert (told["altitude_amsl_m"], told["altitude_relative_m"], told["altitude_agl_m"]) == (130.0, 30.0, None)
    assert (told["yaw_frame"], told["attitude_source"], told["position_source"]) == ("earth", "camera", "photo")
    assert told["taken_at"].startswith("2026-11-22T12:00:02.5")
    failed = features[4]
    assert (failed["geometry"], failed["properties"]["is_taken"], failed["properties"]["altitude_amsl_m"]) == (None, False, None)


def test_photos_of_another_organisation_are_not_there(mission):
    stranger = client_of(a_user(Role.ADMINISTRATOR, Organisation.objects.create(name="Elsewhere")))
    for address in ("captures", "captures.csv", "captures.geojson"):
        assert stranger.get(f"/api/v1/missions/{mission.pk}/{address}").status_code == 404
        assert Client().get(f"/api/v1/missions/{mission.pk}/{address}").status_code == 401


def test_photos_are_files(client, mission):
    answer = client.get(f"/api/v1/missions/{mission.pk}/captures.csv")
    assert answer["Content-Disposition"] == 'attachment; filename="Bexley-spring-photos.csv"'
    rows = list(csv.DictReader(io.StringIO(b"".join(answer.streaming_content).decode())))
    assert [row["image_index"] for row in rows] == ["0", "1", "2", "3", "9"]
    assert (rows[0]["longitude_deg"], rows[0]["is_taken"], rows[4]["longitude_deg"], rows[4]["is_taken"]) == ("10.0", "true", "", "false")
    answer = client.get(f"/api/v1/missions/{mission.pk}/captures.geojson")
    assert len(json.loads(b"".join(answer.streaming_content))["features"]) == 5
    empty = Mission.objects.create(name="Empty", organisation=mission.organisation)
    assert client.get(f"/api/v1/missions/{empty.pk}/captures.csv").json()["error"]["code"] == "no_photos"


def test_photos_are_in_the_file_of_all_data(client, mission, uav):
    store_records([record(uav, 1)])
    TelemetryRecord.objects.update(mission=mission)
    answer = client.get(f"/api/v1/missions/{mission.pk}/record.zip")
    packed_file = zipfile.ZipFile(io.BytesIO(b"".join(answer.streaming_content)))
    assert len(packed_file.read("photos.csv").splitlines()) == 6
    assert len(json.loads(packed_file.read("photos.geojson"))["features"]) == 5


def test_photos_of_a_logged_flight_are_read_once(uav, tmp_path, settings):
    settings.FLIGHT_LOG_DIR = tmp_path
    mission = Mission.objects.create(name="Bexley", organisation=uav.organisation)
    write_log(tmp_path / "flight.tlog")
    FlightLog.objects.create(organisation=uav.organisation, uav=uav, mission=mission, path="flight.tlog", started_at=at(0))
    FlightLog.objects.create(organisation=uav.organisation, uav=uav, path="gone.tlog", started_at=at(1))
    told, wrong = io.StringIO(), io.StringIO()
    call_command("read_captures", stdout=told, stderr=wrong)
    assert "flight.tlog: 2 photos stored" in told.getvalue() and "gone.tlog" in wrong.getvalue()
    rows = list(Capture.objects.order_by("taken_at"))
    assert [(row.image_index, row.mission) for row in rows] == [(0, mission), (1, mission)]
    assert [row.taken_at.timestamp() for row in rows] == pytest.approx([NOW_S, NOW_S + 4.0], abs=0.2)
    assert all(row.attitude_source == "camera" for row in rows)
    assert CaptureReport.objects.count() == 4
    call_command("read_captures", "--uav", str(uav.pk), stdout=told, stderr=wrong)
    assert Capture.objects.count() == 2 and CaptureReport.objects.count() == 4


def test_a_log_that_was_cut_is_read_up_to_there(tmp_path):
    whole = write_log(tmp_path / "flight.tlog")
    for cut in (len(whole) - 5, len(whole) // 2, 3):
        frames = list(frames_of_tlog(io.BytesIO(whole[:cut])))
        assert (
            b"".join(struct.pack(">Q", round(at_s * 1e6)) + raw for at_s, raw in frames) == whole[: sum(8 + len(raw) for _, raw in frames)]
        )
    assert list(frames_of_tlog(io.BytesIO(b"no tlog at all, but a text"))) == []


def write_log(path: Path) -> bytes:
    """The log of a flight with two photos, each told by the autopilot and the camera, among the frames of a station."""
    heartbeat = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 0, 0, 0, 3)
    station = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
    frames = [(NOW_S - 6.0, bytes(heartbeat.pack(mavlink.MAVLink(None, srcSystem=1, srcComponent=1))))]
    for step in range(-50, 50):
        at_s = NOW_S + step / 10.0
        boot_ms = round((at_s - BOOTED_S) * 1e3)
        frames.append((at_s, bytes(heartbeat.pack(station))))
        for message in (position(), attitude(60.0), gimbal(-30.0, 0.0, 44)):
            message.time_boot_ms = boot_ms
            frames.append((at_s, packed(message)))
        if step in (0, 40):
            number, lon_e7 = step // 40, LON_E7 + 100 * step
            frames.append((at_s + 0.02, packed(feedback(number + 1, time_us=at_s * 1e6, lon_e7=lon_e7))))
            frames.append((at_s + 0.03, packed(captured(number, boot_s=boot_ms / 1e3, lon_e7=lon_e7))))
    path.write_bytes(b"".join(struct.pack(">Q", round(at_s * 1e6)) + raw for at_s, raw in frames))
    return path.read_bytes()


def packed(message) -> bytes:
    return bytes(message.pack(mavlink.MAVLink(None, srcSystem=1, srcComponent=message.get_srcComponent())))
