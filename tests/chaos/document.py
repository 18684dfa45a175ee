"""The table in docs/reliability.md: what was run replaces the lines of its rows, with the day and the machine in each."""

import os
import platform
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from scripts.places import PROJECT_DIR
from tests.chaos.figures import HEAD, Figure

DOCUMENT = PROJECT_DIR / "docs" / "reliability.md"
BEGINS, ENDS = "<!-- table of ./check --chaos --write: begins -->", "<!-- ends -->"


def put_in_document(figures: Sequence[Figure], *, seed: int, at: datetime, order: Sequence[str], document: Path = DOCUMENT) -> None:
    text = document.read_text()
    before, _, rest = text.partition(BEGINS)
    old, _, after = rest.partition(ENDS)
    run = {figure.row for figure in figures}
    kept = [line for line in old.splitlines() if line.startswith("| ") and _row(line) in order and _row(line) not in run]
    reported = (
        f"{at:%Y-%m-%d}, seed {seed}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the end, Python {platform.python_version()}"
    )
    new = [_line((*figure.cells, reported)) for figure in figures]
    lines = sorted([*kept, *new], key=lambda line: order.index(_row(line)))
    table = "\n".join([_line((*HEAD, "run")), _line(("---",) * (len(HEAD) + 1)), *lines])
    document.write_text(f"{before}{BEGINS}\n{table}\n{ENDS}{after}")


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "/").replace("\n", " ") for cell in cells) + " |"


def _row(line: str) -> str:
    return line.split("|")[1].strip()
