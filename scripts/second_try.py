"""The second try of tests that wait for pages, programs and radio: when a few of them fail beside everything else, they run again alone.

On a machine with other work a page or a program can be late for reasons of its own. What fails twice has failed, and so has a run in
which many tests fail. What passed only the second time is named. Tests that compute have no second try: what they find once is found.
"""

import json
from pathlib import Path

MOST_SECOND_TRIES = 5


def cache_arguments(cache: Path) -> list[str]:
    """For pytest: in this folder it keeps the names of what failed, and only those of this run."""
    return ["-o", f"cache_dir={cache}", "--cache-clear"]


def failed_tests(cache: Path) -> list[str]:
    """Names of the tests that failed in the run whose cache this is."""
    try:
        return list(json.loads((cache / "v" / "cache" / "lastfailed").read_text()))
    except OSError:
        return []


def second_command(command: list[str], cache: Path) -> list[str] | None:
    """The same run with the failed tests alone; None where nothing failed or too much did."""
    if not 0 < len(failed_tests(cache)) <= MOST_SECOND_TRIES:
        return None
    return [*(argument for argument in command if argument != "--cache-clear"), "--last-failed"]
