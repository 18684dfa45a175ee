"""The watch estimates UAVs of missions on their way, and keeps what it estimated."""

from datetime import UTC, datetime, timedelta
from unittest.mock import MagicMock

import pytest
from django.db import OperationalError

from mavlink.decoding.measurement import Measurement
from missions.models import Mission, MissionState, Uav
from telemetry.estimation.tracker import Tracker
from telemetry.models import PositionEstimate, UavLink, UavWatch
from telemetry.services import NewRecord, store_records
from telemetry.watch import process
from telemetry.watch.options import EstimatorOptions
from telemetry.watch.process import Watch
from tests.accounts.users import a_user
from tests.missions.flights import carry, dispatched, fleet, ground
from tests.missions.worlds import UAV_AT, world

pytestmark = pytest.mark.django_db

NOW = datetime(2026, 11, 22, 12, tzinfo=UTC)


@pytest.fixture
def uav(tmp_path) -> Uav:
    ground(tmp_path / "ground.tif")
    here, [uav] = world(), fleet()
    mission = dispatched(a_user(), [uav], [here.towers[3]])
    carry(uav)
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.ACTIVE)
    return uav


def report(uav: Uav, second: float, **values) -> None:
    at = NOW + timedelta(seconds=second)
    reported = {"longitude_deg": UAV_AT.lon, "latitude_deg": UAV_AT.lat, "altitude_relative_m": 30.0, "is_in_air": True} | values
    store_records([NewRecord(uav.pk, "mavlink", "boot", int(second * 1_000), at, at, Measurement(**reported))])


def watch(name: str = "one", run: str = "1", **options) -> Watch:
    return Watch(EstimatorOptions(name=name, most_uavs=100, run=run, **options))


def seconds(**of) -> list[float]:
    return [(at - NOW).total_seconds() for at in PositionEstimate.objects.filter(**of).values_list("estimated_for", flat=True)]


def test_seconds_without_a_report_are_estimated_and_kept(uav):
    report(uav, 0.4)
    one = watch()
    for second in range(1, 6):
        one.round(NOW.timestamp() + second + 0.01)
    row = UavWatch.objects.get(uav=uav)
    assert row.holder == "one/1"
    assert row.mission is not None
    assert row.estimated["at"] == "2026-11-22T12:00:05.000Z"
    assert row.estimated["report_at"] == "2026-11-22T12:00:00.400Z"
    assert seconds() == [2.0, 3.0, 4.0, 5.0]
    estimate = PositionEstimate.objects.first()
    assert estimate.mission == row.mission
    assert abs(estimate.position.x - UAV_AT.lon) < 1e-3


@pytest.mark.parametrize(("clock_rate", "metres"), [(None, (4.0, 8.0)), (1.0, (4.0, 8.0)), (10.0, (25.0, 60.0))])
def test_a_uav_whose_clock_runs_faster_comes_farther_in_a_second(uav, clock_rate, metres):
    """It is flown by hand to the east at 10 m/s; 0.6 s later it is looked at."""
    UavLink.objects.update_or_create(uav=uav, defaults={"clock_rate": clock_rate})
    report(uav, 0.4, mode="POSCTL", velocity_east_mps=10.0, velocity_north_mps=0.0, heading_deg=90.0)
    watch().round(NOW.timestamp() + 1.01)
    (lon, _) = UavWatch.objects.get(uav=uav).estimated["position"]
    assert metres[0] < (lon - UAV_AT.lon) * 62_400.0 < metres[1], "a degree of longitude at 56 degrees north"


def test_a_report_that_comes_late_replaces_what_was_estimated_for_its_second(uav):
    report(uav, 0.4)
    one = watch()
    for second in range(1, 6):
        one.round(NOW.timestamp() + second + 0.01)
    report(uav, 2.7)
    one.round(NOW.timestamp() + 6.01)
    assert seconds(replaced_at__isnull=False) == [3.0]
    assert seconds(replaced_at=None) == [2.0, 4.0, 5.0, 6.0]


def test_a_mission_that_is_over_leaves_no_estimate(uav):
    report(uav, 0.4)
    one = watch()
    one.round(NOW.timestamp() + 1)
    Mission.objects.update(state=MissionState.COMPLETED)
    one.round(NOW.timestamp() + 2)
    row = UavWatch.objects.get(uav=uav)
    assert (row.holder, row.mission, row.estimated) == ("", None, None)
    assert one.held == {}


def test_one_watch_at_a_time_holds_a_uav(uav):
    report(uav, 0.4)
    one, other = watch(), watch("other")
    one.round(NOW.timestamp() + 1)
    other.round(NOW.timestamp() + 1)
    assert (list(one.held), list(other.held)) == ([uav.pk], [])
    UavWatch.objects.update(lease_expires_at=datetime.now(UTC) - timedelta(hours=1))
    other.round(NOW.timestamp() + 2)
    one.round(NOW.timestamp() + 2)
    assert (list(one.held), list(other.held)) == ([], [uav.pk])
    assert UavWatch.objects.get(uav=uav).estimated["at"] == "2026-11-22T12:00:02.000Z"


def test_a_watch_that_stops_gives_its_uavs_back(uav):
    report(uav, 0.4)
    one = watch()
    one.round(NOW.timestamp() + 1)
    one.stop()
    one.run()
    row = UavWatch.objects.get(uav=uav)
    assert row.holder == ""
    assert row.estimated is not None


def test_without_a_record_the_link_tells_how_it_does(uav):
    """An autopilot without GPS makes no record; its heartbeat still names the mode."""
    for second in range(10):
        report(uav, float(second), mode="MISSION", velocity_east_mps=10.0, velocity_north_mps=0.0, altitude_relative_m=60.0)
    facts = {"autopilot": "px4", "mode": "LOITER", "is_in_air": True, "last_message_at": NOW + timedelta(seconds=14)}
    UavLink.objects.update_or_create(uav=uav, defaults=facts)
    one = watch()
    one.round(NOW.timestamp() + 15.01)
    assert UavWatch.objects.get(uav=uav).estimated["report_at"] == "2026-11-22T12:00:14.000Z"
    assert one.held[uav.pk].tracker.estimate(NOW.timestamp() + 60.0).speed_mps < 1.0


def test_one_uav_that_cannot_be_estimated_does_not_blind_the_watch(uav, monkeypatch):
    def fails(*_):
        raise FloatingPointError

    report(uav, 0.4)
    one = watch()
    monkeypatch.setattr(Tracker, "estimate", fails)
    one.round(NOW.timestamp() + 1.01)
    assert list(one.held) == [uav.pk]
    monkeypatch.undo()
    one.round(NOW.timestamp() + 2.01)
    assert seconds() == [2.0]


def test_it_waits_for_a_database_that_is_away_and_goes_on(monkeypatch, caplog):
    one, rounds = watch(), []

    def round_of(now_s: float) -> None:
        rounds.append(now_s)
        if len(rounds) == 4:
            one.stop()
        if len(rounds) < 4:
            raise OperationalError("the server at secret.example is gone")

    for name in ("close_old_connections", "connection", "release_watches"):
        monkeypatch.setattr(process, name, MagicMock())
    monkeypatch.setattr(process, "_until_next", lambda _: 0.001)
    monkeypatch.setattr(one, "round", round_of)
    one.run()
    assert len(rounds) == 4
    assert [record.levelname for record in caplog.records].count("WARNING") == 1
    assert "secret" not in caplog.text
