"""./check: private servers, then one step after the other, the browser tests and those that mostly wait beside them, and a summary.

All steps run, even when one has failed. Tests that wait have a second try when all is over (scripts.second_try).

python -m scripts.check [--fast | --long] [PYTEST ARGUMENT...]
python -m scripts.check --chaos [ROW...]      (the fault table: tests.chaos)
"""

import fcntl
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import FrameType
from typing import BinaryIO, NoReturn

import pytest

from config.private_servers import private_database_url, private_redis_url, state_directory
from scripts import database_cluster
from scripts.places import PROJECT_DIR, CannotStart, prepare_sockets, prepare_state, remove_sockets
from scripts.processes import end_session
from scripts.programs import Program, database_server, queue_server
from scripts.second_try import cache_arguments, failed_tests, second_command
from scripts.supervision import Supervisor

PROGRAMS = PROJECT_DIR / ".venv" / "bin"
POLL_S = 0.5
STOP_S = 60
# Three lines side by side, about as long as each other: what computes and then what waits for workers and simulated UAVs; what waits
# for the gateway and then some pages, on a site of their own; the other pages.
WAITING_TESTS = (  # for other processes, more than they compute: beside the others they cost little
    "tests/telemetry/gateway", "tests/telemetry/live", "tests/telemetry/watch", "tests/telemetry/test_companion.py",
    "tests/telemetry/test_command_delivery.py", "tests/workspace/test_live.py", "tests/config/test_drained_workers.py",
)  # fmt: skip
WAITING_TESTS_AFTER = (
    "tests/scripts",
    "tests/missions/test_lost_planners.py", "tests/inspection/test_lost_workers.py",
    "tests/simulation/test_fleet.py", "tests/simulation/test_mavproxy.py", "tests/simulation/test_mavsdk.py",
    "tests/simulation/test_pool_connections.py", "tests/simulation/test_simulator.py", "tests/simulation/test_through_the_gateway.py",
)  # fmt: skip
BROWSER_TESTS_AFTER = (  # those that wait for the gateway
    "tests/browser/ground", "tests/browser/people", "tests/browser/test_offline.py", "tests/browser/test_unsaved_changes.py",
)  # fmt: skip


@dataclass(frozen=True)
class Step:
    """One check: a command and what it is called in the summary."""

    name: str
    command: list[str]
    environment: dict[str, str] = field(default_factory=dict)
    runs_beside: bool = False  # it starts first and is told last
    has_own_database: bool = False  # on the servers of all, since two runs of pytest on one database would be in each other's way
    cache: Path | None = None  # pytest's, of a step that has a second try


def _python(*arguments: str) -> list[str]:
    return [sys.executable, *arguments]


def _pytest(expression: str, arguments: list[str]) -> list[str]:
    return _python("-m", "pytest", "-m", expression, *arguments)


def _waiting(step: Step) -> Step:
    """A step of pytest as one that has a second try."""
    cache = state_directory() / "check" / f"pytest-{step.name.replace(' ', '-')}"
    return replace(step, command=[*step.command, *cache_arguments(cache)], cache=cache)


def steps(arguments: list[str]) -> list[Step]:
    """The steps that these arguments ask for."""
    is_fast, is_long = "--fast" in arguments, "--long" in arguments
    rest = [argument for argument in arguments if argument not in {"--fast", "--long"}]
    without_long = "" if is_long else " and not long"
    if rest:
        expression = "not browser" if is_fast else "browser or not browser"
        return [Step("pytest", _pytest(f"({expression}){without_long}", rest))]
    quick, pages = f"not browser{without_long}", f"browser{without_long}"
    beside = quick if is_fast else f"(browser or not browser){without_long}"
    beside_places = [*WAITING_TESTS, *(() if is_fast else BROWSER_TESTS_AFTER)]
    found = [
        Step("ruff check", [str(PROGRAMS / "ruff"), "check", "."]),
        Step("ruff format", [str(PROGRAMS / "ruff"), "format", "--check", "."]),
        Step("mypy", _python("-m", "mypy")),
        Step("import contracts", [str(PROGRAMS / "lint-imports")]),
        Step("migrations complete", _python("manage.py", "makemigrations", "--check", "--dry-run")),
        Step("check --deploy", _python("manage.py", "check", "--deploy", "--fail-level", "WARNING"), {"SPANWISE_HTTPS": "1"}),
        Step("pytest", _pytest(quick, [f"--ignore={place}" for place in (*WAITING_TESTS, *WAITING_TESTS_AFTER)])),
        _waiting(Step("tests that wait for workers and simulated UAVs", _pytest(quick, list(WAITING_TESTS_AFTER)))),
        _waiting(Step("tests that wait", _pytest(beside, beside_places), runs_beside=True, has_own_database=True)),
    ]
    if scripts := sorted(str(path) for path in (PROJECT_DIR / "tests" / "javascript").glob("**/*.test.*js")):
        found.append(Step("JavaScript tests", [str(PROGRAMS / "node"), "--test", *scripts]))
    if not is_fast:
        others = [f"--ignore={place}" for place in BROWSER_TESTS_AFTER]
        found.append(_waiting(Step("browser tests", _pytest(pages, ["tests/browser", *others]), runs_beside=True)))
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


@dataclass(frozen=True)
class Result:
    """How a step ended."""

    name: str
    code: int
    duration_s: float
    late: tuple[str, ...] = ()  # tests that passed only the second time


def _headline(step: Step) -> None:
    print(f"\n── {step.name} {'─' * max(0, shutil.get_terminal_size((100, 24)).columns - len(step.name) - 4)}", flush=True)


def _own_database(environment: dict[str, str]) -> dict[str, str]:
    """The same servers, with another name for the database and another number for Redis's."""
    database, _, options = environment["DATABASE_URL"].partition("?")
    redis, _, number = environment["REDIS_URL"].partition("?db=")
    if not redis.startswith("unix:"):
        redis, _, number = redis.rpartition("/") if redis.count("/") > 2 else (redis, "", "0")
    own = int(number or 0) + 1
    return {
        "DATABASE_URL": f"{database}_beside" + (f"?{options}" if options else ""),
        "REDIS_URL": f"{redis}?db={own}" if redis.startswith("unix:") else f"{redis}/{own}",
    }


def _start(step: Step, environment: dict[str, str], output: BinaryIO | None) -> subprocess.Popen[bytes]:
    whole = {**os.environ, **environment, **step.environment}
    return subprocess.Popen(
        step.command,
        cwd=PROJECT_DIR,
        env=whole | _own_database(whole) if step.has_own_database else whole,
        stdout=output,
        stderr=None if output is None else subprocess.STDOUT,
        start_new_session=True,  # an interrupt reaches it once, from here, or it would not stop its site
    )


def _run_here(step: Step, environment: dict[str, str]) -> Result:
    _headline(step)
    began = time.monotonic()
    process = _start(step, environment, None)
    try:
        process.wait()
    finally:
        end_session(process, within_s=STOP_S)
    return Result(step.name, process.returncode, time.monotonic() - began)


def _tell(step: Step, log: Path, process: subprocess.Popen[bytes]) -> None:
    """What a step beside the others has written so far, and then what it writes until it ends."""
    _headline(step)
    with log.open("rb") as written:
        is_over = False
        while not is_over:
            is_over = process.poll() is not None  # before the last look, or its last words were lost
            while part := written.read(65_536):
                sys.stdout.buffer.write(part)
            sys.stdout.flush()
            if not is_over:
                time.sleep(POLL_S)


def _with_second_try(step: Step, result: Result, environment: dict[str, str]) -> Result:
    """What became of a step once its few failed tests have run again alone."""
    if step.cache is None or result.code != pytest.ExitCode.TESTS_FAILED:
        return result
    late, command = tuple(failed_tests(step.cache)), second_command(step.command, step.cache)
    if command is None:
        return result
    again = _run_here(replace(step, name=f"{step.name}: a second time", command=command), environment)
    return Result(step.name, again.code, result.duration_s + again.duration_s, () if again.code else late)


def run_all(to_run: list[Step], environment: dict[str, str], logs: Path) -> list[Result]:
    """One step after the other, beside those that run beside them, whose output is kept in the folder `logs` until the others are done."""
    began_s = time.time()
    with ExitStack() as open_logs:
        started: list[tuple[Step, Path, subprocess.Popen[bytes]]] = []
        try:
            for number, step in enumerate(step for step in to_run if step.runs_beside):
                log = logs / f"beside-{number}.log"
                started.append((step, log, _start(step, environment, open_logs.enter_context(log.open("wb")))))
            results = [_run_here(step, environment) for step in to_run if not step.runs_beside]
            for step, log, process in started:
                _tell(step, log, process)
                results.append(Result(step.name, process.returncode, max(0.0, log.stat().st_mtime - began_s)))  # until its last word
        finally:
            for _, _, process in started:
                end_session(process, within_s=STOP_S)
    by_name = {step.name: step for step in to_run}
    return [_with_second_try(by_name[result.name], result, environment) for result in results]


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt


def main(arguments: list[str]) -> int:
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _interrupt)
    results: list[Result] = []
    began = time.monotonic()
    try:
        with private_servers(state_directory() / "check") as environment:
            print(f"servers … {time.monotonic() - began:.1f} s", flush=True)
            results = run_all(steps(arguments), environment, state_directory() / "check")
    except CannotStart as error:
        print(f"The servers for the tests could not start: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    if len(results) > 1:
        print("\nSummary")
        for result in results:
            print(f"  {'ok' if result.code == 0 else f'FAILED ({result.code})':<12} {result.duration_s:7.1f} s  {result.name}")
            for name in result.late:
                print(f"  {'':<24}passed only alone: {name}")
        print(f"  {'':<12} {time.monotonic() - began:7.1f} s  in all", flush=True)
    return next((result.code for result in results if result.code), 0)


if __name__ == "__main__":
    if "--chaos" in sys.argv:
        arguments = [argument for argument in sys.argv[1:] if argument != "--chaos"]
        os.execv(sys.executable, _python("-m", "tests.chaos", *arguments))  # noqa: S606 - no shell
    sys.exit(main(sys.argv[1:]))
