"""How ./check runs its steps."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scripts.check import Step, run_all


def _step(name: str, program: str, *, runs_beside: bool = False) -> Step:
    return Step(name, [sys.executable, "-c", program], runs_beside=runs_beside)


def test_a_step_beside_the_others_is_told_whole_and_last(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    met = tmp_path / "met"
    waits = f"import pathlib, sys, time\nwhile not pathlib.Path({str(met)!r}).exists(): time.sleep(0.02)\nprint('seen'); sys.exit(3)"
    arrives = f"import pathlib\npathlib.Path({str(met)!r}).touch(); print('here')"
    results = run_all([_step("first", arrives), _step("beside", waits, runs_beside=True)], {}, tmp_path)
    assert [(result.name, result.code) for result in results] == [("first", 0), ("beside", 3)]
    said = capfd.readouterr().out
    assert said.index("here") < said.index("── beside") < said.index("seen")


def test_what_runs_beside_has_a_database_of_its_own_where_it_needs_one(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    tells = [sys.executable, "-c", "import os; print(os.environ['DATABASE_URL'], os.environ['REDIS_URL'])"]
    servers = {"DATABASE_URL": "postgis://role@%2Ftmp%2Fplace/spanwise", "REDIS_URL": "unix:///tmp/place/redis.sock?db=3"}
    run_all([Step("own", tells, runs_beside=True, has_own_database=True), Step("shared", tells)], servers, tmp_path)
    said = [line.split() for line in capfd.readouterr().out.splitlines() if line.startswith("postgis://")]
    assert said == [list(servers.values()), ["postgis://role@%2Ftmp%2Fplace/spanwise_beside", "unix:///tmp/place/redis.sock?db=4"]]


def test_all_steps_run_when_one_fails(tmp_path: Path) -> None:
    results = run_all([_step("first", "raise SystemExit(2)"), _step("second", "")], {}, tmp_path)
    assert [(result.name, result.code) for result in results] == [("first", 2), ("second", 0)]


CHECK = """
import signal, sys
from pathlib import Path
from scripts.check import Step, _interrupt, run_all
signal.signal(signal.SIGINT, _interrupt)
folder = Path(sys.argv[1])
steps = [Step(name, [sys.executable, "-c", sys.argv[2], str(folder / name)], runs_beside=name == "beside") for name in ("here", "beside")]
run_all(steps, {}, folder)
"""
SITE = """
import sys, time
from pathlib import Path
state = Path(sys.argv[1])
try:
    state.write_text("up")
    time.sleep(60)
except KeyboardInterrupt:
    state.write_text("stopped")
"""


def test_an_interrupt_reaches_every_step_that_runs_and_lets_it_stop_what_it_started(tmp_path: Path) -> None:
    check = subprocess.Popen([sys.executable, "-c", CHECK, str(tmp_path), SITE], stderr=subprocess.DEVNULL)
    states = [tmp_path / name for name in ("here", "beside")]
    deadline = time.monotonic() + 30
    while [state.read_text() if state.exists() else "" for state in states] != ["up", "up"]:
        assert time.monotonic() < deadline
        time.sleep(0.02)
    check.send_signal(signal.SIGINT)
    check.wait(30)
    assert [state.read_text() for state in states] == ["stopped", "stopped"]
