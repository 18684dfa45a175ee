"""What a verdict is made of: findings, each with a level, and the level of all of them together."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum


class Level(StrEnum):
    PASS = "pass"  # noqa: S105 - no password
    WARNINGS = "warnings"
    FAIL = "fail"


SEVERITY = {Level.PASS: 0, Level.WARNINGS: 1, Level.FAIL: 2}
Fact = float | int | str | None
Facts = dict[str, Fact]


@dataclass(frozen=True)
class Finding:
    """One thing that speaks against a flight. `code` names the sentence that `facts` are put into.

    uav: the UAV's place in the mission; target: the target's place in the operator's list, from 0, where it is about one.
    """

    level: Level
    code: str
    uav: int
    target: int | None = None
    facts: Mapping[str, Fact] = field(default_factory=dict)


def worst(levels: Iterable[Level]) -> Level:
    """The level of all of them together; nothing found is a pass."""
    return max(levels, key=SEVERITY.__getitem__, default=Level.PASS)


def level_of(findings: Iterable[Finding]) -> Level:
    return worst(finding.level for finding in findings)
