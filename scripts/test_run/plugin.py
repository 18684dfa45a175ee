"""The pytest plugin of ./check: separate servers for each worker of pytest-xdist, rare collections, the report with the rule on skips.

./check names it in PYTEST_PLUGINS, so it is loaded before the settings are read.
"""

import gc
import os
import resource
from pathlib import Path

import pytest

from operation.garbage_collection import collect_rarely
from scripts.test_run.reports import Report, allowed_skips

WORKER_VARIABLES = ("REDIS_URL", "SPANWISE_VAR")  # ./check gives a pattern of each, named CHECK_…
DATABASE_FIXTURES = {"db", "transactional_db", "django_db_setup"}
BEGAN_CPU_S = pytest.StashKey[float]()


def use_own_servers(environment: "os._Environ[str] | dict[str, str]") -> None:
    """Fill in the patterns for this worker; pytest-django names its database."""
    worker = environment.get("PYTEST_XDIST_WORKER")
    for name in WORKER_VARIABLES:
        if worker and (pattern := environment.get(f"CHECK_{name}")):
            number = int(worker.removeprefix("gw")) + 1  # 0 is for runs without workers
            environment[name] = pattern.replace("{worker}", worker).replace("{number}", str(number))


use_own_servers(os.environ)
collect_rarely()


def pytest_collection_finish() -> None:
    """Freeze libraries and tests: collections that traverse them take a sixth of the time of all tests."""
    gc.collect()
    gc.freeze()


def kind_of(item: pytest.Item) -> str:
    """Return `browser`, `database` or `unit`."""
    if item.get_closest_marker("browser"):
        return "browser"
    uses_database = item.get_closest_marker("django_db") or DATABASE_FIXTURES & set(getattr(item, "fixturenames", ()))
    return "database" if uses_database else "unit"


def used_cpu_s() -> float:
    """Return the processor time of this process and of its ended children, s."""
    usages = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def reason_of(report: pytest.TestReport | pytest.CollectReport) -> str:
    """Return the reason of a skip, without pytest's prefix."""
    where = report.longrepr
    return str(where[2] if isinstance(where, tuple) else where).removeprefix("Skipped: ")


class Reporter:
    """Writes the report, and fails a run in which a test was skipped without permission, or no test ran."""

    def __init__(self, path: Path, project: Path) -> None:
        self.path, self.allowed, self.report = path, allowed_skips(project), Report()

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.skipped:
            self.report.skipped[report.nodeid] = reason_of(report)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.skipped and not hasattr(report, "wasxfail"):
            self.report.skipped[report.nodeid] = reason_of(report)
        elif report.when == "call" or (report.failed and report.when == "setup"):
            self.report.ran[str(dict(report.user_properties).get("kind", "unit"))] += 1
        elif report.when == "teardown":
            self.report.cpu_s[report.nodeid] = float(str(dict(report.user_properties)["cpu_s"]))

    @pytest.hookimpl(tryfirst=True)
    def pytest_sessionfinish(self, session: pytest.Session, exitstatus: int) -> None:
        self.report.write(self.path)
        session.exitstatus = self.report.judge(exitstatus, self.allowed)

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        for name, reason in self.report.forbidden(self.allowed).items():
            terminalreporter.write_line(f"May not be skipped: {name}: {reason}", red=True)
        if not self.report.ran.total():
            terminalreporter.write_line("No test ran.", red=True)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--check-report", type=Path, help="the file that ./check reads")


def pytest_configure(config: pytest.Config) -> None:
    path = config.getoption("--check-report")
    if path and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Reporter(path, config.rootpath))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    item.stash[BEGAN_CPU_S] = used_cpu_s()
    item.user_properties.append(("kind", kind_of(item)))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> None:
    if call.when == "teardown":
        item.user_properties.append(("cpu_s", used_cpu_s() - item.stash[BEGAN_CPU_S]))
