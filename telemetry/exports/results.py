"""Results of a mission's targets as rows, the input of all result files."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from inspection.geodesy import LonLat
from telemetry.exports.captures import CaptureRow


@dataclass(frozen=True, slots=True)
class ResultRow:
    """One target. `result` is a code; `result_words` and `reason` are in the reader's language. None is unknown, "" is none.

    Times are UTC datetimes. distance_m is the UAV's closest distance, altitude_relative_m its height above take-off at that moment.
    """

    number: int  # in flown order, from 1
    asset_id: int | None
    external_id: str
    asset: str
    line: str
    result: str
    result_words: str
    reason: str
    reason_at: datetime | None
    uav: str
    reached_at: datetime | None
    planned_hold_s: float | None
    held_s: float | None
    distance_m: float | None
    altitude_relative_m: float | None
    position: LonLat | None


@dataclass(frozen=True, slots=True)
class TrackPoint:
    """A position of a UAV with its heights above take-off and AMSL, as far as known."""

    at: datetime
    position: LonLat
    altitude_relative_m: float | None
    altitude_amsl_m: float | None


@dataclass(frozen=True, slots=True)
class PlannedPoint:
    position: LonLat
    altitude_relative_m: float
    altitude_amsl_m: float | None


@dataclass(frozen=True, slots=True)
class RouteLines:
    """A UAV's approved route and its track, split where nothing was received."""

    uav: str
    planned: tuple[PlannedPoint, ...]
    flown: tuple[tuple[TrackPoint, ...], ...]


@dataclass(frozen=True, slots=True)
class IncidentRow:
    at: datetime
    uav: str
    words: str
    position: LonLat | None


@dataclass(frozen=True, slots=True)
class MissionResults:
    name: str
    rows: Sequence[ResultRow]
    routes: Sequence[RouteLines]
    incidents: Sequence[IncidentRow]
    photos: Sequence[CaptureRow] = ()
