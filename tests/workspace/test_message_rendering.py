"""What workers have stored, in the language of whoever reads it."""

import re
from pathlib import Path

import pytest
from django.utils.translation import override

from workspace.message_rendering import render_message

ROOT = Path(__file__).resolve().parents[2]


def test_a_message_of_a_worker_is_read_in_german() -> None:
    with override("de"):
        assert render_message("Looking for a first plan") == "Ein erster Plan wird gesucht"


def test_what_was_put_in_is_put_in_again() -> None:
    with override("de"):
        assert render_message("12.5 MiB from Overpass") == "12.5 MiB von Overpass"


@pytest.mark.parametrize(
    ("stated", "german"),
    [
        ("Battery low: 14 %: return", "Akku schwach: 14 %: Rückkehr"),
        ("Battery 24 %", "Akku 24 %"),
        ("It hit the ground at 7.3 m/s.", "Es ist mit 7.3 m/s auf den Boden geschlagen."),
        ("GPS lost: land", "GPS verloren: Landung"),
    ],
)
def test_what_a_simulated_uav_says_of_trouble_is_read_in_german(stated: str, german: str) -> None:
    with override("de"):
        assert render_message(stated) == german


def test_what_nobody_has_foreseen_stays_as_it_was_written() -> None:
    with override("de"):
        assert render_message("Something else.") == "Something else."


@pytest.mark.parametrize(
    "path",
    [
        "missions/services/planning/planner.py",
        "planning/assignment/assignment.py",
        "planning/assignment/candidate_plan.py",
        "planning/planner.py",
        "planning/solver/solver.py",
        "inspection/importers/osm/reader.py",
        "inspection/services/imports/osm.py",
    ],
)
def test_every_step_of_a_job_has_a_word_in_german(path: str) -> None:
    steps = re.findall(r'[pP]rogress\((?:[\d.]+(?: \+ [\w./ ]+)?, )?"([^"]+)"|_notify\(progress, "([^"]+)"', (ROOT / path).read_text())
    assert steps
    with override("de"):
        assert [step for pair in steps for step in pair if step and render_message(step) == step] == []
