"""Which alerts are a reason to plan the rest of a mission again."""

import pytest

from missions.models import Mission, OfferState, ReplanOffer
from missions.services.replanning import REPLAN, settle_offers
from telemetry.alerting.detection import ADVISORY, CRITICAL, WARNING, Detection
from telemetry.alerting.state_machine import CLEARED, LANDED, Closed
from telemetry.models import AlertLevel
from telemetry.services.alerts.alerts import open_alert
from telemetry.services.alerts.replan_hooks import code_of, suggest_for_detections, withdraw_for_closed
from tests.accounts.users import a_user
from tests.missions.flights import ground
from tests.missions.replanning.in_flight import Flight, two_in_the_air, worked_out
from workspace.jobs.services import create_job


@pytest.mark.parametrize(
    ("code", "level", "details", "reason"),
    [
        ("battery-short", CRITICAL, {}, "battery-short"),
        ("battery-short", WARNING, {}, None),
        ("battery-short", WARNING, {"route_short": True}, "battery-short"),
        ("link-lost", CRITICAL, {}, "uav-out"),
        ("link-lost", WARNING, {}, None),
        ("down-off-plan", CRITICAL, {}, "uav-out"),
        ("mode-changed", CRITICAL, {"mode": "RTL"}, "uav-out"),
        ("mode-changed", WARNING, {"mode": "LOITER"}, None),
        ("weather", ADVISORY, {}, None),
    ],
)
def test_a_detection_is_a_reason_when_its_uav_will_not_finish(code, level, details, reason):
    assert code_of(Detection(code, level, "%(uav)s …", {"uav": "Tern"}, details=details)) == reason


@pytest.fixture
def flight(settings, tmp_path) -> Flight:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    ground(tmp_path / "hill.tif", 100.0)
    return two_in_the_air(a_user())


def lose_the_link(flight: Flight, seconds: int = 31) -> None:
    detection = Detection("link-lost", CRITICAL, "%(uav)s", {"uav": "Tern", "seconds": seconds}, details={})
    suggest_for_detections([(flight.mission.pk, flight.uavs[0].pk, detection)])


def receive_again(flight: Flight, reason: str = CLEARED) -> None:
    withdraw_for_closed([(flight.mission.pk, flight.uavs[0].pk, Closed("link-lost", "", reason))])


@pytest.mark.django_db
def test_a_lost_link_makes_one_offer(flight):
    for seconds in (31, 32):
        lose_the_link(flight, seconds)
    offer = ReplanOffer.objects.get()
    assert (offer.code, offer.cause["uav"], offer.cause["alert"]) == ("uav-out", flight.uavs[0].pk, "link-lost")


@pytest.mark.django_db
def test_an_offer_is_withdrawn_when_its_uav_is_heard_again_and_its_plan_is_put_away(flight):
    lose_the_link(flight)
    offer = worked_out(ReplanOffer.objects.get(), create_job(organisation=flight.mission.organisation, created_by=None, task=REPLAN,
        parameters={"offer": str(ReplanOffer.objects.get().pk)}, message=""))  # fmt: skip
    assert offer.state == OfferState.OPEN, offer.outcome
    receive_again(flight)
    offer.refresh_from_db()
    assert (offer.state, offer.outcome) == (OfferState.OUTDATED, "Its reason has ended: Tern continues its mission.")
    assert Mission.objects.get(pk=offer.continuation_id).deleted_at is not None
    assert (settle_offers(), ReplanOffer.objects.count()) == (0, 1), "it is not worked out again"
    lose_the_link(flight, 40)
    assert ReplanOffer.objects.count() == 2, "the same cause may come back"


@pytest.mark.django_db
def test_an_offer_that_is_being_worked_out_is_withdrawn_too(flight):
    lose_the_link(flight)
    receive_again(flight)
    assert ReplanOffer.objects.get().state == OfferState.OUTDATED


@pytest.mark.django_db
@pytest.mark.parametrize("why", ["landed", "another UAV", "another reason"])
def test_an_offer_stays_while_its_reason_lasts(why, flight):
    lose_the_link(flight)
    if why == "landed":
        receive_again(flight, LANDED)
    elif why == "another UAV":
        withdraw_for_closed([(flight.mission.pk, flight.uavs[1].pk, Closed("link-lost", "", CLEARED))])
    else:
        open_alert(
            uav=flight.uavs[0], level=AlertLevel.CRITICAL, code="mode-changed", message="%(uav)s", values={"uav": "Tern"},
            mission=flight.mission, details={"mode": "RTL"},
        )  # fmt: skip
        receive_again(flight)
    assert ReplanOffer.objects.get().state == OfferState.COMPUTING
