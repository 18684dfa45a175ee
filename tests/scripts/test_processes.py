"""Finding and ending what a killed server leaves behind, and nothing else."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from scripts.places import PROJECT_DIR
from scripts.supervision.processes import end_processes, is_alive, processes_in

SLEEPER = [sys.executable, "-c", "import time; print('up', flush=True); time.sleep(60)"]
DEAF_SLEEPER = [
    sys.executable,
    "-c",
    "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); print('up', flush=True); time.sleep(60)",
]

Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start() -> Iterator[Start]:
    """Start a process that prints a line once it is up; whatever lives at the end of the test is ended."""
    started: list[subprocess.Popen[str]] = []

    def start_one(command: list[str], folder: Path) -> subprocess.Popen[str]:
        environment = {**os.environ, "PYTHONPATH": str(PROJECT_DIR)}
        process = subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        started.append(process)
        assert process.stdout is not None
        process.stdout.readline()
        return process

    yield start_one
    for process in started:
        process.kill()
        process.communicate()


def test_a_program_of_ours_is_found_by_its_folder_and_ended(start: Start, tmp_path: Path) -> None:
    process = start(SLEEPER, tmp_path)
    assert processes_in([tmp_path]) == [process.pid]
    assert end_processes([tmp_path]) == 1
    assert process.wait() == -signal.SIGTERM


def test_a_program_in_another_folder_is_left_alone(start: Start, tmp_path: Path) -> None:
    (tmp_path / "ours").mkdir()
    process = start(SLEEPER, tmp_path)
    assert end_processes([tmp_path / "ours"]) == 0
    assert process.poll() is None


def test_somebody_elses_shell_in_our_folder_is_left_alone(start: Start, tmp_path: Path) -> None:
    process = start(["/bin/sh", "-c", "echo up; read -r line; echo $line"], tmp_path)
    assert end_processes([tmp_path]) == 0
    assert process.poll() is None


def test_what_does_not_end_when_asked_is_killed_once_patience_is_over(start: Start, tmp_path: Path) -> None:
    process = start(DEAF_SLEEPER, tmp_path)
    end_processes([tmp_path], patience_s=0.2)
    assert process.wait() == -signal.SIGKILL


def test_a_dead_process_that_nobody_has_collected_is_not_alive(start: Start, tmp_path: Path) -> None:
    process = start(SLEEPER, tmp_path)
    assert is_alive(process.pid)
    os.kill(process.pid, signal.SIGKILL)
    os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)  # dead, and still in /proc
    assert Path(f"/proc/{process.pid}").exists()
    assert not is_alive(process.pid)


def _through_start_program(folder: Path, *options: str) -> list[str]:
    return [sys.executable, "-m", "scripts.supervision.start_program", str(folder), *options, "--", *SLEEPER]


def test_a_program_ends_its_predecessors_leftovers_and_lock_before_it_starts(start: Start, tmp_path: Path) -> None:
    folder, lock = tmp_path / "program", tmp_path / "server.pid"
    folder.mkdir()
    lock.write_text("1\n")  # a process id that is in use, by something else
    leftover = start(SLEEPER, folder)
    successor = start(_through_start_program(folder, "--stale", str(lock)), tmp_path)
    assert successor.stdout is not None
    stated = [successor.stdout.readline() for _ in range(2)]
    assert leftover.wait() == -signal.SIGTERM
    assert not lock.exists()
    assert stated[0].startswith("removed server.pid")
    assert processes_in([folder]) == [successor.pid]


def test_a_program_follows_its_supervisor_into_death(start: Start, tmp_path: Path) -> None:
    folder = tmp_path / "program"
    folder.mkdir()
    command = _through_start_program(folder)
    supervisor = start(
        [sys.executable, "-c", f"import subprocess, sys; subprocess.run({command!r})"],
        tmp_path,
    )
    deadline = time.monotonic() + 10
    assert processes_in([folder])
    supervisor.kill()
    while processes_in([folder]):
        assert time.monotonic() < deadline
        time.sleep(0.02)
