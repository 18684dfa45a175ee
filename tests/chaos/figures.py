"""What a row has to tell: a figure beside its target."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path


class TargetResult(StrEnum):
    MET = "met"
    MISSED = "MISSED"
    NOT_RUN = "not run"
    ELSEWHERE = "elsewhere"


@dataclass(frozen=True)
class Figure:
    """One line of the table."""

    row: str
    test: str
    figure: str
    target: str
    result: TargetResult

    @property
    def cells(self) -> tuple[str, str, str, str, str]:
        return (self.row, self.test, self.figure, self.target, str(self.result))


HEAD = ("row", "test", "figure", "target", "result")


def as_markdown(figures: Sequence[Figure]) -> str:
    rows = [HEAD, ("---",) * len(HEAD), *(figure.cells for figure in figures)]
    return "\n".join("| " + " | ".join(cell.replace("|", "/").replace("\n", " ") for cell in row) + " |" for row in rows)


def written(path: Path) -> list[Figure]:
    """The figures that an experiment has written, a line each; what was cut off in the middle of a line is left out."""
    found = []
    for line in path.read_text().splitlines() if path.exists() else []:
        try:
            found.append(Figure(**(reported := json.loads(line)) | {"result": TargetResult(reported["result"])}))
        except ValueError:
            continue
    return found


def write(figure: Figure, path: Path) -> None:
    with path.open("a") as lines:
        lines.write(json.dumps(asdict(figure)) + "\n")
