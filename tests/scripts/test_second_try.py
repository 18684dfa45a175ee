"""How tests that wait get a second try, when they do not, and how often one test may need it."""

import sys
from pathlib import Path

import pytest

from scripts.check import with_second_try
from scripts.test_run.lanes import Result, Step, run_all
from scripts.test_run.second_try import COUNTED_RUNS, WAITING_TESTS, cache_arguments, note_late_passes
from tests.scripts.test_skips import NO_OTHER_PLUGINS

PROJECT_DIR = Path(__file__).resolve().parents[2]
TRIES = """
from pathlib import Path
import pytest
@pytest.mark.parametrize("number", range({tests}))
def test_it(number):
    tries = Path(__file__).with_name(f"tries-{{number}}")
    tries.write_text(tries.read_text() + "x" if tries.exists() else "x")
    assert number >= {late} or len(tries.read_text()) > {patience}
"""


def _step(folder: Path, *, late: int, patience: int, tests: int, place: str = "tests/browser", workers: int = 0) -> Step:
    module, cache = folder / place / "test_late.py", folder / "cache"
    module.parent.mkdir(parents=True)
    module.write_text(TRIES.format(tests=tests, late=late, patience=patience))
    command = [sys.executable, "-m", "pytest", "--rootdir", str(folder), "-q", "-p", "xdist.plugin", str(module), *cache_arguments(cache)]
    if workers:
        command += [f"--numprocesses={workers}", "--dist=loadfile"]
    return Step("step", command, environment=NO_OTHER_PLUGINS, cache=cache)


def _run(step: Step, folder: Path) -> Result:
    [result] = run_all([step], {}, folder)
    return with_second_try(step, result, {}, folder)


@pytest.mark.parametrize(
    ("late", "patience", "code", "tries", "named"),
    [(2, 1, 0, "xx xx x x x x x", 2), (2, 9, 1, "xx xx x x x x x", 0), (6, 1, 1, "x x x x x x x", 0), (0, 0, 0, "x x x x x x x", 0)],
    ids=["two are late", "two fail", "many fail", "none fails"],
)
def test_few_failures_are_tried_again_and_many_are_not(late: int, patience: int, code: int, tries: str, named: int, tmp_path: Path) -> None:
    result = _run(_step(tmp_path, late=late, patience=patience, tests=7), tmp_path)
    assert (result.code, len(result.late)) == (code, named)
    assert [(tmp_path / "tests" / "browser" / f"tries-{number}").read_text() for number in range(7)] == tries.split()


@pytest.mark.long
def test_tests_that_failed_in_one_of_several_workers_are_tried_again_in_none(tmp_path: Path) -> None:
    result = _run(_step(tmp_path, late=1, patience=1, tests=2, workers=2), tmp_path)
    assert (result.code, result.late) == (0, ("tests/browser/test_late.py::test_it[0]",))


def test_a_test_that_computes_has_no_second_try(tmp_path: Path) -> None:
    result = _run(_step(tmp_path, late=1, patience=1, tests=1, place="tests/missions"), tmp_path)
    assert result.code == pytest.ExitCode.TESTS_FAILED
    assert (tmp_path / "tests" / "missions" / "tries-0").read_text() == "x"


def test_every_place_of_tests_that_wait_is_there() -> None:
    assert [place for place in WAITING_TESTS if not (PROJECT_DIR / place).exists()] == []


def test_the_third_late_pass_of_a_test_in_20_runs_is_a_failure(tmp_path: Path) -> None:
    kept = tmp_path / "cache" / "late.jsonl"
    assert note_late_passes(kept, ["a", "b"]) == []
    assert note_late_passes(kept, []) == []
    assert note_late_passes(kept, ["a"]) == []
    assert note_late_passes(kept, ["a", "c"]) == ["a"]
    assert note_late_passes(kept, ["c"]) == [], "a failure counts in the run in which it happens"
    assert kept.read_text().splitlines() == ['["a", "b"]', "[]", '["a"]', '["a", "c"]', '["c"]']


def test_late_passes_of_runs_before_the_last_20_do_not_count(tmp_path: Path) -> None:
    kept = tmp_path / "late.jsonl"
    for _ in range(2):
        assert note_late_passes(kept, ["a"]) == []
    for _ in range(COUNTED_RUNS - 2):
        assert note_late_passes(kept, []) == []
    assert note_late_passes(kept, ["a"]) == [], "the first of the two is the 21st run from here"
    assert note_late_passes(kept, ["a"]) == []
    assert len(kept.read_text().splitlines()) == COUNTED_RUNS
