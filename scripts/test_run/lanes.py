"""Run steps: those of one lane in sequence, the lanes in parallel. All run, even when one has failed.

A step's output goes to a file and is shown in the order of the steps, live for the step whose turn it is.
"""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from scripts.places import PROJECT_DIR
from scripts.supervision.processes import end_session

POLL_S = 0.2
STOP_S = 60


@dataclass(frozen=True)
class Step:
    """One check: a command and its name in the summary."""

    name: str
    command: list[str]
    lane: str = "checks"
    environment: dict[str, str] = field(default_factory=dict)
    cache: Path | None = None  # pytest's, of a step with a second try
    report: Path | None = None  # written by scripts.test_run.plugin, or in TAP where it ends in .tap


@dataclass(frozen=True)
class Result:
    """Outcome of a step."""

    name: str
    code: int
    duration_s: float
    late: tuple[str, ...] = ()  # tests that passed only on the second try


@dataclass
class _Run:
    """A step and its process."""

    step: Step
    log: Path
    process: subprocess.Popen[bytes] | None = None
    began_s: float = 0.0
    result: Result | None = None

    def start(self, environment: dict[str, str]) -> None:
        self.began_s = time.monotonic()
        with self.log.open("wb") as output:
            self.process = subprocess.Popen(
                self.step.command,
                cwd=PROJECT_DIR,
                env={**os.environ, **environment, **self.step.environment},
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,  # an interrupt reaches it once, from here, or it would not stop its site
            )

    def end(self) -> None:
        if self.process is not None:
            end_session(self.process, within_s=STOP_S)

    def note_end(self) -> None:
        if self.process is not None and self.result is None and self.process.poll() is not None:
            self.result = Result(self.step.name, self.process.returncode, time.monotonic() - self.began_s)


def _advance(runs: list[_Run], environment: dict[str, str]) -> None:
    """Record ended steps, and start the next step of each free lane."""
    for run in runs:
        run.note_end()
    busy = {run.step.lane for run in runs if run.process is not None and run.result is None}
    for run in runs:
        if run.process is None and run.step.lane not in busy:
            run.start(environment)
            busy.add(run.step.lane)


def _shown(runs: list[_Run]) -> Iterator[None]:
    """Print the steps' output in order; yields while the step whose turn it is has not ended."""
    for run in runs:
        print(f"\n── {run.step.name} {'─' * max(0, shutil.get_terminal_size((100, 24)).columns - len(run.step.name) - 4)}", flush=True)
        while run.process is None:
            yield
        with run.log.open("rb") as written:
            is_over = False
            while not is_over:
                is_over = run.result is not None  # before the last read, or its last lines would be lost
                while part := written.read(65_536):
                    sys.stdout.buffer.write(part)
                sys.stdout.flush()
                if not is_over:
                    yield


def run_all(to_run: list[Step], environment: dict[str, str], logs: Path) -> list[Result]:
    """Run the steps and return their results; their output is kept in the folder `logs`."""
    logs.mkdir(parents=True, exist_ok=True)
    runs = [_Run(step, logs / f"{number}.log") for number, step in enumerate(to_run)]
    with ExitStack() as ending:
        for run in runs:
            ending.callback(run.end)
        _advance(runs, environment)
        for _ in _shown(runs):
            time.sleep(POLL_S)
            _advance(runs, environment)
    return [run.result for run in runs if run.result is not None]
