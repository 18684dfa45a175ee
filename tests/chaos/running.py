"""Runs one part of a row, in a process of its own that ends in time, and tells its figures."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from scripts.places import PROJECT_DIR
from scripts.supervision.processes import end_session
from tests.chaos.figures import Figure, TargetResult, written
from tests.chaos.rows import Elsewhere, Experiment, Part, Row, Tests

STOP_S = 90.0


@dataclass(frozen=True)
class Settings:
    seed: int
    is_short: bool
    environment: dict[str, str]  # leads to the servers of the tests


def figures_of(row: Row, settings: Settings) -> Iterator[Figure]:
    for part in row.parts:
        yield from _figures_of_part(row, part, settings)


def _figures_of_part(row: Row, part: Part, settings: Settings) -> list[Figure]:
    if isinstance(part, Elsewhere):
        return [Figure(row.id, part.test, part.where, part.target, TargetResult.ELSEWHERE)]
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.jsonl"
        if isinstance(part, Tests):
            return [_of_tests(row, part, settings, report)]
        return _of_experiment(row, part, settings, report)


def _of_tests(row: Row, part: Tests, settings: Settings, report: Path) -> Figure:
    command = [sys.executable, "-m", "pytest", "-m", "long or not long", "-p", "tests.chaos.collector", "-p", "no:cacheprovider", "-q"]
    command += [*(["-k", part.select] if part.select else []), *part.nodes]
    code = _run(command, settings.environment | {"SPANWISE_CHAOS_REPORT": str(report)}, row.limit_s)
    reported = [json.loads(line) for line in report.read_text().splitlines()] if report.exists() else []
    failed = [one["node"] for one in reported if one["outcome"] == "failed"]
    skipped = [one["reason"] or one["node"] for one in reported if one["outcome"] == "skipped"]
    passed = len([one for one in reported if one["outcome"] == "passed"])
    words = [part.figure.format(passed=f"{passed:,}", all=f"{passed + len(set(failed)):,}")]
    words += dict.fromkeys(figure for one in reported for figure in one["figures"])
    words += [f"failed: {name}" for name in failed[:3]] + [f"left out: {reason}" for reason in dict.fromkeys(skipped)]
    if code != 0 and not failed:
        words.append(f"pytest ended with {code}")
    result = TargetResult.MISSED if code != 0 else TargetResult.MET if passed else TargetResult.NOT_RUN
    return Figure(row.id, part.test, "; ".join(words), part.target, result)


def _of_experiment(row: Row, part: Experiment, settings: Settings, report: Path) -> list[Figure]:
    command = [sys.executable, "-m", f"tests.chaos.experiments.{part.module}", "--seed", str(settings.seed), "--row", row.id]
    command += ["--figures", str(report), *(["--short"] if settings.is_short else []), *part.arguments]
    code = _run(command, settings.environment, row.limit_s)
    figures = written(report)
    if code != 0 and all(figure.result != TargetResult.MISSED for figure in figures):
        figures.append(Figure(row.id, part.test, f"the experiment ended with {code}", part.target, TargetResult.MISSED))
    if not figures:
        figures.append(Figure(row.id, part.test, "it told nothing", part.target, TargetResult.MISSED))
    return figures


def _run(command: list[str], environment: dict[str, str], limit_s: float) -> int | str:
    """The exit code, or that it was stopped; what it has started ends with it."""
    process = subprocess.Popen(command, cwd=PROJECT_DIR, env=os.environ | environment, start_new_session=True)  # noqa: S603
    try:
        return process.wait(limit_s)
    except subprocess.TimeoutExpired:
        return f"no end after {limit_s:.0f} s"
    finally:
        end_session(process, within_s=STOP_S)
