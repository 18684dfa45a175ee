"""How tests that wait get a second try, and when they do not."""

import sys
from pathlib import Path

import pytest

from scripts.check import Step, run_all
from scripts.second_try import cache_arguments

TRIES = """
from pathlib import Path
import pytest
@pytest.mark.parametrize("number", range({tests}))
def test_it(number):
    tries = Path(__file__).with_name(f"tries-{{number}}")
    tries.write_text(tries.read_text() + "x" if tries.exists() else "x")
    assert number >= {late} or len(tries.read_text()) > {patience}
"""


def _lane(folder: Path, *, late: int, patience: int, tests: int) -> Step:
    module, cache = folder / "test_late.py", folder / "cache"
    module.write_text(TRIES.format(tests=tests, late=late, patience=patience))
    command = [sys.executable, "-m", "pytest", "--rootdir", str(folder), "-q", "-p", "no:django", str(module), *cache_arguments(cache)]
    return Step("lane", command, cache=cache, runs_beside=True)


@pytest.mark.parametrize(
    ("late", "patience", "code", "tries", "named"),
    [(2, 1, 0, "xx xx x x x x x", 2), (2, 9, 1, "xx xx x x x x x", 0), (6, 1, 1, "x x x x x x x", 0), (0, 0, 0, "x x x x x x x", 0)],
    ids=["two are late", "two fail", "many fail", "none fails"],
)
def test_few_failures_are_tried_again_when_all_is_over_and_many_are_not(
    late: int, patience: int, code: int, tries: str, named: int, tmp_path: Path
) -> None:
    lane = _lane(tmp_path, late=late, patience=patience, tests=7)
    over = tmp_path / "over"
    other = Step("other", [sys.executable, "-c", f"import time; time.sleep(1); open({str(over)!r}, 'w').close()"])
    [_, result] = run_all([other, lane], {}, tmp_path)
    assert over.exists()
    assert (result.code, len(result.late)) == (code, named)
    assert [(tmp_path / f"tries-{number}").read_text() for number in range(7)] == tries.split()


def test_a_step_without_a_cache_has_no_second_try(tmp_path: Path) -> None:
    lane = _lane(tmp_path, late=1, patience=1, tests=1)
    [result] = run_all([Step("once", lane.command)], {}, tmp_path)
    assert result.code == pytest.ExitCode.TESTS_FAILED
    assert (tmp_path / "tries-0").read_text() == "x"
