"""What a row of the fault table is made of: tests of the house, experiments on the shipped programs, or where else it is shown."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Tests:
    """Tests that pytest runs, those marked long among them. Where a test records the property `figure`, that is told, too.

    `figure` may have {passed} and {all} in it.
    """

    __test__ = False  # nothing for pytest to collect

    test: str
    target: str
    nodes: tuple[str, ...]
    figure: str = "{passed} of {all}"
    select: str = ""  # pytest's -k


@dataclass(frozen=True)
class Experiment:
    """A module of tests.chaos.experiments, run as a program of its own; it says its tests, figures and targets itself."""

    test: str
    module: str
    target: str
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True)
class Elsewhere:
    """What one command on one machine does not show, or what another command does."""

    test: str
    target: str
    where: str


Part = Tests | Experiment | Elsewhere


@dataclass(frozen=True)
class Row:
    id: str
    what: str
    minutes: float  # on 2 cores with nothing beside it
    parts: tuple[Part, ...] = field(default=())

    @property
    def limit_s(self) -> float:
        """After which it is stopped and counts as missed: a machine may be four times as slow."""
        return 300.0 + 4 * 60 * self.minutes
