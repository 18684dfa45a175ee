"""The watch as a program of its own, so that it can be killed."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.telemetry.gateway.program import PROJECT_DIR, environment


@contextmanager
def watch_program(log_dir: Path, *, name: str) -> Iterator[subprocess.Popen[bytes]]:
    """Killed at the end unless it has ended by itself."""
    command = [sys.executable, "manage.py", "run_estimator", "--name", name]
    with (log_dir / f"{name}.log").open("a") as log:
        process = subprocess.Popen(command, cwd=PROJECT_DIR, env=environment(log_dir), stdout=log, stderr=log)  # noqa: S603
        try:
            yield process
        finally:
            process.kill()
            process.wait()
