"""A link that lags looks like a slow clock. Of a real UAV that is never believed: it is in the air at the same time as all others."""

from datetime import UTC, datetime, timedelta

import pytest

from mavlink.decoding.boots import VehicleTime
from mavlink.decoding.measurement import Measurement
from missions.models import Mission, MissionState, Uav
from telemetry.models import Alert, UavLink
from telemetry.selectors.alert_facts import links_of
from telemetry.selectors.watched import watched_flights
from telemetry.services import NewRecord, store_records
from telemetry.watch.options import EstimatorOptions
from telemetry.watch.process import Watch
from tests.accounts.users import a_user
from tests.missions.flights import carry, dispatched, fleet, ground
from tests.missions.worlds import UAV_AT, world

pytestmark = pytest.mark.django_db

NOW = datetime(2026, 11, 22, 12, tzinfo=UTC)
LAGS_BY = 0.2  # seconds a second, while its link is congested
SPEED_MPS, APART_M, DEGREE_M = 10.0, 300.0, 62_200.0  # a degree of longitude there


def learnt_rate() -> float:
    """Of messages each quarter of a second, that wait longer and longer."""
    vehicle = VehicleTime()
    for number in range(240):
        boot_s = number / 4
        vehicle.receive(int(boot_s * 1_000), NOW.timestamp() + boot_s + LAGS_BY * max(boot_s - 40.0, 0.0))
        if boot_s > 58.0:
            break
    assert vehicle.clock is not None
    return vehicle.clock.rate


def flying(*, is_simulated: bool) -> list[Uav]:
    uavs = fleet("Tern", "Gull", is_simulated=is_simulated)
    here = world()
    mission = dispatched(a_user(), uavs, [here.towers[0], here.towers[3]])
    carry(*uavs)
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.ACTIVE)
    for uav, rate in zip(uavs, (1.0, learnt_rate()), strict=True):
        UavLink.objects.update_or_create(
            uav=uav, defaults={"clock_rate": rate, "last_message_at": NOW, "is_in_air": True, "autopilot": "px4"}
        )
    return uavs


def alerts_of(uavs: list[Uav]) -> set[str]:
    """They fly at each other at one height."""
    watch = Watch(EstimatorOptions(name="one", most_uavs=100, run="1"))
    for second in range(12):
        at = NOW + timedelta(seconds=second)
        for uav, side in zip(uavs, (-1.0, 1.0), strict=True):
            reported = Measurement(
                longitude_deg=UAV_AT.lon + side * (APART_M / 2 - SPEED_MPS * second) / DEGREE_M, latitude_deg=UAV_AT.lat + 0.01,
                altitude_relative_m=60.0, altitude_amsl_m=160.0, is_in_air=True, is_armed=True, mode="hold",
                velocity_north_mps=0.0, velocity_east_mps=-side * SPEED_MPS, velocity_down_mps=0.0,
            )  # fmt: skip
            store_records([NewRecord(uav.pk, "mavlink", "boot", second * 1_000, at, at, reported)])
        UavLink.objects.update(last_message_at=at)
        watch.round(at.timestamp() + 0.1)
    return set(Alert.objects.filter(uav__in=uavs).values_list("code", flat=True))


@pytest.fixture(autouse=True)
def terrain(tmp_path):
    ground(tmp_path / "ground.tif")


def test_a_link_that_lags_is_learnt_as_a_slow_clock() -> None:
    assert learnt_rate() < 0.9


@pytest.mark.long
def test_two_real_uavs_that_meet_are_told_while_one_link_lags() -> None:
    assert "converging" in alerts_of(flying(is_simulated=False))


def test_a_rate_is_believed_of_simulated_uavs_alone() -> None:
    uavs = flying(is_simulated=False)
    keys = [uav.pk for uav in uavs]
    assert [links_of(keys)[key][0].clock_rate for key in keys] == [1.0, 1.0]
    assert {flight.clock_rate for flight in watched_flights()} == {None}
    Uav.objects.update(is_simulated=True)
    assert [links_of(keys)[key][0].clock_rate for key in keys] == [1.0, pytest.approx(learnt_rate())]
    assert sorted(flight.clock_rate or 0.0 for flight in watched_flights()) == pytest.approx([learnt_rate(), 1.0])
