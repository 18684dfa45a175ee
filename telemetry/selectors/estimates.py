"""Reads of estimates, always within one mission."""

from collections.abc import Iterator
from datetime import datetime
from uuid import UUID

from django.db.models import QuerySet

from inspection.geodesy import LonLat
from missions.models import Mission
from telemetry.estimation.estimate import Ellipse
from telemetry.mission_report.estimate_quality import Compared, Estimated, EstimateQuality, MeasuredError, compare, quality_of
from telemetry.models import PositionEstimate, TelemetryRecord
from telemetry.selectors.columns import latitude, longitude, unix_s

ROWS_AT_ONCE = 5_000


def estimates_of_mission(
    mission: Mission,
    *,
    uav_id: int | None = None,
    estimated_from: datetime | None = None,
    estimated_before: datetime | None = None,
    is_replaced: bool | None = None,
) -> QuerySet[PositionEstimate]:
    """Return the estimates that match. `estimated_before` is exclusive; is_replaced: by a later measurement."""
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
    """Return the quality by all measurements of the mission's UAVs, late ones included. Reads one UAV at a time into memory."""
    compared: list[Compared] = []
    untold = 0
    for uav_id in PositionEstimate.objects.filter(mission=mission_id).order_by("uav").values_list("uav", flat=True).distinct():
        found, missed = compare(_estimated(mission_id, uav_id), _measured(mission_id, uav_id))
        compared += found
        untold += missed
    return quality_of(compared, untold)


def _estimated(mission_id: UUID, uav_id: int) -> Iterator[Estimated]:
    rows = PositionEstimate.objects.filter(mission=mission_id, uav=uav_id).order_by("estimated_for").values_list(
        unix_s("estimated_for"), longitude(), latitude(), unix_s("report_at"), "bound_along_m", "bound_across_m", "bound_bearing_deg",
        "altitude_relative_m", "bound_height_m",
    )  # fmt: skip
    for at_s, lon, lat, report_s, along_m, across_m, bearing_deg, *heights_m in rows.iterator(chunk_size=ROWS_AT_ONCE):
        yield Estimated(at_s, LonLat(lon, lat), Ellipse(along_m, across_m, bearing_deg), report_s, *heights_m)


def _measured(mission_id: UUID, uav_id: int) -> list[MeasuredError]:
    in_time = TelemetryRecord.objects.filter(mission=mission_id, uav=uav_id, is_from_future=False, position__isnull=False)
    rows = in_time.order_by("measured_at").values_list(
        unix_s("measured_at"), longitude(), latitude(), "altitude_relative_m", "velocity_east_mps", "velocity_north_mps"
    )
    return [MeasuredError(at_s, LonLat(lon, lat), *reported) for at_s, lon, lat, *reported in rows.iterator(chunk_size=ROWS_AT_ONCE)]
