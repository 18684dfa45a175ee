"""Reads of estimates, always within one mission."""

from collections import defaultdict
from collections.abc import Iterable
from datetime import datetime
from typing import Any
from uuid import UUID

from django.db.models import QuerySet

from inspection.geodesy import LonLat
from missions.models import Mission
from telemetry.estimation.estimate import Ellipse
from telemetry.mission_report.estimate_quality import Compared, Estimated, EstimateQuality, Measured, compare, quality_of
from telemetry.models import PositionEstimate, TelemetryRecord

_ESTIMATED = (
    "uav_id", "estimated_for", "position", "bound_along_m", "bound_across_m", "bound_bearing_deg", "report_at", "altitude_relative_m",
    "bound_height_m",
)  # fmt: skip
_MEASURED = ("uav_id", "measured_at", "position", "altitude_relative_m", "velocity_east_mps", "velocity_north_mps")


def estimates_of_mission(
    mission: Mission,
    *,
    uav_id: int | None = None,
    estimated_from: datetime | None = None,
    estimated_before: datetime | None = None,
    is_replaced: bool | None = None,
) -> QuerySet[PositionEstimate]:
    """`estimated_before` is left out; is_replaced: by a measurement that came later."""
    found = PositionEstimate.objects.filter(mission=mission)
    if uav_id is not None:
        found = found.filter(uav=uav_id)
    if estimated_from is not None:
        found = found.filter(estimated_for__gte=estimated_from)
    if estimated_before is not None:
        found = found.filter(estimated_for__lt=estimated_before)
    if is_replaced is not None:
        found = found.filter(replaced_at__isnull=not is_replaced)
    return found


def estimate_quality_of(mission_id: UUID) -> EstimateQuality:
    """By all that was measured of the mission's UAVs, whenever it came."""
    estimated: dict[int, list[Estimated]] = defaultdict(list)
    for uav_id, *values in _rows(PositionEstimate.objects.filter(mission=mission_id).order_by("estimated_for"), _ESTIMATED):
        estimated[uav_id].append(_estimated(*values))
    measured: dict[int, list[Measured]] = defaultdict(list)
    in_time = TelemetryRecord.objects.filter(mission=mission_id, uav__in=list(estimated), is_from_future=False, position__isnull=False)
    for uav_id, *values in _rows(in_time.order_by("measured_at"), _MEASURED):
        measured[uav_id].append(_measured(*values))
    compared: list[Compared] = []
    untold = 0
    for uav_id, of_uav in estimated.items():
        found, missed = compare(of_uav, measured[uav_id])
        compared += found
        untold += missed
    return quality_of(compared, untold)


def _rows(rows: QuerySet[Any], columns: tuple[str, ...]) -> Iterable[tuple[Any, ...]]:
    return rows.values_list(*columns).iterator(chunk_size=2_000)


def _estimated(at: datetime, position: Any, *values: Any) -> Estimated:
    along_m, across_m, bearing_deg, report_at, height_m, bound_height_m = values
    report_s = None if report_at is None else report_at.timestamp()
    bound = Ellipse(along_m, across_m, bearing_deg)
    return Estimated(at.timestamp(), LonLat(position.x, position.y), bound, report_s, height_m, bound_height_m)


def _measured(at: datetime, position: Any, height_m: float | None, east_mps: float | None, north_mps: float | None) -> Measured:
    return Measured(at.timestamp(), LonLat(position.x, position.y), height_m, east_mps, north_mps)
