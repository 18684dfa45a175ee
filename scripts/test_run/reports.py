"""Report of one test run: tests by kind, each skip with its reason, and the rule on skips.

Permitted reasons of skips are in pyproject.toml, [tool.spanwise.tests.allowed_skips]: a regular expression, and why.
"""

import json
import re
import tomllib
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

FORBIDDEN_SKIPS = 8  # exit code, beside those of pytest (0 to 5)
NO_TESTS = 5  # pytest's own exit code
MAX_COSTLY = 10  # tests that the summary names
KINDS = ("unit", "database", "browser", "javascript")
TAP_SKIP = re.compile(r"^\s*(?:not )?ok \d+ - (?P<name>.*) # (?P<kind>SKIP|TOD[O])\b ?(?P<reason>.*)$", re.MULTILINE)
TAP_TOTAL = re.compile(r"^# (?P<name>pass|fail) (?P<number>\d+)$", re.MULTILINE)


@dataclass
class Report:
    """Number of tests by kind, the reason of each skipped one by its name, and the processor time of each test with its fixtures, s."""

    ran: Counter[str] = field(default_factory=Counter)
    skipped: dict[str, str] = field(default_factory=dict)
    cpu_s: dict[str, float] = field(default_factory=dict)

    def forbidden(self, allowed: Iterable[str]) -> dict[str, str]:
        """Return the skips whose reason matches no allowed pattern."""
        patterns = list(allowed)
        return {name: reason for name, reason in self.skipped.items() if not any(re.match(pattern, reason) for pattern in patterns)}

    def judge(self, code: int, allowed: Iterable[str]) -> int:
        """Return the exit code: a failure where a test was skipped without permission, or no test ran."""
        if code in (0, 1) and self.forbidden(allowed):
            return FORBIDDEN_SKIPS
        return NO_TESTS if code == 0 and not self.ran.total() else code

    def write(self, path: Path) -> None:
        path.write_text(json.dumps({"ran": self.ran, "skipped": self.skipped, "cpu_s": self.cpu_s}))


def allowed_skips(project: Path) -> list[str]:
    """Return the patterns of permitted reasons for skips."""
    settings = tomllib.loads((project / "pyproject.toml").read_text())
    return list(settings.get("tool", {}).get("spanwise", {}).get("tests", {}).get("allowed_skips", {}))


def read_report(path: Path) -> Report:
    """Return the report of a pytest run; an empty one if it did not get that far."""
    try:
        kept = json.loads(path.read_text())
    except OSError:
        return Report()
    return Report(Counter(kept["ran"]), kept["skipped"], kept["cpu_s"])


def read_tap(path: Path) -> Report:
    """Return the report of `node --test` in the Test Anything Protocol. To-do tests count as skipped."""
    try:
        text = path.read_text()
    except OSError:
        return Report()
    skipped = {found["name"]: found["reason"] or found["kind"].lower() for found in TAP_SKIP.finditer(text)}
    ran = sum(int(found["number"]) for found in TAP_TOTAL.finditer(text))
    return Report(Counter({"javascript": ran}), skipped)


def summary(reports: Iterable[Report]) -> list[str]:
    """Return the lines of counts by kind, of skips by reason, and of the processor time of tests with the costliest ones."""
    reports = list(reports)
    ran = sum((report.ran for report in reports), Counter[str]())
    reasons = Counter(reason for report in reports for reason in report.skipped.values())
    lines = ["Tests: " + ", ".join(f"{ran[kind]:,} {kind}" for kind in KINDS if ran[kind])] if ran else []
    if lines:
        lines.append(f"Skipped: {reasons.total()}")
    lines += (f"  {number:5}  {reason}" for reason, number in sorted(reasons.items()))
    cpu_s = {name: used_s for report in reports for name, used_s in report.cpu_s.items()}
    if cpu_s:
        lines.append(f"Processor time of tests and the programs they end: {sum(cpu_s.values()):,.0f} s")
        lines += (f"  {used_s:5.1f}  {name}" for name, used_s in sorted(cpu_s.items(), key=lambda pair: -pair[1])[:MAX_COSTLY])
    return lines
