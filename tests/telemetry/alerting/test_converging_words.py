"""What is said of two UAVs that come near each other: distances as they are, and which of them to hold."""

import math
from dataclasses import replace

import numpy as np
import pytest

from telemetry.alerting.conflicts import Flying, Why, conflicts, ways_of, yielding
from telemetry.alerting.detection import CRITICAL, WARNING, acts_of
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.detectors.converging import CODE, DETECTOR
from telemetry.estimation.knowledge import Knowledge
from telemetry.estimation.report import Report
from telemetry.estimation.tracker import Tracker
from tests.telemetry.alerting.faults import LIMITS
from tests.telemetry.alerting.test_conflicts import at, flown_with_another, reported, ways
from tests.telemetry.alerting.truth import MISSION, START_S
from tests.telemetry.alerting.watch import Watch

LEVEL_M = 30.0


def detection_of(first, second):
    moving = [*ways(1, first, None), *ways(2, second, None)]
    met = tuple(conflicts(moving, LIMITS.converging_s)[1])
    uav = WatchedUav(1, 1, "Tern", MISSION, MISSION, newest=Report(START_S, START_S, first))
    (found,) = DETECTOR.detect(Watch().inputs(START_S, uav, conflicts=met))
    return found


@pytest.mark.parametrize("apart_m", [3.0, 7.0, 12.0])
def test_the_distance_of_now_is_reported_and_its_uncertainty_beside_it(apart_m):
    """Bounds of 4 m each: the distance at the worst of both would be 0 m."""
    found = detection_of(reported(at(0.0, 0.0), LEVEL_M), reported(at(apart_m, 0.0), LEVEL_M + 2.0))
    assert (found.values["metres"], found.values["height"], found.values["bound"]) == (apart_m, 2, 6)
    assert found.details["distance_m"] == pytest.approx(apart_m, abs=0.2)


def test_one_that_comes_up_from_behind_is_to_be_held():
    found = detection_of(reported(at(0.0, 0.0), LEVEL_M, north_mps=9.0), reported(at(0.0, 60.0), LEVEL_M, north_mps=3.0))
    assert (found.values["hold"], found.values["why"], found.values["speed"]) == ("UAV 1", Why.BEHIND, 6)
    assert acts_of(CODE, 1, found.details) == [{"kind": "hold", "uav": 1}]


def flying(east=0.0, north=0.0, height=30.0, east_mps=0.0, north_mps=0.0, climb=0.0) -> Flying:
    return Flying(east, north, height, east_mps, north_mps, climb)


@pytest.mark.parametrize(
    ("first", "second", "is_first", "why"),
    [
        (flying(north_mps=8.0), flying(east=50.0, north=50.0, east_mps=-8.0), True, Why.ON_ITS_RIGHT),
        (flying(north_mps=8.0), flying(east=-50.0, north=50.0, east_mps=8.0), False, Why.ON_ITS_RIGHT),
        (flying(north_mps=8.0), flying(north=50.0), True, Why.OTHER_STANDS),
        (flying(), flying(north=50.0, north_mps=-8.0), False, Why.OTHER_STANDS),
        (flying(north_mps=8.0, height=40.0), flying(north=90.0, north_mps=-8.0), True, Why.HIGHER),
        (flying(north_mps=8.0), flying(north=90.0, north_mps=-8.0), False, Why.EITHER),
        (flying(climb=2.0, height=5.0), flying(north=40.0, north_mps=-8.0), True, Why.CLIMBS),
        (flying(height=math.nan), flying(north=5.0), False, Why.EITHER),
    ],
)
def test_the_rules_of_the_air_name_which_to_hold(first, second, is_first, why):
    assert yielding(first, second) == (is_first, why)


def early_by_s(seed: int) -> float:
    watches, meets = flown_with_another(seed, passes_m=float(np.random.default_rng(seed).uniform(-6, 6)))
    reported_s = watches[0].reached(CODE, (WARNING, CRITICAL))
    return -math.inf if reported_s is None else START_S + meets - reported_s


def test_crossing_pairs_are_alerted_at_least_12_s_before():
    assert [seed for seed in range(500, 505) if early_by_s(seed) < 12.0] == []


@pytest.mark.long
def test_100_crossing_pairs_are_alerted_at_least_12_s_before():
    assert [seed for seed in range(600, 700) if early_by_s(seed) < 12.0] == []


def test_the_reported_distance_is_the_true_one_within_2_m():
    """Of the estimator's estimates: both report once a second, at different moments, and what they report is some tenths old."""
    random = np.random.default_rng(5)
    compared = 0
    for pair in range(12):
        trackers, moves = [Tracker(Knowledge()) for _ in range(2)], [_crossing(random) for _ in range(2)]
        phases_s = random.uniform(0.0, 0.9, 2)
        for second in range(-20, 10):
            seen = []
            for number, (tracker, move, phase_s) in enumerate(zip(trackers, moves, phases_s, strict=True)):
                moment = second - phase_s
                measured = reported(at(*move(moment)), LEVEL_M)
                velocity = (np.array(move(moment + 0.5)) - np.array(move(moment - 0.5))).tolist()
                measured = replace(measured, velocity_east_mps=velocity[0], velocity_north_mps=velocity[1])
                report = Report(START_S + moment, START_S + moment + 0.05, measured)
                tracker.take(report)
                uav = WatchedUav(number, 1, f"UAV {number}", MISSION, MISSION, newest=report, estimate=tracker.estimate(START_S + second))
                seen.append(Watch().inputs(START_S + second, uav))
            if second < 0:
                continue
            moving = [way for inputs in seen for way in ways_of(inputs, LIMITS.converging_s)]
            true_m = math.dist(moves[0](second), moves[1](second))
            for conflict in conflicts(moving, LIMITS.converging_s).get(0, ()):
                assert conflict.now_lateral_m == pytest.approx(true_m, abs=2.0), f"pair {pair}, second {second}"
                compared += 1
    assert compared > 30


def _crossing(random: np.random.Generator):
    """A straight flight through a point near the origin about second 8."""
    speed, course = float(random.uniform(4, 11)), float(random.uniform(0, 2 * math.pi))
    east, north = speed * math.sin(course), speed * math.cos(course)
    aside = random.uniform(-8, 8, 2)
    return lambda second: (float(aside[0] + east * (second - 8)), float(aside[1] + north * (second - 8)))


def test_an_alert_of_before_there_was_one_hold_is_answered_by_hold() -> None:
    assert acts_of(CODE, 1, {"acts": [{"kind": "pause", "uav": 1}]}) == [{"kind": "hold", "uav": 1}]
