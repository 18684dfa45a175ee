"""The newest values of each UAV for live pages, written with the log.

Values come in groups, and a report may lack some. Each group is stored with its time of measurement, so a report without a position keeps
the last position with its age. A late report only replaces older values.
"""

import json
import math
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime
from typing import Any, Protocol

from django.db import connection

from mavlink.decoding.measurement import Measurement


class LatestReport(Protocol):
    """One stored report of a UAV."""

    @property
    def uav_id(self) -> int: ...
    @property
    def measured_at(self) -> datetime: ...
    @property
    def received_at(self) -> datetime: ...
    @property
    def measurement(self) -> Measurement: ...


# A group is only replaced by a newer one. Rows are locked in the order of their UAVs.
_IS_NEWER = """(watch.measured -> key ->> 'measured_at' COLLATE "C" >= value ->> 'measured_at') IS NOT TRUE"""
NOTE = f"""
INSERT INTO telemetry_uavwatch AS watch (uav_id, organisation_id, holder, measured)
SELECT uav.id, uav.organisation_id, '', reported.measured
FROM unnest(%s::bigint[], %s::jsonb[]) AS reported(uav_id, measured) JOIN missions_uav uav ON uav.id = reported.uav_id
ORDER BY uav.id
ON CONFLICT (uav_id) DO UPDATE SET version = watch.version + 1, updated_at = statement_timestamp(),
    measured = coalesce(watch.measured, '{{}}')
        || (SELECT jsonb_object_agg(key, value) FROM jsonb_each(excluded.measured) WHERE {_IS_NEWER})
WHERE EXISTS (SELECT FROM jsonb_each(excluded.measured) WHERE {_IS_NEWER})
"""  # noqa: S608 (only inserts the constant above)


def note_latest(reports: Iterable[LatestReport]) -> None:
    """Store the newest values of reports that are not from the future. Accepts any order; idempotent."""
    newest: dict[int, dict[str, dict[str, Any]]] = {}
    for report in sorted(reports, key=lambda report: report.measured_at, reverse=True):
        known = newest.setdefault(report.uav_id, {})
        if len(known) < len(_READ):
            _add_what_is_missing(known, report)
    if not newest:
        return
    with connection.cursor() as cursor:
        cursor.execute(NOTE, [list(newest), [json.dumps(groups) for groups in newest.values()]])


def _add_what_is_missing(known: dict[str, dict[str, Any]], report: LatestReport) -> None:
    """Add missing groups, with times as text of fixed length, so that their order as text is that in time."""
    for name, read in _READ.items():
        if name not in known and (values := read(report)) is not None:
            known[name] = {"measured_at": time_text(report.measured_at), **values}


def time_text(at: datetime) -> str:
    return at.astimezone(UTC).isoformat(timespec="microseconds")


def _report(report: LatestReport) -> dict[str, Any]:
    return {"received_at": time_text(report.received_at)}


def _position(report: LatestReport) -> dict[str, Any] | None:
    reported = report.measurement
    return None if reported.longitude_deg is None else {"position": [reported.longitude_deg, reported.latitude_deg]}


def _speed(report: LatestReport) -> dict[str, Any] | None:
    reported = report.measurement
    if reported.velocity_north_mps is None or reported.velocity_east_mps is None:
        return None
    climb_mps = None if reported.velocity_down_mps is None else -reported.velocity_down_mps
    return {"speed_mps": math.hypot(reported.velocity_north_mps, reported.velocity_east_mps), "climb_mps": climb_mps}


def _wind(report: LatestReport) -> dict[str, Any] | None:
    """Return where the wind blows from, as pilots expect; the log stores where the air moves to."""
    north_mps, east_mps = report.measurement.wind_north_mps, report.measurement.wind_east_mps
    if north_mps is None or east_mps is None:
        return None
    return {"wind_speed_mps": math.hypot(north_mps, east_mps), "wind_from_deg": math.degrees(math.atan2(-east_mps, -north_mps)) % 360.0}


def _as_reported(fields: Sequence[str]) -> Callable[[LatestReport], dict[str, Any] | None]:
    """Return a reader of fields that are stored together if any is known."""

    def read(report: LatestReport) -> dict[str, Any] | None:
        values = {field: getattr(report.measurement, field) for field in fields}
        return values if any(value not in (None, "") for value in values.values()) else None

    return read


_READ: dict[str, Callable[[LatestReport], dict[str, Any] | None]] = {
    "report": _report,
    "position": _position,
    "speed": _speed,
    "wind": _wind,
    "height": _as_reported(("altitude_relative_m", "altitude_amsl_m", "altitude_agl_m")),
    "attitude": _as_reported(("heading_deg", "roll_deg", "pitch_deg")),
    "battery": _as_reported(("battery_percent", "battery_v", "battery_a")),
    "state": _as_reported(("mode", "is_armed", "is_in_air")),
    "link": _as_reported(("link_quality_percent",)),
    "gps": _as_reported(("gps_fix", "satellites", "hdop")),
    "waypoint": _as_reported(("waypoint_sequence",)),
}
