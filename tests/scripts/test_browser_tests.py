"""How browser tests get a second try, and when they do not."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

TRIES = """
from pathlib import Path
import pytest
@pytest.mark.parametrize("number", range({tests}))
def test_it(number):
    tries = Path(__file__).with_name(f"tries-{{number}}")
    tries.write_text(tries.read_text() + "x" if tries.exists() else "x")
    assert number >= {late} or len(tries.read_text()) > {patience}
"""


@pytest.mark.parametrize(
    ("late", "patience", "code", "tries"),
    [(2, 1, 0, "xx xx x x x"), (2, 9, 1, "xx xx x x x"), (5, 1, 1, "x x x x x")],
    ids=["two are late", "two fail", "many fail"],
)
def test_few_failures_are_tried_again_and_many_are_not(late: int, patience: int, code: int, tries: str, tmp_path: Path) -> None:
    module = tmp_path / "test_late.py"
    module.write_text(TRIES.format(tests=5, late=late, patience=patience))
    run = subprocess.run(
        [sys.executable, "-m", "scripts.browser_tests", "lane", "--rootdir", str(tmp_path), "-q", "-p", "no:django", str(module)],
        env={**os.environ, "SPANWISE_VAR": str(tmp_path / "state")},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert run.returncode == code, run.stdout + run.stderr
    assert [(tmp_path / f"tries-{number}").read_text() for number in range(5)] == tries.split()
