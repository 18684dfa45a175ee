"""./check: private servers, then one step after the other, and a summary. All steps run, even when one has failed.

python -m scripts.check [--fast | --long] [PYTEST ARGUMENT...]
"""

import fcntl
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import NoReturn

from config.private_servers import private_database_url, private_redis_url, state_directory
from scripts import database_cluster
from scripts.places import PROJECT_DIR, CannotStart, prepare_sockets, prepare_state, remove_sockets
from scripts.programs import Program, database_server, queue_server
from scripts.supervision import Supervisor

PROGRAMS = PROJECT_DIR / ".venv" / "bin"


@dataclass(frozen=True)
class Step:
    """One check: a command and what it is called in the summary."""

    name: str
    command: list[str]
    environment: dict[str, str] = field(default_factory=dict)


def _python(*arguments: str) -> list[str]:
    return [sys.executable, *arguments]


def _pytest(expression: str, arguments: list[str]) -> list[str]:
    return _python("-m", "pytest", "-m", expression, *arguments)


def steps(arguments: list[str]) -> list[Step]:
    """The steps that these arguments ask for."""
    is_fast, is_long = "--fast" in arguments, "--long" in arguments
    rest = [argument for argument in arguments if argument not in {"--fast", "--long"}]
    without_long = "" if is_long else " and not long"
    if rest:
        expression = "not browser" if is_fast else "browser or not browser"
        return [Step("pytest", _pytest(f"({expression}){without_long}", rest))]
    found = [
        Step("ruff check", [str(PROGRAMS / "ruff"), "check", "."]),
        Step("ruff format", [str(PROGRAMS / "ruff"), "format", "--check", "."]),
        Step("mypy", _python("-m", "mypy")),
        Step("import contracts", [str(PROGRAMS / "lint-imports")]),
        Step("migrations complete", _python("manage.py", "makemigrations", "--check", "--dry-run")),
        Step("check --deploy", _python("manage.py", "check", "--deploy", "--fail-level", "WARNING"), {"SPANWISE_HTTPS": "1"}),
        Step("pytest", _pytest(f"not browser{without_long}", [])),
    ]
    if scripts := sorted(str(path) for path in (PROJECT_DIR / "tests" / "javascript").glob("**/*.test.*js")):
        found.append(Step("JavaScript tests", [str(PROGRAMS / "node"), "--test", *scripts]))
    if not is_fast:
        found.append(Step("browser tests", _pytest(f"browser{without_long}", [])))
    return found


@contextmanager
def private_servers(state: Path) -> Iterator[dict[str, str]]:
    """PostgreSQL and Redis for the tests alone; yields the environment that leads to them. What the environment names is used as it is."""
    places = prepare_state(state)
    with places.lock.open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise CannotStart(f"another ./check is running on {state}") from None
        sockets = prepare_sockets(state)
        supervisor = Supervisor(places, sockets)
        supervisor.stop()  # what a killed ./check has left behind
        environment = {"SPANWISE_VAR": str(state)}
        servers: list[Program] = []
        if not os.environ.get("DATABASE_URL"):
            database_cluster.prepare_cluster(places)
            servers.append(database_server(places, sockets, is_durable=False))
            environment["DATABASE_URL"] = private_database_url(state)
        if not os.environ.get("REDIS_URL"):
            servers.append(queue_server(places, sockets))
            environment["REDIS_URL"] = private_redis_url(state)
        try:
            if servers:
                supervisor.start(servers)
            if "DATABASE_URL" in environment:
                database_cluster.wait_for_database(sockets)
                if not database_cluster.database_exists(sockets):
                    database_cluster.create_database(sockets)
            if "REDIS_URL" in environment:
                database_cluster.wait_for_queue(sockets)
            yield environment
        finally:
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(number, signal.SIG_IGN)
            supervisor.stop()
            remove_sockets(state)


def run(step: Step, environment: dict[str, str]) -> int:
    print(f"\n── {step.name} {'─' * max(0, shutil.get_terminal_size((100, 24)).columns - len(step.name) - 4)}", flush=True)
    return subprocess.run(step.command, cwd=PROJECT_DIR, env={**os.environ, **environment, **step.environment}, check=False).returncode


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt


def main(arguments: list[str]) -> int:
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _interrupt)
    results: list[tuple[str, int, float]] = []
    began = time.monotonic()
    try:
        with private_servers(state_directory() / "check") as environment:
            print(f"servers … {time.monotonic() - began:.1f} s", flush=True)
            for step in steps(arguments):
                began_step = time.monotonic()
                code = run(step, environment)
                results.append((step.name, code, time.monotonic() - began_step))
    except CannotStart as error:
        print(f"The servers for the tests could not start: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    if len(results) > 1:
        print("\nSummary")
        for name, code, duration_s in results:
            print(f"  {'ok' if code == 0 else f'FAILED ({code})':<12} {duration_s:7.1f} s  {name}")
        print(f"  {'':<12} {time.monotonic() - began:7.1f} s  in all", flush=True)
    return next((code for _, code, _ in results if code), 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
