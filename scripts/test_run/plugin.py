"""The pytest plugin of ./check: separate servers for each worker of pytest-xdist, and the report with the rule on skips.

./check names it in PYTEST_PLUGINS, so it is loaded before the settings are read.
"""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import pytest

from scripts.test_run.reports import Report, allowed_skips
from scripts.test_run.second_try import WAITING_TESTS

Item = TypeVar("Item")

WORKER_VARIABLES = ("REDIS_URL", "SPANWISE_VAR")  # ./check gives a pattern of each, named CHECK_…
DATABASE_FIXTURES = {"db", "transactional_db", "django_db_setup"}


def use_own_servers(environment: "os._Environ[str] | dict[str, str]") -> None:
    """Fill in the patterns for this worker; pytest-django names its database."""
    worker = environment.get("PYTEST_XDIST_WORKER")
    for name in WORKER_VARIABLES:
        if worker and (pattern := environment.get(f"CHECK_{name}")):
            number = int(worker.removeprefix("gw")) + 1  # 0 is for runs without workers
            environment[name] = pattern.replace("{worker}", worker).replace("{number}", str(number))


use_own_servers(os.environ)


def kind_of(item: pytest.Item) -> str:
    """Return `browser`, `database` or `unit`."""
    if item.get_closest_marker("browser"):
        return "browser"
    uses_database = item.get_closest_marker("django_db") or DATABASE_FIXTURES & set(getattr(item, "fixturenames", ()))
    return "database" if uses_database else "unit"


def waiting_first(items: Sequence[Item], is_waiting: Sequence[bool], workers: int) -> list[Item]:
    """Return the items in an order in which each worker's part, of about equal length, begins with a share of the waiting ones.

    pytest-xdist's `worksteal` cuts the list into such parts. Waiting tests run while the browser tests keep the cores busy; computing ones
    follow, and no worker waits alone at the end.
    """
    waiting = [item for item, waits in zip(items, is_waiting, strict=True) if waits]
    computing = [item for item, waits in zip(items, is_waiting, strict=True) if not waits]
    found: list[Item] = []
    for worker in range(workers):
        length = (len(items) - len(found)) // (workers - worker)
        share = len(waiting) // (workers - worker)
        found += [*waiting[:share], *computing[: length - share]]
        waiting, computing = waiting[share:], computing[length - share :]
    return found


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


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    is_waiting = [item.nodeid.startswith(WAITING_TESTS) for item in items]
    if workers > 1 and not all(is_waiting):
        items[:] = waiting_first(items, is_waiting, workers)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    item.user_properties.append(("kind", kind_of(item)))
