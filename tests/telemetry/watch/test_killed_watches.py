"""A watch that is killed is followed by another one within seconds, which knows what it knew."""

import signal
from datetime import timedelta
from itertools import pairwise

import pytest
from django.utils import timezone

from mavlink.decoding.measurement import Measurement
from missions.models import Mission, MissionState, Uav
from telemetry.models import PositionEstimate, UavWatch
from telemetry.services import NewRecord, store_records
from tests.accounts.users import a_user
from tests.missions.flights import carry, dispatched, fleet, ground
from tests.missions.worlds import UAV_AT, world
from tests.telemetry.gateway.station import wait_for
from tests.telemetry.watch.program import watch_program

MAX_GAP_S = 8.0  # a lease, a round, and what a busy machine takes longer
pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]


@pytest.fixture
def uav(tmp_path) -> Uav:
    ground(tmp_path / "ground.tif")
    here, [uav] = world(), fleet()
    mission = dispatched(a_user(), [uav], [here.towers[3]])
    carry(uav)
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.ACTIVE)
    begun = timezone.now() - timedelta(seconds=20)
    reports = [
        NewRecord(uav.pk, "mavlink", "boot", second, at, at, Measurement(*UAV_AT, altitude_relative_m=2.5 * second, mode="AUTO"))
        for second in range(20)
        for at in [begun + timedelta(seconds=second)]
    ]
    store_records(reports)
    return uav


def estimated_by(uav: Uav, name: str) -> UavWatch | None:
    row = UavWatch.objects.filter(uav=uav).first()
    return row if row is not None and row.holder.startswith(f"{name}/") and row.estimated is not None else None


def begins(tmp_path, name: str) -> bool:
    return "watching as" in (tmp_path / f"{name}.log").read_text()


def test_another_watch_takes_over_from_one_that_is_killed_and_lets_go_when_told_to_stop(uav, tmp_path):
    with watch_program(tmp_path, name="one") as one:
        first = wait_for(lambda: estimated_by(uav, "one"), "the first to watch", patience_s=60.0)
        with watch_program(tmp_path, name="other") as other:
            wait_for(lambda: begins(tmp_path, "other"), "the other to begin", patience_s=60.0)
            one.send_signal(signal.SIGKILL)
            after = wait_for(lambda: estimated_by(uav, "other"), "the other to take over")
            other.terminate()
            assert other.wait(timeout=60) == 0
    assert after.estimated["report_at"] == first.estimated["report_at"]
    moments = list(PositionEstimate.objects.filter(uav=uav).order_by("estimated_for").values_list("estimated_for", flat=True))
    longest_gap_s = max((later - earlier).total_seconds() for earlier, later in pairwise(moments))
    assert longest_gap_s <= MAX_GAP_S
    row = UavWatch.objects.get(uav=uav)
    assert (row.holder, row.lease_expires_at) == ("", None)
