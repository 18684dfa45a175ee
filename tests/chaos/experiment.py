"""What every experiment begins with and how it tells its figures."""

import argparse
import random
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from scripts.places import CannotStart
from tests.chaos.figures import Figure, TargetResult, write


@dataclass
class Course:
    """One run of an experiment. `chance` is the only randomness that decides what is broken and when."""

    row: str
    seed: int
    is_short: bool
    written_to: Path | None
    figures: list[Figure] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.chance = random.Random(self.seed)

    def record(self, test: str, figure: str, target: str, is_met: bool) -> None:
        self._put(Figure(self.row, test, figure, target, TargetResult.MET if is_met else TargetResult.MISSED))

    def leave_out(self, test: str, reason: str, target: str) -> None:
        """Something that this machine cannot show."""
        self._put(Figure(self.row, test, reason, target, TargetResult.NOT_RUN))

    def _put(self, figure: Figure) -> None:
        self.figures.append(figure)
        print(" | ".join(figure.cells), flush=True)
        if self.written_to is not None:
            write(figure, self.written_to)


def main(do: Callable[[Course], None]) -> None:
    """Run the experiment as the program that it is; ends with 1 where a target was missed."""
    parser = argparse.ArgumentParser(description=sys.modules["__main__"].__doc__)
    parser.add_argument("--row", default="")
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--figures", type=Path)
    options = parser.parse_args()
    course = Course(options.row, options.seed, options.short, options.figures)
    try:
        do(course)
    except CannotStart as error:
        course.record("could not begin", str(error), "begins", False)
    sys.exit(1 if any(figure.result == TargetResult.MISSED for figure in course.figures) else 0)


def percentile(values: list[float], share: float) -> float:
    """Of at least one value; the nearest that is not below the share."""
    ordered = sorted(values)
    return ordered[min(int(len(ordered) * share), len(ordered) - 1)]
