"""The newest of each UAV, kept beside the log: each group of values with its own age."""

import threading
from datetime import timedelta
from itertools import permutations
from typing import Any

import pytest
from django.db import connection, transaction
from django.utils import timezone

from missions.models import Uav
from telemetry.live.uavs import measured_json
from telemetry.models import UavWatch
from telemetry.services import store_records
from tests.missions.commands.outbox import a_uav
from tests.telemetry.records import at, record
from workspace.live import changes
from workspace.models import Organisation

NOWHERE = {"longitude_deg": None, "latitude_deg": None}


def shown(uav: Uav) -> dict[str, Any]:
    found = measured_json(UavWatch.objects.get(uav=uav).measured)
    assert found is not None
    return found


def seconds(shown_at: str) -> float:
    return (timezone.datetime.fromisoformat(shown_at) - at(0)).total_seconds()


@pytest.mark.django_db
def test_the_newest_report_is_shown_whole() -> None:
    uav = a_uav()
    store_records(
        [record(uav, 1, battery_percent=70.0, velocity_north_mps=3.0, velocity_east_mps=4.0, velocity_down_mps=-1.0, wind_north_mps=-2.0,
                wind_east_mps=0.0, mode="AUTO", is_armed=True, gps_fix=3, hdop=0.8, altitude_relative_m=40.0, waypoint_sequence=4,
                roll_deg=-7.5, pitch_deg=3.25)]
    )  # fmt: skip
    reported = shown(uav)
    assert (reported["position"], reported["speed_mps"], reported["climb_mps"], reported["battery_percent"]) == (
        [10.0, 55.0],
        5.0,
        1.0,
        70.0,
    )
    assert (reported["wind_speed_mps"], reported["wind_from_deg"]) == (2.0, 0.0)  # the air moves south: it comes from the north
    assert (reported["mode"], reported["is_armed"], reported["gps_fix"], reported["hdop"], reported["waypoint_sequence"]) == (
        "AUTO",
        True,
        3,
        0.8,
        4,
    )
    assert (reported["altitude_relative_m"], reported["altitude_agl_m"], reported["satellites"]) == (40.0, None, None)
    assert (reported["roll_deg"], reported["pitch_deg"]) == (-7.5, 3.25)
    assert seconds(reported["measured_at"]) == seconds(reported["received_at"]) == 1
    assert reported["measured_at_of"]["link"] is None


@pytest.mark.django_db
def test_a_report_without_a_position_leaves_the_last_one_there_with_its_age() -> None:
    uav = a_uav()
    store_records([record(uav, 1, battery_percent=70.0)])
    store_records([record(uav, 9, battery_percent=60.0, **NOWHERE)])
    reported = shown(uav)
    assert (reported["position"], reported["battery_percent"]) == ([10.0, 55.0], 60.0)
    assert [seconds(reported["measured_at_of"][group]) for group in ("position", "battery")] == [1, 9]
    assert seconds(reported["measured_at"]) == 9


@pytest.mark.django_db
@pytest.mark.parametrize("order", list(permutations([1, 2, 3])))
@pytest.mark.parametrize("is_one_batch", [True, False])
def test_in_whatever_order_reports_come_the_newest_of_each_group_is_shown(order: tuple[int, ...], is_one_batch: bool) -> None:
    uav = a_uav()
    reports = {
        1: record(uav, 1, battery_percent=90.0, mode="AUTO"),
        2: record(uav, 2, longitude_deg=20.0, battery_percent=80.0),
        3: record(uav, 3, **NOWHERE, hdop=1.0),
    }
    came = [reports[number] for number in order]
    for batch in [came] if is_one_batch else [[report] for report in came]:
        store_records(batch)
    reported = shown(uav)
    assert (reported["position"][0], reported["battery_percent"], reported["mode"], reported["hdop"]) == (20.0, 80.0, "AUTO", 1.0)
    assert [seconds(reported["measured_at_of"][group]) for group in ("position", "battery", "state", "gps")] == [2, 2, 1, 3]
    assert seconds(reported["measured_at"]) == 3


@pytest.mark.django_db
def test_what_is_from_the_future_was_stored_before_or_comes_again_is_not_shown() -> None:
    uav = a_uav()
    store_records([record(uav, 1)])
    version = UavWatch.objects.get(uav=uav).version
    store_records([record(uav, 2, measured_s=1_000.0, received_s=2.0, longitude_deg=99.0)])
    store_records([record(uav, 1, measured_s=5.0, longitude_deg=98.0)])  # the number of one that is stored
    store_records([record(uav, 1)])
    assert shown(uav)["position"] == [10.0, 55.0]
    assert UavWatch.objects.get(uav=uav).version == version


@pytest.mark.django_db
def test_each_change_is_another_version_and_belongs_to_the_uavs_organisation() -> None:
    elsewhere = Organisation.objects.create(name="Elsewhere")
    uav = a_uav(organisation=elsewhere)
    versions = []
    for second in (1, 2, 3):
        store_records([record(uav, second)])
        versions.append(UavWatch.objects.get(uav=uav, organisation=elsewhere).version)
    assert versions == sorted(set(versions))


@pytest.mark.django_db
def test_what_the_watch_has_put_there_stays() -> None:
    uav = a_uav()
    UavWatch.objects.create(uav=uav, holder="watch/1", lease_expires_at=timezone.now() + timedelta(minutes=1), estimated={"at": "now"})
    store_records([record(uav, 1)])
    row = UavWatch.objects.get(uav=uav)
    assert (row.holder, row.estimated, row.version) == ("watch/1", {"at": "now"}, 2)
    assert row.lease_expires_at is not None


@pytest.mark.django_db
def test_pages_are_told_after_the_commit_of_each_organisation_once(
    monkeypatch: pytest.MonkeyPatch, django_capture_on_commit_callbacks: Any
) -> None:
    reported: list[int] = []
    monkeypatch.setattr("telemetry.services.ingest.publish_live", reported.append)
    elsewhere = Organisation.objects.create(name="Elsewhere")
    uavs = [a_uav("A"), a_uav("B"), a_uav("C", organisation=elsewhere)]
    with django_capture_on_commit_callbacks(execute=True):
        store_records([record(uav, 1) for uav in uavs])
        assert reported == []
    assert sorted(reported) == sorted({uavs[0].organisation_id, elsewhere.pk})


@pytest.mark.django_db(transaction=True)
def test_reports_and_estimates_of_the_same_uavs_lock_nobody_out() -> None:
    """Both hold rows in the order of the UAVs: none of them is ended as a deadlock."""
    uavs = [a_uav(f"UAV {number}") for number in range(20)]
    failed: list[BaseException] = []

    def often(write: Any) -> None:
        try:
            for turn in range(25):
                write(turn)
        except BaseException as error:
            failed.append(error)
        finally:
            connection.close()

    def report(turn: int) -> None:
        order = uavs if turn % 2 else uavs[::-1]
        store_records([record(uav, turn) for uav in order])

    def estimate(turn: int) -> None:
        with transaction.atomic(), connection.cursor() as cursor:
            cursor.execute("SELECT uav_id FROM telemetry_uavwatch ORDER BY uav_id FOR UPDATE")
            cursor.execute("UPDATE telemetry_uavwatch SET estimated = '{}', version = version + 1")

    report(0)  # an UPDATE takes rows that came after its SELECT … FOR UPDATE in the order in which they lie
    threads = [threading.Thread(target=often, args=[write]) for write in (report, report, estimate, estimate)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == []


def test_nobody_waits_long_for_a_redis_that_is_away(settings: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(changes, "_live_quiet_until_s", 0.0)
    settings.REDIS_URL = "redis://127.0.0.1:1/0"
    tried: list[str] = []
    away = changes._redis
    monkeypatch.setattr(changes, "_redis", lambda address: tried.append(address) or away(address))
    for _ in range(50):
        changes.publish_live(1)
    assert len(tried) == 1  # and then not again for a while
