"""What the watch sees becomes alerts: rows that open, rise and close."""

from datetime import timedelta

import pytest

from missions.models import Approval, Mission, Uav
from telemetry.alerting.watched import Report, WatchedUav
from telemetry.decoding.measurement import Measurement
from telemetry.models import Alert, UavLink
from telemetry.services.alerting import Memories, look
from tests.missions.flights import an_operator, approved, fleet
from tests.missions.worlds import world
from tests.telemetry.records import at

pytestmark = pytest.mark.django_db


@pytest.fixture
def uav() -> Uav:
    return fleet("Tern")[0]


@pytest.fixture
def approval(uav) -> Approval:
    approval = approved(an_operator(), [uav], world().towers[:2])[1]
    Mission.objects.filter(pk=approval.mission_id).update(state="active")
    return approval


def seen(uav: Uav, approval: Approval, reported_s: float = 0.0, **values) -> WatchedUav:
    measurement = Measurement(**{"longitude_deg": 10.0, "latitude_deg": 55.0, "is_armed": True, "is_in_air": True, **values})
    report = Report(at(reported_s).timestamp(), at(reported_s).timestamp(), measurement)
    return WatchedUav(uav.pk, uav.organisation_id, uav.name, approval.mission_id, approval.pk, None, newest=report)


def heard(uav: Uav, seconds: float) -> None:
    UavLink.objects.update_or_create(uav=uav, defaults={"heard_at": at(seconds)})


def test_a_uav_that_is_silent_is_late_then_lost_by_one_alert_and_heard_again_it_is_over(uav, approval):
    heard(uav, 0)
    memories = Memories()
    levels = []
    for second in range(30):
        look(watched=[seen(uav, approval)], now=at(second), memories=memories)
        levels.append(Alert.objects.filter(closed_at=None).values_list("level", flat=True).first())
    assert [levels.index("warning"), levels.index("critical")] == [5, 20]
    heard(uav, 30)
    for second in range(30, 35):
        look(watched=[seen(uav, approval, 30)], now=at(second), memories=memories)
    alert = Alert.objects.get()
    assert (alert.code, alert.opened_at, alert.closed_at, alert.close_reason) == ("link-lost", at(5), at(32), "cleared")


def test_a_watch_that_takes_over_opens_nothing_twice_and_closes_what_is_over(uav, approval):
    heard(uav, 0)
    look(watched=[seen(uav, approval)], now=at(25), memories=Memories())
    look(watched=[seen(uav, approval)], now=at(26), memories=Memories())
    alert = Alert.objects.get()
    assert (alert.closed_at, alert.revision) == (None, 1)
    heard(uav, 27)
    memories = Memories()
    for second in range(27, 31):
        look(watched=[seen(uav, approval, 27)], now=at(second), memories=memories)
    assert Alert.objects.get().closed_at == at(29)


def test_a_raised_level_is_not_acknowledged_any_more(uav, approval):
    heard(uav, 0)
    memories = Memories()
    look(watched=[seen(uav, approval)], now=at(10), memories=memories)
    Alert.objects.update(acknowledged_at=at(11))
    look(watched=[seen(uav, approval)], now=at(15), memories=memories)
    assert Alert.objects.get().acknowledged_at == at(11)
    look(watched=[seen(uav, approval)], now=at(20), memories=memories)
    alert = Alert.objects.get()
    assert (alert.level, alert.acknowledged_at) == ("critical", None)


def test_what_is_on_the_ground_is_not_late(uav, approval):
    look(watched=[seen(uav, approval, is_armed=False, is_in_air=False)], now=at(60), memories=Memories())
    assert not Alert.objects.exists()


@pytest.mark.parametrize("state", ["completed", "aborted", "failed"])
def test_a_mission_that_has_ended_ends_its_alerts(state, uav, approval):
    look(watched=[seen(uav, approval)], now=at(60), memories=Memories())
    Mission.objects.update(state=state)
    look(watched=[], now=at(60) + timedelta(seconds=1), memories=Memories())
    assert Alert.objects.get().close_reason == "mission-ended"
