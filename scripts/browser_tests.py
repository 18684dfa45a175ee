"""The browser tests of one lane. The few that fail are run a second time: a page on a busy machine can be late for reasons of its own.

python -m scripts.browser_tests LANE [PYTEST ARGUMENT...]

What fails twice has failed, and so has a run in which many tests fail. What passed only the second time is named in the output.
"""

import json
import os
import sys
from pathlib import Path

import pytest

from config.private_servers import state_directory

MOST_SECOND_TRIES = 3


def failed_tests(cache: Path) -> list[str]:
    """Names of the tests that failed in the run whose cache this is."""
    try:
        return list(json.loads((cache / "v" / "cache" / "lastfailed").read_text()))
    except OSError:
        return []


def main(lane: str, arguments: list[str]) -> int:
    cache = state_directory() / "check" / f"pytest-{lane}"
    command = [*arguments, "-o", f"cache_dir={cache}"]
    code = pytest.main([*command, "--cache-clear"])
    failed = failed_tests(cache)
    if code == pytest.ExitCode.TESTS_FAILED and 0 < len(failed) <= MOST_SECOND_TRIES:
        print("\nA second time: " + ", ".join(failed), flush=True)
        # In place of this process, so that signals of ./check still reach it.
        os.execv(sys.executable, [sys.executable, "-m", "pytest", *command, "--last-failed"])  # noqa: S606
    return int(code)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
