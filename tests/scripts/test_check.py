"""How ./check runs its steps."""

import subprocess
import sys
from pathlib import Path

import pytest

from scripts.check import Step, run_all


def _step(name: str, program: str, *, runs_beside: bool = False) -> Step:
    return Step(name, [sys.executable, "-c", program], runs_beside=runs_beside)


def test_a_step_beside_the_others_is_told_whole_and_last(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    met = tmp_path / "met"
    waits = f"import pathlib, sys, time\nwhile not pathlib.Path({str(met)!r}).exists(): time.sleep(0.02)\nprint('seen'); sys.exit(3)"
    arrives = f"import pathlib\npathlib.Path({str(met)!r}).touch(); print('here')"
    results = run_all([_step("first", arrives), _step("beside", waits, runs_beside=True)], {}, tmp_path / "beside.log")
    assert [(result.name, result.code) for result in results] == [("first", 0), ("beside", 3)]
    said = capfd.readouterr().out
    assert said.index("here") < said.index("── beside") < said.index("seen")


def test_all_steps_run_when_one_fails(tmp_path: Path) -> None:
    results = run_all([_step("first", "raise SystemExit(2)"), _step("second", "")], {}, tmp_path / "beside.log")
    assert [(result.name, result.code) for result in results] == [("first", 2), ("second", 0)]


def test_an_interrupt_reaches_the_step_beside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log = tmp_path / "beside.log"
    sleeps = "import time\ntry:\n    print('up', flush=True); time.sleep(60)\nexcept KeyboardInterrupt:\n    print('stopped')"
    real_run = subprocess.run

    def interrupted(*arguments: object, **more: object) -> None:
        real_run(
            [sys.executable, "-c", f"import time\nwhile 'up' not in open({str(log)!r}).read(): time.sleep(0.02)"], check=True, timeout=30
        )
        raise KeyboardInterrupt

    monkeypatch.setattr(subprocess, "run", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run_all([_step("first", ""), _step("beside", sleeps, runs_beside=True)], {}, log)
    assert log.read_text().split() == ["up", "stopped"]
