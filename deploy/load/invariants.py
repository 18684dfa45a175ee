"""What must be true after a working day, whatever was killed on the way: looked at in SQL, and nothing is written.

    python deploy/load/invariants.py --day FOLDER        with the DATABASE_URL of the installation; prints a table, 1 where one is violated

The first half holds the clients' book (FOLDER/book.jsonl) against the database: what was acknowledged is there, once. The second half
looks at the database alone. It wants to be run when the day is over and what was under way has settled: `--settle-s` waits for that, as
long as jobs or commands are open.
"""

import argparse
import os
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import django

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.db import connection, transaction  # noqa: E402 (Django first)

from benchmarks.report import table  # noqa: E402
from deploy.load.day import kept_promises, sound_books  # noqa: E402
from deploy.load.day.book import lines  # noqa: E402
from deploy.load.day.promises import Promises, promises_of  # noqa: E402

SHOWN = 5


@dataclass(frozen=True)
class InvariantCheck:
    """One invariant and what violates it, in words."""

    name: str
    violations: list[str]

    @property
    def verdict(self) -> str:
        return f"VIOLATED: {len(self.violations)}" if self.violations else "holds"


def check_invariants(promised: Promises) -> list[InvariantCheck]:
    """Every invariant, in one view of the database that changes nothing. Not inside a transaction."""
    with transaction.atomic():
        with connection.cursor() as cursor:
            cursor.execute("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ READ ONLY")
        return check_invariants_here(promised)


def check_invariants_here(promised: Promises) -> list[InvariantCheck]:
    """The same in the transaction that is open."""
    checks: list[tuple[str, Callable[[], list[str]]]] = [
        *((name, lambda check=check: check(promised)) for name, check in kept_promises.CHECKS.items()),
        *sound_books.CHECKS.items(),
    ]
    return [InvariantCheck(name, check()) for name, check in checks]


def settle(patience_s: float) -> None:
    """Until no job and no command of a UAV that is heard is open, or the patience is over."""
    until_s = time.monotonic() + patience_s
    while time.monotonic() < until_s:
        [(jobs,)] = kept_promises.rows("SELECT count(*) FROM workspace_job WHERE state IN ('queued', 'running')")
        if not jobs:
            return
        time.sleep(1.0)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--day", type=Path, required=True, help="folder with the book")
    parser.add_argument("--settle-s", type=float, default=120.0)
    options = parser.parse_args()
    settle(options.settle_s)
    promised = promises_of(lines(options.day))
    looked = check_invariants(promised)
    print(table(["invariant", "verdict"], [[one.name, one.verdict] for one in looked]))
    print(
        f"\n{promised.count:,} acknowledged items; {promised.retried} tries that failed and were made again, "
        f"{len(promised.unanswered)} given up; {promised.live_messages:,} words to live pages; "
        + "; ".join(f"{name}: {statistics.median(took):.1f} s, at most {max(took):.1f}" for name, took in promised.seen_s.items())
    )
    for one in looked:
        for words in one.violations[:SHOWN]:
            print(f"{one.name}: {words}")
    return 1 if any(one.violations for one in looked) else 0


if __name__ == "__main__":
    sys.exit(main())
