"""The newest that is known of each UAV, for live pages, kept beside the log and written with it.

What a UAV tells comes in groups, and not each report has all of them: each group is kept with the time at which it was measured, so that a
report without a position leaves the last position there, with its own age. What comes late fills in only what was older still.
"""

import json
import math
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import Any, Protocol

from django.db import connection

from telemetry.decoding.measurement import Measurement

REPORT = "report"  # the group of the newest report as such: when it was measured and received
FIELDS = {
    "height": ("altitude_relative_m", "altitude_amsl_m", "altitude_agl_m"),
    "attitude": ("heading_deg", "roll_deg", "pitch_deg"),
    "battery": ("battery_percent", "battery_v", "battery_a"),
    "state": ("mode", "is_armed", "is_in_air"),
    "link": ("link_quality_percent",),
    "gps": ("gps_fix", "satellites", "hdop"),
    "waypoint": ("waypoint_sequence",),
}


class Report(Protocol):
    """One stored report of a UAV."""

    @property
    def uav_id(self) -> int: ...
    @property
    def measured_at(self) -> datetime: ...
    @property
    def received_at(self) -> datetime: ...
    @property
    def measurement(self) -> Measurement: ...


# A group gives way to a newer one only. Rows are held in the order of their UAVs.
_IS_NEWER = """(watch.measured -> key ->> 'measured_at' COLLATE "C" >= value ->> 'measured_at') IS NOT TRUE"""
NOTE = f"""
INSERT INTO telemetry_uavwatch AS watch (uav_id, organisation_id, holder, measured)
SELECT uav.id, uav.organisation_id, '', told.measured
FROM unnest(%s::bigint[], %s::jsonb[]) AS told(uav_id, measured) JOIN missions_uav uav ON uav.id = told.uav_id
ORDER BY uav.id
ON CONFLICT (uav_id) DO UPDATE SET version = watch.version + 1, updated_at = statement_timestamp(),
    measured = coalesce(watch.measured, '{{}}')
        || (SELECT jsonb_object_agg(key, value) FROM jsonb_each(excluded.measured) WHERE {_IS_NEWER})
WHERE EXISTS (SELECT FROM jsonb_each(excluded.measured) WHERE {_IS_NEWER})
"""  # noqa: S608 (nothing is put in but the line above)


def note_latest(reports: Iterable[Report]) -> None:
    """Of reports that are not from the future; in any order, and again."""
    newest: dict[int, dict[str, dict[str, Any]]] = {}
    for report in sorted(reports, key=lambda report: report.measured_at):
        newest.setdefault(report.uav_id, {}).update(groups_of(report))
    if not newest:
        return
    with connection.cursor() as cursor:
        cursor.execute(NOTE, [list(newest), [json.dumps(groups) for groups in newest.values()]])


def groups_of(report: Report) -> dict[str, dict[str, Any]]:
    """What the report tells, each group with its time as text of one length, so that texts compare as times do."""
    measured_at = time_text(report.measured_at)
    told = report.measurement
    values: dict[str, dict[str, Any]] = {
        name: {field: getattr(told, field) for field in fields} for name, fields in FIELDS.items() if _is_told(told, fields)
    }
    if told.longitude_deg is not None and told.latitude_deg is not None:
        values["position"] = {"position": [told.longitude_deg, told.latitude_deg]}
    if told.velocity_north_mps is not None and told.velocity_east_mps is not None:
        climb_mps = None if told.velocity_down_mps is None else -told.velocity_down_mps
        values["speed"] = {"speed_mps": math.hypot(told.velocity_north_mps, told.velocity_east_mps), "climb_mps": climb_mps}
    if told.wind_north_mps is not None and told.wind_east_mps is not None:
        values["wind"] = _wind(told.wind_north_mps, told.wind_east_mps)
    values[REPORT] = {"received_at": time_text(report.received_at)}
    return {name: {"measured_at": measured_at, **group} for name, group in values.items()}


def time_text(at: datetime) -> str:
    return at.astimezone(UTC).isoformat(timespec="microseconds")


def _is_told(told: Measurement, fields: Sequence[str]) -> bool:
    return any(getattr(told, field) not in (None, "") for field in fields)


def _wind(north_mps: float, east_mps: float) -> dict[str, float]:
    """Pilots are told where it comes from; the log keeps where the air goes."""
    return {"wind_speed_mps": math.hypot(north_mps, east_mps), "wind_from_deg": math.degrees(math.atan2(-east_mps, -north_mps)) % 360.0}
