"""./check: private servers, then the tests, browser tests and other checks in parallel, and a summary.

All steps run, even when one has failed. Failed waiting tests get a second try at the end (scripts.test_run.second_try).

python -m scripts.check [--fast | --long] [PYTEST ARGUMENT...]
python -m scripts.check --sitl BINARY [PYTEST ARGUMENT...]      (the link's scenarios on a real firmware)
python -m scripts.check --chaos [ROW...]      (the fault table: tests.chaos)
"""

import fcntl
import os
import shutil
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import NoReturn

import pytest

from config.private_servers import private_database_url, private_redis_url, state_directory
from scripts.installation import database_cluster
from scripts.installation.system_packages import find_program
from scripts.places import PROJECT_DIR, CannotStart, Places, prepare_sockets, prepare_state, remove_sockets
from scripts.supervision.programs import SERVERS_STAGE, Program, database_server, queue_server
from scripts.supervision.supervision import Supervisor
from scripts.test_run.lanes import Result, Step, run_all
from scripts.test_run.reports import Report, allowed_skips, read_report, read_tap, summary
from scripts.test_run.second_try import cache_arguments, failed_tests, late_passes_file, note_late_passes, second_command

PROGRAMS = PROJECT_DIR / ".venv" / "bin"
TEST_WORKERS = min(8, (os.cpu_count() or 2) + 1)  # some of their tests mostly wait
TYPE_CHECKER = str(PROJECT_DIR / "node_modules" / "typescript-native" / "bin" / "tsc")
SLOWEST_LISTED = 40  # tests of a step of 5 s and more
BROWSER_WORKERS = 1 if TEST_WORKERS <= 3 else 2  # each with a whole installation, which takes a core beside the other tests
NOT_FAST = tuple(  # two thirds of the processor time of all tests, in four tenths of the tests
    f"tests/{folder}"
    for folder in (
        "accounts/single_sign_on", "inspection/demo_region", "inspection/importers", "inspection/imports", "missions/commands",
        "missions/planning", "missions/property_tests", "missions/replanning", "planning/separation", "planning/solver",
        "planning/trajectory", "planning/views", "results/media_metadata", "scripts", "simulation", "telemetry/alerting",
        "telemetry/alerts", "telemetry/gateway", "telemetry/links", "telemetry/live", "telemetry/record", "telemetry/returns",
        "telemetry/scenarios", "telemetry/watch", "workspace/live", "workspace/sessions",
    )
)  # fmt: skip
SITL, SITL_TESTS = "SPANWISE_SITL", "tests/telemetry/scenarios"


def _python(*arguments: str) -> list[str]:
    return [sys.executable, *arguments]


def _node(script: str, *arguments: str) -> list[str]:
    """Return the command of a node_modules program, run by the Node.js that set-up has installed."""
    return [str(PROGRAMS / "node"), str(PROJECT_DIR / "node_modules" / script), *arguments]


def _pytest(name: str, expression: str, arguments: list[str], *, lane: str = "tests", workers: int = 0, dist: str = "worksteal") -> Step:
    """Return a step of pytest that writes a report and retries failed waiting tests."""
    folder = state_directory() / "check" / "steps" / name.replace(" ", "-")
    folder.mkdir(parents=True, exist_ok=True)
    cache, report = folder / "cache", folder / "report.json"
    report.unlink(missing_ok=True)
    options = [*cache_arguments(cache), f"--check-report={report}", f"--durations={SLOWEST_LISTED}", "--durations-min=5"]
    command = _python("-m", "pytest", "-m", expression, *arguments, *options)
    if workers:
        command += [f"--numprocesses={workers}", f"--dist={dist}"]
    environment = {"PYTEST_PLUGINS": "scripts.test_run.plugin"} | ({"PY_COLORS": "1"} if sys.stdout.isatty() else {})
    return Step(name, command, lane, environment, cache, report)


def _javascript_tests() -> Iterator[Step]:
    if scripts := sorted(str(path) for path in (PROJECT_DIR / "tests" / "javascript").glob("**/*.test.*js")):
        report = state_directory() / "check" / "steps" / "javascript.tap"
        report.parent.mkdir(parents=True, exist_ok=True)
        report.unlink(missing_ok=True)
        reporters = [("spec", "stdout"), ("tap", str(report))]
        options = [f"--test-reporter{kind}={value}" for pair in reporters for kind, value in zip(("", "-destination"), pair, strict=True)]
        yield Step("JavaScript tests", [str(PROGRAMS / "node"), "--test", *options, *scripts], report=report)


def _sitl_tests(binary: str = "", *arguments: str) -> Step:
    """Return the link's tests on a firmware, in a network namespace, as it listens on all addresses. Raises CannotStart."""
    firmware = Path(binary).resolve()
    if not (binary and firmware.is_file() and os.access(firmware, os.X_OK)):
        raise CannotStart(f"--sitl needs the program of an ArduCopter in software in the loop, not {binary!r}")
    places = [] if any(SITL_TESTS in one for one in arguments) else [SITL_TESTS]
    step = _pytest("tests on a firmware", "sitl", [*places, *arguments])
    apart = ["unshare", "--net", *(["--map-root-user"] if os.geteuid() else []), "--"]
    command = [*apart, *_python("-m", "scripts.test_run.loopback"), *step.command]
    return replace(step, command=command, environment=step.environment | {SITL: str(firmware)}, cache=None)


def steps(arguments: list[str]) -> list[Step]:
    """Return the steps for these arguments."""
    if arguments[:1] == ["--sitl"]:
        return [_sitl_tests(*arguments[1:])]
    is_fast, is_long = "--fast" in arguments, "--long" in arguments
    rest = [argument for argument in arguments if argument not in {"--fast", "--long"}]
    without_long = "" if is_long else " and not long"
    if rest:
        expression = "not browser" if is_fast else "browser or not browser"
        return [_pytest("pytest", f"({expression}){without_long}", rest)]
    left_out = [f"--ignore={folder}" for folder in ("tests/browser", *(NOT_FAST if is_fast else ()))]
    found = [_pytest("tests", f"not browser{without_long}", left_out, workers=TEST_WORKERS)]
    if not is_fast:
        found.append(
            _pytest("browser tests", f"browser{without_long}", ["tests/browser"], lane="browser", workers=BROWSER_WORKERS, dist="loadfile")
        )
    return [
        *found,
        Step("ruff check", [str(PROGRAMS / "ruff"), "check", "."]),
        Step("ruff format", [str(PROGRAMS / "ruff"), "format", "--check", "."]),
        Step("import contracts", [str(PROGRAMS / "lint-imports")]),
        Step("mypy", _python("-m", "mypy")),
        Step("migrations complete", _python("manage.py", "makemigrations", "--check", "--dry-run")),
        Step("check --deploy", _python("manage.py", "check", "--deploy", "--fail-level", "WARNING"), environment={"SPANWISE_HTTPS": "1"}),
        *_javascript_tests(),
        Step("JavaScript lint", _node("@biomejs/biome/bin/biome", "check", "static/js", "tests/javascript")),
        Step("JavaScript types", [str(PROGRAMS / "node"), TYPE_CHECKER, "--project", "jsconfig.json"]),
        Step("API types", _python("-m", "scripts.development.api_types", "--check")),
    ]


def _worker_queue(places: Places, sockets: Path, worker: str) -> Program:
    """Return a Redis for one worker of pytest-xdist: all numbered databases of a server share its channels."""
    folder = places.process(f"redis-{worker}")
    folder.mkdir(parents=True, exist_ok=True)
    socket = sockets / f"redis-{worker}.sock"
    settings = {"port": "0", "unixsocket": str(socket), "unixsocketperm": "700", "dir": str(folder), "save": "", "logfile": ""}
    command = [find_program("redis-server") or "redis-server"]
    for name, value in settings.items():
        command += [f"--{name}", value]
    return Program(f"redis-{worker}", SERVERS_STAGE, command, folder)


@contextmanager
def private_servers(state: Path, *, workers: int = 0) -> Iterator[dict[str, str]]:
    """Start PostgreSQL and Redis for the tests only, with one more Redis for each worker of pytest-xdist.

    Yields the environment with their addresses. Addresses that the environment already has are used unchanged.
    """
    places = prepare_state(state)
    with places.lock.open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise CannotStart(f"another ./check is running on {state}") from None
        sockets = prepare_sockets(state)
        supervisor = Supervisor(places, sockets)
        supervisor.stop()  # left by a killed ./check
        environment = {"SPANWISE_VAR": str(state), "CHECK_SPANWISE_VAR": str(state / "workers" / "{worker}")}
        shutil.rmtree(state / "workers", ignore_errors=True)
        servers: list[Program] = []
        if not os.environ.get("DATABASE_URL"):
            database_cluster.prepare_cluster(places)
            servers.append(database_server(places, sockets, is_durable=False))
            environment["DATABASE_URL"] = private_database_url(state)
        if not os.environ.get("REDIS_URL"):
            servers += [queue_server(places, sockets), *(_worker_queue(places, sockets, f"gw{number}") for number in range(workers))]
            environment["REDIS_URL"] = private_redis_url(state)
            environment["CHECK_REDIS_URL"] = f"unix://{sockets}/redis-{{worker}}.sock"
        elif not os.environ["REDIS_URL"].startswith("unix:"):
            environment["CHECK_REDIS_URL"] = _numbered(os.environ["REDIS_URL"])
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


def _numbered(redis_url: str) -> str:
    """Return the pattern of an external Redis, with a numbered database for each worker."""
    address = redis_url.rpartition("/")[0] if redis_url.count("/") > 2 else redis_url
    return f"{address}/{{number}}"


def _report_of(step: Step) -> Report:
    if step.report is None:
        return Report()
    return read_tap(step.report) if step.report.suffix == ".tap" else read_report(step.report)


def _judged(step: Step, result: Result) -> Result:
    """Return the result after the rule on skips, which pytest's own run has already applied."""
    if step.report is None or step.report.suffix != ".tap":
        return result
    report = _report_of(step)
    for name, reason in report.forbidden(allowed_skips(PROJECT_DIR)).items():
        print(f"May not be skipped: {name}: {reason}")
    return replace(result, code=report.judge(result.code, allowed_skips(PROJECT_DIR)))


def with_second_try(step: Step, result: Result, environment: dict[str, str], logs: Path) -> Result:
    """Return the result of a step after its few failed tests have run again alone."""
    if step.cache is None or result.code != pytest.ExitCode.TESTS_FAILED:
        return result
    late, command = tuple(failed_tests(step.cache)), second_command(step.command, step.cache)
    if command is None:
        return result
    [again] = run_all([replace(step, name=f"{step.name}: a second time", command=command)], environment, logs / "second")
    return Result(step.name, again.code, result.duration_s + again.duration_s, () if again.code else late)


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt


def _print_summary(results: list[Result], reports: list[Report], often_late: list[str], duration_s: float) -> None:
    print("\nSummary")
    for result in results:
        print(f"  {'ok' if result.code == 0 else f'FAILED ({result.code})':<12} {result.duration_s:7.1f} s  {result.name}")
        for name in result.late:
            print(f"  {'':<24}passed only alone: {name}")
    for name in often_late:
        print(f"  {'FAILED':<24}passed only alone for the third time in 20 runs: {name}")
    print(f"  {'':<12} {duration_s:7.1f} s  in all")
    print(*(f"  {line}" for line in summary(reports)), sep="\n", flush=True)


def main(arguments: list[str]) -> int:
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _interrupt)
    os.environ.pop(SITL, None)  # they run only with --sitl
    state, began = state_directory() / "check", time.monotonic()
    try:
        with private_servers(state, workers=TEST_WORKERS) as environment:
            print(f"servers … {time.monotonic() - began:.1f} s", flush=True)
            to_run = steps(arguments)
            judged = [_judged(*pair) for pair in zip(to_run, run_all(to_run, environment, state / "log" / "steps"), strict=True)]
            reports = [_report_of(step) for step in to_run]
            results = [with_second_try(*pair, environment, state / "log" / "steps") for pair in zip(to_run, judged, strict=True)]
    except CannotStart as error:
        print(f"The servers for the tests could not start: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    if len(results) == 1:
        return results[0].code
    often_late = note_late_passes(late_passes_file(state), (name for result in results for name in result.late))
    _print_summary(results, reports, often_late, time.monotonic() - began)
    return next((result.code for result in results if result.code), 1 if often_late else 0)


if __name__ == "__main__":
    if "--chaos" in sys.argv:
        arguments = [argument for argument in sys.argv[1:] if argument != "--chaos"]
        os.execv(sys.executable, _python("-m", "tests.chaos", *arguments))  # noqa: S606 - no shell
    sys.exit(main(sys.argv[1:]))
