"""The log, read by place, time, mission and UAV; the newest of a UAV; what its autopilot said; its logs as files."""

from collections.abc import Callable
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from django.db import connection
from django.test import Client
from django.utils import timezone

from missions.models import Mission, Uav
from telemetry.models import FlightLog, TelemetryRecord, VehicleText
from telemetry.selectors.log import LogFilter, latest_record, records_that_match
from telemetry.services import store_records
from tests.accounts.users import a_user, client_of
from tests.missions.commands.outbox import a_uav
from tests.telemetry.records import START, at, record
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db

DAY = "from=2026-11-22T00:00:00Z"


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.VIEWER))


@pytest.fixture
def kite() -> Uav:
    return a_uav("Kite")


def flown(uav: Uav, seconds: int, **values: Any) -> None:
    """Eastwards, a report a second."""
    store_records([record(uav, number, longitude_deg=10.0 + number * 1e-4, **values) for number in range(seconds)])


def listed(client: Client, query: str) -> dict[str, Any]:
    answer = client.get(f"/api/v1/telemetry?{query}")
    assert answer.status_code == 200, answer.content
    return answer.json()


def sequences(client: Client, query: str) -> list[int]:
    return [feature["properties"]["sequence"] for feature in listed(client, query)["features"]]


def all_pages(client: Client, query: str) -> list[int]:
    found, address = [], f"/api/v1/telemetry?{query}"
    while address:
        page = client.get(address).json()
        found += [feature["id"] for feature in page["features"]]
        address = page["next"]
    return found


def test_a_record_is_a_feature_with_three_times_and_heights_that_name_their_reference(client: Client, kite: Uav) -> None:
    store_records([record(kite, 3, received_s=5, altitude_amsl_m=120.0, altitude_relative_m=20.0, battery_percent=71.5, mode="Mission")])
    (feature,) = listed(client, DAY)["features"]
    assert feature["geometry"] == {"type": "Point", "coordinates": [10.0, 55.0]}
    facts = feature["properties"]
    assert (facts["measured_at"], facts["received_at"]) == ("2026-11-22T12:00:03.000Z", "2026-11-22T12:00:05.000Z")
    assert facts["stored_at"] > "2026"
    assert (facts["altitude_amsl_m"], facts["altitude_relative_m"], facts["altitude_agl_m"]) == (120.0, 20.0, None)
    assert (facts["uav"], facts["uav_name"], facts["mode"], facts["battery_percent"]) == (kite.pk, "Kite", "Mission", 71.5)


def test_the_log_is_read_by_time_place_uav_and_mission(client: Client, kite: Uav) -> None:
    tern, mission = a_uav("Tern"), Mission.objects.create(name="Bexley")
    flown(kite, 10)
    store_records([record(tern, 77)])
    TelemetryRecord.objects.filter(uav=kite, sequence__in=[4, 5]).update(mission=mission)
    assert sequences(client, f"uav={tern.pk}") == [77]
    assert sequences(client, f"mission={mission.pk}") == [4, 5]
    assert sequences(client, "from=2026-11-22T12:00:03Z&to=2026-11-22T12:00:06Z") == [3, 4, 5]
    assert sequences(client, f"{DAY}&bbox=10.00065,54,11,56") == [7, 8, 9]
    assert sequences(client, "from=2026-11-22T13:00:00%2B01:00&to=2026-11-22T13:00:02%2B01:00") == [0, 1]


def test_without_a_beginning_it_is_the_last_day(client: Client, kite: Uav) -> None:
    now = timezone.now()
    two_days = (now - START).total_seconds() - 2 * 86_400
    recent = (now - START).total_seconds() - 60
    store_records([record(kite, 1, measured_s=two_days), record(kite, 2, measured_s=recent)])
    assert sequences(client, "") == [2]
    assert sequences(client, f"uav={kite.pk}") == [1, 2]


def test_pages_follow_each_other_without_a_gap(client: Client, kite: Uav) -> None:
    flown(kite, 25)
    found = all_pages(client, f"uav={kite.pk}&limit=10")
    assert len(found) == len(set(found)) == 25


def test_records_are_thinned_out_in_the_database(client: Client, kite: Uav) -> None:
    tern = a_uav("Tern")
    flown(kite, 60)
    store_records([record(tern, number) for number in range(60)])
    store_records([record(kite, 1_000, measured_s=86_400 * 365, received_s=61)])
    of_kite = listed(client, f"{DAY}&uav={kite.pk}&every_s=10")
    assert [feature["properties"]["sequence"] for feature in of_kite["features"]] == [0, 10, 20, 30, 40, 50]
    assert of_kite["every_s"] == 10
    assert len(sequences(client, f"{DAY}&every_s=10")) == 12
    assert listed(client, f"uav={kite.pk}&most=1000")["every_s"] is None


@pytest.mark.parametrize("most", [1, 2, 7, 20, 59, 119])
def test_no_more_than_were_asked_for_come_over_all_pages(client: Client, kite: Uav, most: int) -> None:
    for uav in (kite, a_uav("Tern")):
        flown(uav, 60)
    assert 0 < len(all_pages(client, f"{DAY}&most={most}&limit=7")) <= max(most, 4)


def test_the_next_page_keeps_the_spacing_though_records_come_in_between(client: Client, kite: Uav) -> None:
    flown(kite, 60)
    first = listed(client, f"uav={kite.pk}&most=20&limit=5")
    store_records([record(kite, number) for number in range(60, 600)])
    assert client.get(first["next"]).json()["every_s"] == first["every_s"]


@pytest.mark.parametrize(
    "query",
    ["from=yesterday", "to=2026-11-22T12:00:00", "uav=x", "mission=7", "bbox=1,2,3", "every_s=0", "every_s=nan", "most=0", "limit=0",
     "most=5&every_s=5", "cursor=abc", "most=-1", "from=9999-12-31T23:59:59-12:00"],
)  # fmt: skip
def test_what_no_log_can_be_asked_for_is_refused(client: Client, query: str) -> None:
    assert client.get(f"/api/v1/telemetry?{query}").status_code == 400


def test_the_newest_is_the_one_measured_last_and_never_from_the_future(client: Client, kite: Uav) -> None:
    """R11: a clock that runs 10 years ahead hides nothing."""
    address = f"/api/v1/uavs/{kite.pk}/telemetry/latest"
    assert client.get(address).status_code == 404
    flown(kite, 5)
    store_records([record(kite, 90, measured_s=10 * 365 * 86_400, received_s=6), record(kite, 91, measured_s=3_600, received_s=6)])
    store_records([record(kite, 2, stream="older", measured_s=-50, received_s=7)])
    assert client.get(address).json()["properties"]["sequence"] == 4
    store_records([record(kite, 5, measured_s=8)])
    assert client.get(address).json()["properties"]["sequence"] == 5
    flags = {row.sequence: (row.is_from_future, row.is_late) for row in TelemetryRecord.objects.exclude(stream__key="older")}
    assert (flags[90], flags[91], flags[5]) == ((True, False), (True, False), (False, False))
    assert TelemetryRecord.objects.get(stream__key="older").is_late
    kite.refresh_from_db()
    assert kite.located_at == at(8)


def test_a_clock_that_is_a_little_off_changes_nothing(client: Client, kite: Uav) -> None:
    store_records([record(kite, 1, measured_s=5, received_s=0), record(kite, 2, measured_s=6, received_s=1)])
    assert client.get(f"/api/v1/uavs/{kite.pk}/telemetry/latest").json()["properties"]["sequence"] == 2


def test_another_organisations_log_is_not_there(kite: Uav) -> None:
    stranger = client_of(a_user(Role.ADMINISTRATOR, Organisation.objects.create(name="Elsewhere")))
    flown(kite, 3)
    mission = Mission.objects.create(name="Bexley")
    TelemetryRecord.objects.update(mission=mission)
    assert sequences(stranger, DAY) == []
    assert sequences(stranger, f"uav={kite.pk}") == []
    assert sequences(stranger, f"mission={mission.pk}") == []
    addresses = [
        f"uavs/{kite.pk}/telemetry/latest", f"uavs/{kite.pk}/telemetry.csv", f"missions/{mission.pk}/telemetry.csv",
        f"uavs/{kite.pk}/flight-logs", f"uavs/{kite.pk}/vehicle-texts", f"uavs/{kite.pk}/flight-logs/1/file",
    ]  # fmt: skip
    assert {stranger.get(f"/api/v1/{address}").status_code for address in addresses} == {404}


def plan_of(records: Any) -> str:
    """How the database would find them among many: it reads few rows as a whole, whatever index there is."""
    with connection.cursor() as cursor:
        cursor.execute("SET LOCAL enable_seqscan = off")
    return str(records.explain())


@pytest.mark.parametrize(
    ("wanted", "index"),
    [
        (lambda uav, mission: LogFilter(uav_id=uav.pk, measured_from=at(0), measured_before=at(9)), "telemetry_of_uav_idx"),
        (lambda uav, mission: LogFilter(measured_from=at(0), measured_before=at(9)), "telemetry_of_uav_idx"),
        (lambda uav, mission: LogFilter(mission_id=mission.pk), "telemetry_of_mission_idx"),
    ],
)
def test_what_is_asked_for_is_found_by_an_index(kite: Uav, wanted: Callable[..., LogFilter], index: str) -> None:
    mission = Mission.objects.create(name="Bexley")
    for name in ("Tern", "Gull"):
        flown(a_uav(name), 200)
    flown(kite, 200)
    TelemetryRecord.objects.filter(uav=kite, sequence__lt=5).update(mission=mission)
    with connection.cursor() as cursor:
        cursor.execute("REINDEX TABLE telemetry_telemetryrecord")  # without the pages that rows of other tests have left
        cursor.execute("ANALYZE telemetry_telemetryrecord")
    assert index in plan_of(records_that_match(kite.organisation, wanted(kite, mission)).order_by("measured_at", "pk"))


def test_the_newest_is_found_by_an_index(kite: Uav) -> None:
    flown(kite, 50)
    newest = TelemetryRecord.objects.filter(uav=kite, is_from_future=False).order_by("-measured_at", "-pk")[:1]
    assert "telemetry_of_uav_idx" in plan_of(newest)
    found = latest_record(kite)
    assert found is not None
    assert found.sequence == 49


# --- what autopilots said, and files -----------------------------------------------------------------------------------------------


def test_what_an_autopilot_said_is_listed_the_newest_first(client: Client, kite: Uav) -> None:
    for number in range(3):
        VehicleText.objects.create(uav=kite, severity=4, text=f"text {number}", received_at=at(number))
    page = client.get(f"/api/v1/uavs/{kite.pk}/vehicle-texts?limit=2").json()
    assert [text["text"] for text in page["results"]] == ["text 2", "text 1"]
    assert [text["text"] for text in client.get(page["next"]).json()["results"]] == ["text 0"]


@pytest.fixture
def logs(settings: Any, tmp_path: Path) -> Path:
    settings.FLIGHT_LOG_DIR = tmp_path / "logs"
    settings.FLIGHT_LOG_DIR.mkdir()
    return Path(settings.FLIGHT_LOG_DIR)


def log_of(uav: Uav, path: str) -> FlightLog:
    return FlightLog.objects.create(uav=uav, path=path, started_at=at(0), ended_at=at(0) + timedelta(minutes=9), size_bytes=4)


def test_a_flights_log_is_listed_and_downloaded(client: Client, kite: Uav, logs: Path) -> None:
    (logs / "2026").mkdir()
    (logs / "2026" / "kite.tlog").write_bytes(b"\xfdlog")
    log_of(kite, "2026/kite.tlog")
    (row,) = client.get(f"/api/v1/uavs/{kite.pk}/flight-logs").json()["results"]
    assert row["size_bytes"] == 4
    answer = client.get(row["file"])
    assert b"".join(answer.streaming_content) == b"\xfdlog"
    assert answer["Content-Disposition"] == f'attachment; filename="20261122-120000-uav{kite.pk}.tlog"'


@pytest.mark.parametrize("path", ["../secret.tlog", "/etc/passwd", "gone.tlog", "", "link.tlog", "a/../../secret.tlog"])
def test_no_path_leaves_the_folder_of_logs(client: Client, kite: Uav, logs: Path, path: str) -> None:
    (logs.parent / "secret.tlog").write_text("secret")
    (logs / "link.tlog").symlink_to(logs.parent / "secret.tlog")
    assert client.get(f"/api/v1/uavs/{kite.pk}/flight-logs/{log_of(kite, path).pk}/file").status_code == 404


def test_a_log_belongs_to_its_uav(client: Client, kite: Uav, logs: Path) -> None:
    (logs / "kite.tlog").write_bytes(b"log")
    log, tern = log_of(kite, "kite.tlog"), a_uav("Tern")
    assert client.get(f"/api/v1/uavs/{tern.pk}/flight-logs/{log.pk}/file").status_code == 404
