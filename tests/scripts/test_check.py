"""How ./check runs its steps: lanes side by side, and one step after the other in each."""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scripts.check import NOT_FAST, SITL, TEST_WORKERS, steps
from scripts.places import PROJECT_DIR, CannotStart
from scripts.test_run.lanes import Step, run_all
from scripts.test_run.plugin import use_own_servers


def _step(name: str, program: str, *, lane: str = "checks") -> Step:
    return Step(name, [sys.executable, "-c", program], lane)


def test_lanes_run_side_by_side_and_are_shown_whole_in_the_order_of_the_steps(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    met = tmp_path / "met"
    waits = f"import pathlib, sys, time\nwhile not pathlib.Path({str(met)!r}).exists(): time.sleep(0.02)\nprint('seen'); sys.exit(3)"
    arrives = f"import pathlib\npathlib.Path({str(met)!r}).touch(); print('here')"
    results = run_all([_step("first", waits, lane="tests"), _step("second", arrives)], {}, tmp_path)
    assert [(result.name, result.code) for result in results] == [("first", 3), ("second", 0)]
    printed = capfd.readouterr().out
    assert printed.index("── first") < printed.index("seen") < printed.index("── second") < printed.index("here")


def test_a_step_waits_for_the_one_before_it_in_its_lane(tmp_path: Path) -> None:
    done = tmp_path / "done"
    takes_time = f"import pathlib, time; time.sleep(0.5); pathlib.Path({str(done)!r}).touch()"
    looks = f"import pathlib, sys; sys.exit(not pathlib.Path({str(done)!r}).exists())"
    results = run_all([_step("first", takes_time), _step("second", looks)], {}, tmp_path)
    assert [result.code for result in results] == [0, 0]


def test_all_steps_run_when_one_fails(tmp_path: Path) -> None:
    results = run_all([_step("first", "raise SystemExit(2)"), _step("second", "")], {}, tmp_path)
    assert [(result.name, result.code) for result in results] == [("first", 2), ("second", 0)]


CHECK = """
import signal, sys
from pathlib import Path
from scripts.check import _interrupt
from scripts.test_run.lanes import Step, run_all
signal.signal(signal.SIGINT, _interrupt)
folder = Path(sys.argv[1])
run_all([Step(name, [sys.executable, "-c", sys.argv[2], str(folder / name)], name) for name in ("here", "beside")], {}, folder)
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
    check = subprocess.Popen([sys.executable, "-c", CHECK, str(tmp_path), SITE], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    states = [tmp_path / name for name in ("here", "beside")]
    deadline = time.monotonic() + 30
    while [state.read_text() if state.exists() else "" for state in states] != ["up", "up"]:
        assert time.monotonic() < deadline
        time.sleep(0.02)
    check.send_signal(signal.SIGINT)
    check.wait(30)
    assert [state.read_text() for state in states] == ["stopped", "stopped"]


# --- which steps -------------------------------------------------------------------------------------------------------------------


def _expression(command: list[str]) -> str:
    return command[command.index("-m", command.index("-m") + 1) + 1]


def _expressions(arguments: list[str]) -> dict[str, str]:
    """Of each step that runs pytest, by its name."""
    return {step.name: _expression(step.command) for step in steps(arguments) if "pytest" in step.command}


def test_fast_leaves_the_browser_out_and_long_takes_the_long_tests_in() -> None:
    assert _expressions([]) == {"tests": "not browser and not long", "browser tests": "browser and not long"}
    assert _expressions(["--fast"]) == {"tests": "not browser and not long"}
    assert _expressions(["--long"]) == {"tests": "not browser", "browser tests": "browser"}


def test_fast_leaves_out_folders_that_are_there_and_take_part_in_every_other_run() -> None:
    assert [folder for folder in NOT_FAST if not [*(PROJECT_DIR / folder).rglob("test_*.py")]] == []
    for arguments, are_left_out in (["--fast"], True), ([], False), (["--long"], False):
        [command] = [step.command for step in steps(arguments) if step.name == "tests"]
        assert all((f"--ignore={folder}" in command) == are_left_out for folder in NOT_FAST)


def test_the_folder_of_the_browser_step_has_every_browser_test_and_no_other() -> None:
    marked = [path for path in (PROJECT_DIR / "tests").glob("**/*.py") if re.search(r"\bmark\.browser\b", path.read_text())]
    browser, scripts = PROJECT_DIR / "tests" / "browser", PROJECT_DIR / "tests" / "scripts"
    assert [path for path in browser.glob("**/test_*.py") if path not in marked] == []
    assert [path for path in marked if not {browser, scripts} & set(path.parents)] == []
    [step] = [step for step in steps([]) if step.name == "browser tests"]
    assert "tests/browser" in step.command


def test_other_arguments_go_to_pytest_alone() -> None:
    [step] = steps(["--fast", "tests/scripts", "-k", "port"])
    began = step.command.index("tests/scripts")
    assert step.command[began : began + 3] == ["tests/scripts", "-k", "port"]
    assert _expression(step.command) == "(not browser) and not long"
    assert not [argument for argument in step.command if argument.startswith("--numprocesses")]


def test_a_worker_has_a_redis_and_a_state_folder_of_its_own() -> None:
    [step] = [step for step in steps([]) if step.name == "tests"]
    assert f"--numprocesses={TEST_WORKERS}" in step.command
    given = {"REDIS_URL": "unix:///s/redis.sock", "SPANWISE_VAR": "/v", "CHECK_SPANWISE_VAR": "/v/workers/{worker}"}
    local = given | {"PYTEST_XDIST_WORKER": "gw2", "CHECK_REDIS_URL": "unix:///s/redis-{worker}.sock"}
    use_own_servers(local)
    assert (local["REDIS_URL"], local["SPANWISE_VAR"]) == ("unix:///s/redis-gw2.sock", "/v/workers/gw2")
    outside = given | {"PYTEST_XDIST_WORKER": "gw2", "CHECK_REDIS_URL": "redis://queue:6379/{number}"}
    use_own_servers(outside)
    assert outside["REDIS_URL"] == "redis://queue:6379/3"
    alone = given | {"CHECK_REDIS_URL": "unix:///s/redis-{worker}.sock"}
    use_own_servers(alone)
    assert (alone["REDIS_URL"], alone["SPANWISE_VAR"]) == ("unix:///s/redis.sock", "/v")


@pytest.mark.long
def test_a_firmware_has_a_network_of_its_own_and_no_other_run_starts_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(SITL, raising=False)
    monkeypatch.setenv("SPANWISE_VAR", str(tmp_path))
    firmware = tmp_path / "firmware"
    with pytest.raises(CannotStart, match="ArduCopter"):
        steps(["--sitl", str(firmware)])
    firmware.touch(mode=0o755)
    (step,) = steps(["--sitl", str(firmware), "-k", "wind"])
    assert step.command[:2] == ["unshare", "--net"] and step.environment[SITL] == str(firmware)
    assert step.command[step.command.index("scripts.test_run.loopback") + 1 :][:5] == [sys.executable, "-m", "pytest", "-m", "sitl"]
    assert step.command[step.command.index("sitl") + 1 :][:3] == ["tests/telemetry/scenarios", "-k", "wind"]
    options = ["--collect-only", "-q", "-m", "", "tests/telemetry/scenarios"]
    collected = subprocess.run([sys.executable, "-m", "pytest", *options], cwd=PROJECT_DIR, capture_output=True, text=True)
    assert "[emulated" in collected.stdout and "[firmware" not in collected.stdout, "other runs fly them on the scripted vehicle"
