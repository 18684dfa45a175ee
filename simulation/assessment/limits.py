"""Limits of the assessment. Each has a source, shown beside the values."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any

from planning.rules import FlightRules, SeparationRules


@dataclass(frozen=True)
class AssessmentLimits:
    """`..._warn_...` are limits for a warning, `..._fail_...` for a fail."""

    waypoint_warn_m: float = 2.0
    waypoint_fail_m: float = 10.0
    hold_slack_s: float = 3.0
    across_warn_m: float = 3.0
    across_fail_m: float = 10.0
    height_warn_m: float = 3.0
    height_fail_m: float = 10.0
    reserve_spare_percent: float = 5.0
    late_warn_s: float = 60.0
    zone_beside_m: float = 10.0
    zone_height_m: float = 8.0
    obstacle_warn_m: float = 10.0
    obstacle_fail_m: float = 5.0
    ground_warn_m: float = 10.0
    ground_fail_m: float = 5.0
    photo_ground_warn_m: float = 3.0
    photo_ground_fail_m: float = 1.5
    apart_fail_m: float = 10.0
    apart_warn_beside_m: float = 30.0
    apart_warn_height_m: float = 15.0
    column_m: float = 15.0

    @classmethod
    def of(cls, flight: FlightRules, separation: SeparationRules, *, zone_beside_m: float, zone_height_m: float) -> "AssessmentLimits":
        """Return the limits by the settings, so that a rehearsal is assessed by the rules of its plan."""
        return cls(
            late_warn_s=separation.time_s,
            zone_beside_m=max(zone_beside_m - TRACKING_M, 0.0),
            zone_height_m=max(zone_height_m - TRACKING_M, 0.0),
            obstacle_warn_m=max(flight.clearance_m - REPORTED_SHORT_M, cls.obstacle_fail_m),
            ground_warn_m=max(flight.clearance_m - REPORTED_SHORT_M, cls.ground_fail_m),
            apart_warn_beside_m=separation.lateral_m,
            apart_warn_height_m=separation.vertical_m,
        )


TRACKING_M = 2.0  # deviation of a UAV from its line in simulated turbulence: the tolerance of the flight model
REPORTED_SHORT_M = 5.0  # by which a flown line may fall short of a planned clearance: tracking, and 2 m of simplification in plans
SOURCES: Mapping[str, str] = {
    "waypoint_warn_m": "acceptance radius of the simulated autopilot",
    "waypoint_fail_m": "PX4, NAV_ACC_RAD, default",
    "hold_slack_s": "slowing down and setting out",
    "across_warn_m": "bar of the flight model with gusts of 2 m/s",
    "across_fail_m": "a third of the distance that UAVs are kept apart",
    "height_warn_m": "bar of the flight model with gusts of 2 m/s",
    "height_fail_m": "height margin from zones",
    "reserve_spare_percent": "doubt of a battery's gauge",
    "late_warn_s": "SPANWISE_SEPARATION_TIME_S",
    "zone_beside_m": "SPANWISE_ZONE_CLEARANCE_M less 2 m of tracking",
    "zone_height_m": "SPANWISE_ZONE_HEIGHT_MARGIN_M less 2 m of tracking",
    "obstacle_warn_m": "SPANWISE_CLEARANCE_M less 5 m",
    "obstacle_fail_m": "arms of a tower beside its middle",
    "ground_warn_m": "SPANWISE_CLEARANCE_M less 5 m",
    "ground_fail_m": "trees, and errors of terrain models",
    "photo_ground_warn_m": "usual least height of photos less 1 m",
    "photo_ground_fail_m": "errors of terrain models",
    "apart_fail_m": "errors of two satellite positions",
    "apart_warn_beside_m": "SPANWISE_SEPARATION_LATERAL_M",
    "apart_warn_height_m": "SPANWISE_SEPARATION_VERTICAL_M",
    "column_m": "where a UAV takes off and lands is its operator's choice",
}


def limits_to_json(limits: AssessmentLimits) -> dict[str, dict[str, float | str]]:
    """Return the limits by name, each with its value and source."""
    return {name: {"value": value, "source": SOURCES[name]} for name, value in asdict(limits).items()}


class Level(StrEnum):
    PASS = "pass"  # noqa: S105 - no password
    WARNINGS = "warnings"
    FAIL = "fail"


SEVERITY = {Level.PASS: 0, Level.WARNINGS: 1, Level.FAIL: 2}
Fact = float | int | str | dict[str, Any] | None
Facts = dict[str, Fact]


@dataclass(frozen=True)
class AssessmentFinding:
    """A reason for a warning or a fail. `code` selects the sentence into which `facts` are inserted.

    uav: the UAV's place in the mission; target: the target's place in the operator's list, from 0, if it concerns one.
    """

    level: Level
    code: str
    uav: int
    target: int | None = None
    facts: Mapping[str, Fact] = field(default_factory=dict)


def worst(levels: Iterable[Level]) -> Level:
    """Return the worst level; a pass without findings."""
    return max(levels, key=SEVERITY.__getitem__, default=Level.PASS)


def level_of(findings: Iterable[AssessmentFinding]) -> Level:
    return worst(finding.level for finding in findings)
