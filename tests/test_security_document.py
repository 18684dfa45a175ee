"""docs/security.md answers every requirement of ASVS 5.0 of levels 1 and 2 once, and names tests and files that exist."""

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

PROJECT_DIR = Path(__file__).resolve().parents[1]
TEXT = (PROJECT_DIR / "docs" / "security.md").read_text()
LINE = re.compile(r"^\| (\d+\.\d+\.\d+)(?: to (\d+\.\d+\.\d+))? \| [^|]+ \| (met|in part|not met|n/a) \| ([^|]+) \|$", re.MULTILINE)
VERDICTS = ("met", "in part", "not met", "n/a")

# By section, the numbers of the requirements of levels 1 and 2 (those of level 3 are left out).
WANTED = {
    "1.1": range(1, 3), "1.2": range(1, 10), "1.3": range(1, 12), "1.4": range(1, 4), "1.5": range(1, 3),
    "2.1": range(1, 4), "2.2": range(1, 4), "2.3": range(1, 5), "2.4": range(1, 2),
    "3.2": range(1, 3), "3.3": range(1, 5), "3.4": range(1, 7), "3.5": range(1, 6), "3.7": range(1, 3),
    "4.1": range(1, 4), "4.2": range(1, 2), "4.3": range(1, 3), "4.4": range(1, 5),
    "5.1": range(1, 2), "5.2": range(1, 4), "5.3": range(1, 3), "5.4": range(1, 4),
    "6.1": range(1, 4), "6.2": range(1, 13), "6.3": range(1, 5), "6.4": range(1, 5), "6.5": range(1, 6), "6.6": range(1, 4),
    "6.8": range(1, 5),
    "7.1": range(1, 4), "7.2": range(1, 5), "7.3": range(1, 3), "7.4": range(1, 6), "7.5": range(1, 3), "7.6": range(1, 3),
    "8.1": range(1, 3), "8.2": range(1, 4), "8.3": range(1, 2), "8.4": range(1, 2),
    "9.1": range(1, 4), "9.2": range(1, 5),
    "10.1": range(1, 3), "10.2": range(1, 3), "10.3": range(1, 5), "10.4": range(1, 12), "10.5": range(1, 6), "10.6": range(1, 3),
    "10.7": range(1, 4),
    "11.1": range(1, 3), "11.2": range(1, 4), "11.3": range(1, 4), "11.4": range(1, 5), "11.5": range(1, 2), "11.6": range(1, 2),
    "12.1": range(1, 4), "12.2": range(1, 3), "12.3": range(1, 5),
    "13.1": range(1, 2), "13.2": range(1, 6), "13.3": range(1, 3), "13.4": range(1, 6),
    "14.1": range(1, 3), "14.2": range(1, 5), "14.3": range(1, 4),
    "15.1": range(1, 4), "15.2": range(1, 4), "15.3": range(1, 8),
    "16.1": range(1, 2), "16.2": range(1, 6), "16.3": range(1, 5), "16.4": range(1, 4), "16.5": range(1, 4),
    "17.1": range(1, 2), "17.2": range(1, 5), "17.3": range(1, 3),
}  # fmt: skip


REQUIREMENTS = [f"{section}.{number}" for section, numbers in WANTED.items() for number in numbers]


def answers() -> Iterator[tuple[str, str, str]]:
    """Yield requirement, verdict and evidence; a line `10.1.1 to 10.1.2` answers all requirements from the first to the last."""
    for first, last, verdict, evidence in LINE.findall(TEXT):
        for requirement in REQUIREMENTS[REQUIREMENTS.index(first) : REQUIREMENTS.index(last or first) + 1]:
            yield requirement, verdict, evidence


def test_every_requirement_is_answered_once() -> None:
    assert [requirement for requirement, _, _ in answers()] == REQUIREMENTS
    assert len(REQUIREMENTS) == 253


def test_only_requirements_that_do_not_apply_share_a_line() -> None:
    assert [(first, last) for first, last, verdict, _ in LINE.findall(TEXT) if last and verdict != "n/a"] == []


def test_what_is_not_met_says_why() -> None:
    assert [number for number, verdict, evidence in answers() if verdict in ("not met", "in part") and len(evidence) < 20] == []


def test_the_counts_are_those_of_the_lines() -> None:
    counts = Counter((requirement.partition(".")[0], verdict) for requirement, verdict, _ in answers())
    for chapter, stated in re.findall(r"^\| V(\d+) [^|]+ \| ([^\n]+) \|$", TEXT, flags=re.MULTILINE):
        assert [int(number) for number in stated.split(" | ")] == [counts[chapter, verdict] for verdict in VERDICTS], chapter
    stated = re.findall(r"^\| all 253 \| ([^\n]+) \|$", TEXT, flags=re.MULTILINE)[0]
    totals = Counter(verdict for _, verdict, _ in answers())
    assert [int(number) for number in stated.split(" | ")] == [totals[verdict] for verdict in VERDICTS]


def test_every_test_and_file_that_is_named_exists() -> None:
    named = set(re.findall(r"`((?:tests|scripts|deploy|workspace|config|templates|telemetry|missions|operation)/[\w/.-]+)`", TEXT))
    assert len(named) > 50
    assert [path for path in sorted(named) if not (PROJECT_DIR / path).exists()] == []
