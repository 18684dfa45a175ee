"""The fault table names what there is, tells what came out, and keeps the lines of rows that were not run."""

import re
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path

import pytest

from scripts.places import PROJECT_DIR
from tests.chaos.document import BEGINS, DOCUMENT, ENDS, put_in_document
from tests.chaos.fault_table import ROWS
from tests.chaos.figures import Figure, TargetResult, write, written
from tests.chaos.rows import Elsewhere, Experiment, Row, Tests
from tests.chaos.running import Settings, figures_of

PARTS = [part for row in ROWS for part in row.parts]


def test_every_row_of_the_table_of_faults_is_there_once() -> None:
    asked = [
        *(f"R{number}" for number in range(1, 16)),
        *(f"S{number}" for number in range(1, 12)),
        "O1",
        "O2",
        "O3",
        "F1",
        "F2",
        "F3",
        "F4",
    ]
    assert [row.id for row in ROWS] == asked
    assert all(row.parts for row in ROWS)


@pytest.mark.parametrize("part", [part for part in PARTS if isinstance(part, Tests)], ids=lambda part: part.nodes[0])
def test_the_tests_of_a_row_are_there(part: Tests) -> None:
    for node in part.nodes:
        path, _, name = node.partition("::")
        place = PROJECT_DIR / path
        assert place.exists(), node
        assert not name or re.search(rf"^def {name}\(", place.read_text(), re.MULTILINE), node


@pytest.mark.parametrize("module", sorted({part.module for part in PARTS if isinstance(part, Experiment)}))
def test_the_experiment_of_a_row_is_there(module: str) -> None:
    assert callable(import_module(f"tests.chaos.experiments.{module}").run)


def test_what_is_not_run_is_said_with_its_place() -> None:
    row = Row("O9", "elsewhere", 0.0, (Elsewhere("a test", "a target", "another command"),))
    [figure] = figures_of(row, Settings(11, False, {}))
    assert (figure.figure, figure.result) == ("another command", TargetResult.ELSEWHERE)


@pytest.mark.long
def test_a_row_of_tests_tells_figures_and_what_failed(tmp_path: Path) -> None:
    (tmp_path / "test_one.py").write_text(
        "def test_good(record_property):\n    record_property('figure', '3 of 3')\n\ndef test_bad():\n    assert False\n"
    )
    row = Row("R99", "made up", 0.1, (Tests("a test", "all", (str(tmp_path / "test_one.py"),), "{passed} of {all} tests"),))
    [figure] = figures_of(row, Settings(11, False, {}))
    assert figure.result == TargetResult.MISSED
    assert figure.figure.startswith("1 of 2 tests; 3 of 3; failed: ")


def test_figures_that_were_cut_off_in_the_middle_are_left_out(tmp_path: Path) -> None:
    path, one = tmp_path / "figures", Figure("R1", "a | b", "1", "2", TargetResult.MET)
    write(one, path)
    with path.open("a") as lines:
        lines.write('{"row": "R2", "te')
    assert written(path) == [one]


def test_the_document_keeps_the_lines_of_rows_that_were_not_run(tmp_path: Path) -> None:
    document = tmp_path / "reliability.md"
    document.write_text(f"Before\n{BEGINS}\n| R2 | old | 1 | 2 | met | then |\n| R1 | old | 1 | 2 | met | then |\n{ENDS}\nAfter\n")
    put_in_document(
        [Figure("R1", "new", "3", "4", TargetResult.MISSED)],
        seed=11,
        at=datetime(2026, 11, 22, tzinfo=UTC),
        order=["R1", "R2"],
        document=document,
    )
    lines = document.read_text().splitlines()
    assert [line.split(" | ")[1] for line in lines if line.startswith("| R")] == ["new", "old"]
    assert (lines[0], lines[-1]) == ("Before", "After")
    assert BEGINS in DOCUMENT.read_text() and ENDS in DOCUMENT.read_text()
