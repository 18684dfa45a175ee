"""The second try of tests that wait for pages, programs and radio: a few that fail under load run again alone.

On a busy machine a page or a program can be late. A test that fails twice has failed, as has a run in which many tests fail. A test that
passes only on the second try is reported and recorded in a file, and the third such pass in 20 runs is a failure.
Computing tests have no second try, as their result is final.
"""

import json
import os
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

MAX_SECOND_TRIES = 5
WAITING_TESTS = (  # which mostly wait for other processes
    "tests/browser/",
    "tests/config/test_drained_workers.py",
    "tests/deploy/",
    "tests/inspection/test_lost_workers.py",
    "tests/missions/test_lost_planners.py",
    "tests/scripts/",
    "tests/simulation/ground_stations/",
    "tests/simulation/test_fleet.py",
    "tests/simulation/test_simulator.py",
    "tests/telemetry/gateway/",
    "tests/telemetry/links/test_command_delivery.py",
    "tests/telemetry/links/test_companion.py",
    "tests/telemetry/live/",
    "tests/telemetry/watch/",
    "tests/workspace/live/test_live.py",
)
COUNTED_RUNS = 20
MAX_LATE_PASSES = 2  # of one test in the counted runs


def cache_arguments(cache: Path) -> list[str]:
    """Return pytest's arguments to record the failed tests of only this run in a folder."""
    return ["-o", f"cache_dir={cache}", "--cache-clear"]


def failed_tests(cache: Path) -> list[str]:
    """Return the tests that failed in the run whose cache this is."""
    try:
        return list(json.loads((cache / "v" / "cache" / "lastfailed").read_text()))
    except OSError:
        return []


def second_command(command: list[str], cache: Path, waiting: tuple[str, ...] = WAITING_TESTS) -> list[str] | None:
    """Return the same run with only the failed tests, one at a time; None where none or too many failed, or one that does not wait."""
    failed = failed_tests(cache)
    if not 0 < len(failed) <= MAX_SECOND_TRIES or not all(name.startswith(waiting) for name in failed):
        return None
    left_out = ("--cache-clear", "--check-report", "--numprocesses", "--dist")
    kept = [argument for argument in command if not argument.startswith(left_out)]
    return [*kept, "--last-failed"]


def late_passes_file(state: Path) -> Path:
    """Return the file of late passes, a line of JSON per run; CI names one that persists between runs."""
    return Path(os.environ.get("SPANWISE_LATE_PASSES") or state / "late_passes.jsonl")


def note_late_passes(path: Path, late: Iterable[str]) -> list[str]:
    """Add a run to the file, and return the tests that have passed late too often in the counted runs."""
    now = sorted(late)
    try:
        earlier = [json.loads(line) for line in path.read_text().splitlines() if line]
    except FileNotFoundError:
        earlier = []
    runs = [*earlier, now][-COUNTED_RUNS:]
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f"{path.name}.new")
    draft.write_text("".join(f"{json.dumps(run)}\n" for run in runs))
    draft.replace(path)
    times = Counter(name for run in runs for name in run)
    return [name for name in now if times[name] > MAX_LATE_PASSES]
