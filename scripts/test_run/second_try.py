"""The second try of tests that wait for pages, programs and radio: when a few of them fail beside everything else, they run again alone.

On a machine with other work a page or a program can be late for reasons of its own. What fails twice has failed, and so has a run in
which many tests fail. What passed only the second time is named and kept in a file, and the third time in 20 runs is a failure.
Tests that compute have no second try: what they find once is found.
"""

import json
import os
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

MAX_SECOND_TRIES = 5
WAITING_TESTS = (  # for other processes, more than they compute
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
    """For pytest: in this folder it keeps the names of what failed, and only those of this run."""
    return ["-o", f"cache_dir={cache}", "--cache-clear"]


def failed_tests(cache: Path) -> list[str]:
    """Names of the tests that failed in the run whose cache this is."""
    try:
        return list(json.loads((cache / "v" / "cache" / "lastfailed").read_text()))
    except OSError:
        return []


def second_command(command: list[str], cache: Path, waiting: tuple[str, ...] = WAITING_TESTS) -> list[str] | None:
    """The same run with the failed tests alone, one at a time; None where nothing failed, too much did, or a test that does not wait."""
    failed = failed_tests(cache)
    if not 0 < len(failed) <= MAX_SECOND_TRIES or not all(name.startswith(waiting) for name in failed):
        return None
    left_out = ("--cache-clear", "--check-report", "--numprocesses", "--dist")
    kept = [argument for argument in command if not argument.startswith(left_out)]
    return [*kept, "--last-failed"]


def late_passes_file(state: Path) -> Path:
    """File of the late passes, a line of JSON for each run; CI names one that it keeps from run to run."""
    return Path(os.environ.get("SPANWISE_LATE_PASSES") or state / "late_passes.jsonl")


def note_late_passes(path: Path, late: Iterable[str]) -> list[str]:
    """Add a run to the file, and return the tests that now have passed late too often in the counted runs."""
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
