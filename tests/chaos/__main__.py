"""./check --chaos: runs rows of the fault table, tells test, figure, target and result, and ends with 1 where a target is missed.

    ./check --chaos                    every row
    ./check --chaos R5 S9              these rows
    ./check --chaos --list             the rows, with the minutes that each takes on 2 cores
    ./check --chaos --seed 12          another order and other moments of what is killed (11); rows that are tests have seeds of their own
    ./check --chaos --short            few kills and short loads: whether it works, not how well
    ./check --chaos --write            the table into docs/reliability.md; rows that were not run keep their lines

python -m tests.chaos [OPTION…] [ROW…]
"""

import argparse
import os
import sys
import time
from collections.abc import Sequence
from datetime import UTC, datetime

from config.private_servers import state_directory
from scripts.check import private_servers
from scripts.places import CannotStart
from tests.chaos.document import put_in_document
from tests.chaos.fault_table import ROWS
from tests.chaos.figures import Figure, TargetResult, as_markdown
from tests.chaos.rows import Elsewhere, Row, Tests
from tests.chaos.running import Settings, figures_of

SEED = 11


def _parsed(arguments: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="./check --chaos", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", metavar="ROW")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args(arguments)
    known = {row.id for row in ROWS}
    if unknown := [name for name in options.rows if name.upper() not in known]:
        parser.error(f"no such row: {', '.join(unknown)}")
    if options.short and options.write:
        parser.error("a short run is no result to be written down")
    return options


def _list(rows: Sequence[Row]) -> None:
    for row in rows:
        print(f"{row.id:4} {row.minutes:5.1f} min  {row.what}")
    print(f"     {sum(row.minutes for row in rows):5.1f} min  in all, on 2 cores with nothing beside it")


def _run(rows: Sequence[Row], settings: Settings) -> tuple[list[Figure], dict[str, float]]:
    figures: list[Figure] = []
    minutes: dict[str, float] = {}
    for row in rows:
        print(f"\n── {row.id} {row.what}", flush=True)
        began_s = time.monotonic()
        for figure in figures_of(row, settings):
            print(" | ".join(figure.cells), flush=True)
            figures.append(figure)
        minutes[row.id] = (time.monotonic() - began_s) / 60
    return figures, minutes


def main(arguments: Sequence[str]) -> int:
    options = _parsed(arguments)
    wanted = {name.upper() for name in options.rows}
    rows = [row for row in ROWS if not wanted or row.id in wanted]
    if options.list:
        _list(rows)
        return 0
    begins_at = datetime.now(UTC)
    print(f"seed {options.seed}; {begins_at:%Y-%m-%d %H:%M} UTC; {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}", flush=True)
    try:
        if any(isinstance(part, Tests) for row in rows for part in row.parts):
            with private_servers(state_directory() / "check") as environment:
                figures, minutes = _run(rows, Settings(options.seed, options.short, environment))
        else:
            figures, minutes = _run(rows, Settings(options.seed, options.short, {}))
    except CannotStart as error:
        print(f"The servers for the tests could not start: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    print(f"\nseed {options.seed}\n{as_markdown(figures)}")
    for name, taken in minutes.items():
        if not all(isinstance(part, Elsewhere) for row in rows if row.id == name for part in row.parts):
            print(f"{name}: {taken:.1f} min")
    if options.write:
        put_in_document(figures, seed=options.seed, at=begins_at, order=[row.id for row in ROWS])
    return 1 if any(figure.result == TargetResult.MISSED for figure in figures) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
