"""What is said of a UAV that has lost its GPS, and what is proposed."""

import pytest

from mavlink.decoding.measurement import Measurement
from telemetry.alerting.detection import CRITICAL, WARNING, acts_of
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.detectors import gps
from telemetry.alerting.surroundings import LinkFacts
from telemetry.estimation.report import Report
from tests.telemetry.alerting.truth import MISSION, START_S
from tests.telemetry.alerting.watch import Watch


def found(autopilot: str = "", **reported):
    measured = Measurement(longitude_deg=10.0, latitude_deg=56.0, is_in_air=True, **reported)
    uav = WatchedUav(7, 1, "Tern", MISSION, MISSION, newest=Report(START_S, START_S, measured))
    (detection,) = gps.detect(Watch().inputs(START_S, uav, link=LinkFacts(autopilot=autopilot)))
    return detection


@pytest.mark.parametrize(("autopilot", "own"), [("ardupilot", gps.OWN_ARDUPILOT), ("px4", gps.OWN_PX4), ("other", gps.OWN_UNKNOWN)])
def test_without_a_fix_no_hold_is_proposed_and_what_the_autopilot_does_is_told(autopilot, own):
    detection = found(autopilot, gps_fix=1)
    assert (detection.level, detection.values["own"]) == (CRITICAL, own)
    assert acts_of(gps.CODE, 7, detection.details) == [{"kind": "land", "uav": 7}, {"kind": "take-over", "uav": 7}]


def test_with_a_weak_fix_a_hold_is_proposed():
    detection = found(gps_fix=3, satellites=4)
    assert (detection.level, acts_of(gps.CODE, 7, detection.details)) == (WARNING, [{"kind": "hold", "uav": 7}])
