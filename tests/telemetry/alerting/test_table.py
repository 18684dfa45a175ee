"""The table of docs/alerts.md is the one that the detectors keep."""

import re
from dataclasses import asdict
from pathlib import Path

import pytest

from telemetry.alerting.detectors import CODES, DETECTORS
from telemetry.alerting.detectors.link import lost_after_s
from telemetry.alerting.limits import BOUNDS, AlertLimits, InvalidLimits, checked_limits, limits_of

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "alerts.md").read_text()


@pytest.mark.parametrize("detector", DETECTORS, ids=CODES)
def test_the_page_states_the_delay_of_each_detector(detector):
    row = next(line for line in PAGE.splitlines() if line.startswith(f"| `{detector.code}` |"))
    assert f"| {detector.delay_s(AlertLimits(), 1):g} s / {detector.delay_s(AlertLimits(), 10):g} s" in row


def test_the_page_states_when_a_link_counts_as_lost():
    assert f"lost: {lost_after_s(AlertLimits(), 1) + 1:g} s / {lost_after_s(AlertLimits(), 10) + 1:g} s" in PAGE


def test_the_page_states_all_limits():
    stated = re.findall(r"^\| `(\w+)` \| ([\d.]+) \| \(([\d.]+) to ([\d.]+)\) \|$", PAGE, re.MULTILINE)
    assert {name: (float(usual), float(low), float(high)) for name, usual, low, high in stated} == {
        name: (usual, *BOUNDS[name]) for name, usual in asdict(AlertLimits()).items()
    }


def test_a_mission_goes_before_a_type_and_the_usual_before_nothing():
    limits = limits_of({"off_route_m": 40, "link_late_s": 9.0}, {"off_route_m": 30.0}, None)
    assert (limits.off_route_m, limits.link_late_s, limits.link_lost_s) == (30.0, 9.0, 20.0)


@pytest.mark.parametrize(
    ("stated", "place"),
    [([], "alert_limits"), ({"speed": 1}, "speed"), ({"off_route_m": "9"}, "off_route_m"), ({"off_route_m": float("nan")}, "off_route_m"),
     ({"most_hdop": True}, "most_hdop"), ({"link_lost_s": 4.0}, "link_lost_s")],
)  # fmt: skip
def test_what_makes_no_sense_is_refused_by_its_name(stated, place):
    with pytest.raises(InvalidLimits) as refused:
        checked_limits(stated)
    assert refused.value.place == place


def test_a_warning_begins_before_what_is_critical():
    with pytest.raises(InvalidLimits, match="off_route_critical_m"):
        limits_of({"off_route_m": 200.0})
