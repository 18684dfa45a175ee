"""Which skips ./check lets pass, and that it fails on others and on runs without any test."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from scripts.test_run.reports import FORBIDDEN_SKIPS, NO_TESTS, Report, allowed_skips, read_report, read_tap, summary

PROJECT_DIR = Path(__file__).resolve().parents[2]
PROJECT = """
[tool.pytest.ini_options]
empty_parameter_set_mark = "fail_at_collect"
markers = ["browser: opens pages"]

[tool.spanwise.tests.allowed_skips]
"real data not here: " = "files of others"
"""
RUNS = "def test_it(): pass\n"
SKIPS = "import pytest\ndef test_not():\n    pytest.skip({reason!r})\n"
SKIPS_MODULE = "import pytest\npytest.importorskip('no_such_library')\ndef test_it(): pass\n"
MARKED = "import pytest\n@pytest.mark.skipif(True, reason='no radio here')\ndef test_not(): pass\n"
NO_OTHER_PLUGINS = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # their imports take most of the time of so small a run
EMPTY = "import pytest\n@pytest.mark.parametrize('model', [])\ndef test_each(model): pass\n"


def _run(folder: Path, *modules: str, workers: int = 0) -> tuple[int, str, Report]:
    """Exit code, output and report of pytest on these modules as ./check runs it."""
    (folder / "pyproject.toml").write_text(PROJECT)
    for number, module in enumerate(modules):
        (folder / f"test_{number}.py").write_text(module)
    report = folder / "report.json"
    command = [sys.executable, "-m", "pytest", "-p", "xdist.plugin", "-p", "scripts.test_run.plugin", "-p", "no:cacheprovider"]
    command += [f"--check-report={report}", f"--rootdir={folder}", f"--numprocesses={workers}", str(folder)]
    done = subprocess.run(command, cwd=PROJECT_DIR, env=os.environ | NO_OTHER_PLUGINS, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr, read_report(report)


@pytest.mark.parametrize("workers", [0, 2])
def test_skips_that_are_not_in_the_list_fail_the_run_and_are_named(workers: int, tmp_path: Path) -> None:
    fails = "def test_it(): assert False\n"  # else a second try of this one would make the run pass
    code, output, report = _run(tmp_path, RUNS, fails, SKIPS.format(reason="not today"), MARKED, SKIPS_MODULE, workers=workers)
    assert code == FORBIDDEN_SKIPS, output
    expected = {"test_2.py::test_not": "not today", "test_3.py::test_not": "no radio here"}
    assert report.skipped == expected | {"test_4.py": "could not import 'no_such_library': No module named 'no_such_library'"}
    for name, reason in report.skipped.items():
        assert f"May not be skipped: {name}: {reason}" in output


@pytest.mark.parametrize("workers", [0, 2])
def test_a_skip_of_the_list_passes_and_tests_are_counted_by_kind(workers: int, tmp_path: Path) -> None:
    browser = "import pytest\n@pytest.mark.browser\ndef test_page(): pass\n"
    database = "import pytest\n@pytest.fixture\ndef db(): pass\n@pytest.mark.parametrize('n', [1, 2])\ndef test_rows(db, n): pass\n"
    code, output, report = _run(tmp_path, RUNS, SKIPS.format(reason="real data not here: a.pbf"), browser, database, workers=workers)
    assert code == 0, output
    assert report.skipped == {"test_1.py::test_not": "real data not here: a.pbf"}
    assert report.ran == {"unit": 1, "browser": 1, "database": 2}
    assert summary([report])[:3] == ["Tests: 1 unit, 2 database, 1 browser", "Skipped: 1", "      1  real data not here: a.pbf"]
    assert len(report.cpu_s) == 4 + 1 and all(used_s > 0.0 for used_s in report.cpu_s.values())
    reports = [Report(cpu_s={"one": 1_000.0, "two": 0.25}), Report(cpu_s={"three": 7.0})]
    total = "Processor time of tests and the programs they end: 1,007 s"
    assert summary(reports) == [total, "  1000.0  one", "    7.0  three", "    0.2  two"]


@pytest.mark.long
@pytest.mark.parametrize("workers", [0, 2])
def test_an_empty_parameter_set_fails_the_run(workers: int, tmp_path: Path) -> None:
    code, output, _ = _run(tmp_path, RUNS, EMPTY, workers=workers)
    assert code != 0
    assert "Empty parameter set" in output


def test_the_projects_own_tests_fail_on_an_empty_parameter_set(pytestconfig: pytest.Config) -> None:
    assert pytestconfig.getini("empty_parameter_set_mark") == "fail_at_collect"


@pytest.mark.long
@pytest.mark.parametrize(
    ("module", "workers"), [(SKIPS.format(reason="real data not here: a.pbf"), 2), ("", 0)], ids=["all skipped", "none there"]
)
def test_a_run_in_which_no_test_ran_fails(module: str, workers: int, tmp_path: Path) -> None:
    code, output, _ = _run(tmp_path, module, workers=workers)
    assert code == NO_TESTS, output
    assert "No test ran." in output


TAP = """TAP version 13
# Subtest: zones
    ok 1 - are drawn
    ok 2 - are cut # SKIP {reason}
    ok 3 - are named # {later}
    1..3
ok 1 - zones
1..1
# tests 4
# pass 1
# fail 0
# cancelled 0
# skipped 1
# todo 1
"""


def test_skips_of_javascript_tests_are_judged_by_the_same_list(tmp_path: Path) -> None:
    path = tmp_path / "javascript.tap"
    path.write_text(TAP.format(reason="real data not here: zones.json", later="TO" + "DO"))
    report = read_tap(path)
    assert report.ran == {"javascript": 1}
    assert report.skipped == {"are cut": "real data not here: zones.json", "are named": "todo"}
    assert report.forbidden(["real data"]) == {"are named": "todo"}
    assert report.judge(0, ["real data"]) == FORBIDDEN_SKIPS
    assert report.judge(0, ["real data", "todo"]) == 0


def test_javascript_tests_of_which_none_ran_fail(tmp_path: Path) -> None:
    assert read_tap(tmp_path / "never written").judge(0, []) == NO_TESTS


def test_node_writes_skips_as_they_are_read_here(tmp_path: Path) -> None:
    module, path = tmp_path / "some.test.js", tmp_path / "some.tap"
    module.write_text(
        "const { test } = require('node:test');\n"
        "test('runs', () => {}); test('later', { todo: 'not written' }, () => {}); test('never', { skip: 'no map here' }, () => {});"
        "test('inside', (t) => t.skip('not today'));"
    )
    options = ["--test-reporter=tap", f"--test-reporter-destination={path}"]
    subprocess.run([str(PROJECT_DIR / ".venv" / "bin" / "node"), "--test", *options, str(module)], check=True, capture_output=True)
    report = read_tap(path)
    assert report.skipped == {"later": "not written", "never": "no map here", "inside": "not today"}
    assert report.ran["javascript"] == 1


def test_the_projects_own_list_lets_real_data_be_absent_and_no_program() -> None:
    skips = Report(skipped={"a": "real data not here: shared/data/osm/a.pbf", "b": "nginx is not installed; ./run installs it"})
    assert list(skips.forbidden(allowed_skips(PROJECT_DIR))) == ["b"]
