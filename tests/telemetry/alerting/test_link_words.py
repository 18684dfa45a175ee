"""What is said of a UAV that is silent: what it does by itself, as it was last heard and as was planned."""

from dataclasses import replace

import pytest

from mavlink.decoding.measurement import Measurement
from planning.clearance.lost_link import LostLink, LostLinkPlan
from telemetry.alerting.advice import ADVICE
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.detectors import link
from telemetry.alerting.surroundings import FlightModel, LinkFacts
from telemetry.estimation.report import Report
from tests.telemetry.alerting.truth import MISSION, START_S, true_flight
from tests.telemetry.alerting.watch import Watch


@pytest.fixture(scope="module")
def model() -> FlightModel:
    return true_flight(3, least_leg_m=700.0).model


def status_texts(model: FlightModel | None, mode: str, planned: LostLinkPlan | None = None, autopilot: str = "") -> str:
    uav = WatchedUav(7, 1, "Tern", MISSION, MISSION, newest=Report(START_S, START_S, Measurement(mode=mode, is_in_air=True)))
    model = model and replace(model, lost_link=planned)
    (detection,) = link.detect(Watch().inputs(START_S + 40.0, uav, model=model, link=LinkFacts(autopilot=autopilot)))
    advice = detection.details[ADVICE]
    return advice["message"] % advice["values"]


@pytest.mark.parametrize(
    ("planned", "words"),
    [
        (LostLinkPlan(LostLink.GO_ON), "Planned for link loss: it continues its mission by itself."),
        (LostLinkPlan(LostLink.HOLD, hold_s=60.0), "Planned for link loss: it holds for 60 s, then returns."),
        (LostLinkPlan(LostLink.RETURN), "Planned for link loss: it returns."),
    ],
)
def test_a_silent_uav_in_its_mission_does_what_was_planned_unless_its_failsafe_does_otherwise(planned, words, model):
    assert status_texts(model, "AUTO", planned) == f"{words} A failsafe set on the UAV comes first."
    assert "FS_GCS_ENABLE" in status_texts(model, "AUTO", planned, "ardupilot")
    assert "NAV_DLL_ACT" in status_texts(model, "AUTO", planned, "px4")


@pytest.mark.parametrize(("mode", "begin"), [("RTL", "It was returning"), ("LAND", "It was landing"), ("LOITER", "It was holding")])
def test_a_silent_uav_that_did_not_fly_its_mission_goes_on_as_it_was_last_heard(mode, begin, model):
    assert status_texts(model, mode, LostLinkPlan(LostLink.GO_ON)).startswith(begin)


def test_what_is_not_known_of_a_silent_uav_is_said_so(model):
    assert status_texts(model, "AUTO") == status_texts(None, "AUTO") == "What it does by itself is not known."
    assert status_texts(model, "STABILIZE") == "It was under other control when last heard (mode STABILIZE): ask the pilot."
