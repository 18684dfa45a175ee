"""A plug-in for pytest: what became of each test, and the figures that it has recorded, a line of JSON each.

Loaded by `-p tests.chaos.collector`; SPANWISE_CHAOS_REPORT names the file.
"""

import json
import os
from pathlib import Path

import pytest


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if report.when != "call" and report.passed:
        return
    figures = [str(value) for name, value in report.user_properties if name == "figure"]
    reason = report.longrepr[2] if report.skipped and isinstance(report.longrepr, tuple) else ""
    reported = {"node": report.nodeid, "outcome": report.outcome, "figures": figures, "reason": reason}
    with Path(os.environ["SPANWISE_CHAOS_REPORT"]).open("a") as lines:
        lines.write(json.dumps(reported) + "\n")
