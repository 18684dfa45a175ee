"""Which alerts are a reason to plan the rest of a mission again."""

import pytest

from missions.models import ReplanOffer
from telemetry.alerting.finding import ADVISORY, CRITICAL, WARNING, Finding
from telemetry.services.replan_hooks import code_of, suggest_for_findings
from tests.missions.flights import ground
from tests.missions.replanning.in_flight import two_in_the_air
from tests.workspace.people import somebody


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
def test_a_finding_is_a_reason_when_its_uav_will_not_finish(code, level, details, reason):
    assert code_of(Finding(code, level, "%(uav)s …", {"uav": "Tern"}, details=details)) == reason


@pytest.mark.django_db
def test_a_lost_link_makes_one_offer(settings, tmp_path):
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    ground(tmp_path / "hill.tif", 100.0)
    flight = two_in_the_air(somebody())
    for seconds in (31, 32):
        finding = Finding("link-lost", CRITICAL, "%(uav)s", {"uav": "Tern", "seconds": seconds}, details={})
        suggest_for_findings([(flight.mission.pk, flight.uavs[0].pk, finding)])
    offer = ReplanOffer.objects.get()
    assert (offer.code, offer.cause["uav"], offer.cause["alert"]) == ("uav-out", flight.uavs[0].pk, "link-lost")
