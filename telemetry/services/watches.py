"""Which watch estimates which UAV, and what it writes down.

A watch holds a UAV by a lease. Another may take it when the lease is out, or when it bears the same name: it is the same watch, started
again.
"""

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any
from uuid import UUID

from django.db import connection

from telemetry.estimation.estimate import Arrival, Estimate

_TAKE = """
INSERT INTO telemetry_uavwatch (uav_id, organisation_id, mission_id, holder, lease_expires_at)
SELECT uav.id, uav.organisation_id, wanted.mission, %(holder)s, now() + make_interval(secs => %(lease_s)s)
FROM unnest(%(uav_ids)s::bigint[], %(missions)s::uuid[]) AS wanted(uav, mission) JOIN missions_uav uav ON uav.id = wanted.uav
ORDER BY uav.id
ON CONFLICT (uav_id) DO UPDATE SET
    holder = excluded.holder, lease_expires_at = excluded.lease_expires_at, organisation_id = excluded.organisation_id,
    mission_id = excluded.mission_id
WHERE telemetry_uavwatch.holder IN ('', excluded.holder)
    OR split_part(telemetry_uavwatch.holder, '/', 1) = split_part(excluded.holder, '/', 1)
    OR telemetry_uavwatch.lease_expires_at IS NULL OR telemetry_uavwatch.lease_expires_at < now()
RETURNING uav_id
"""
_RENEW = """
UPDATE telemetry_uavwatch watch SET lease_expires_at = now() + make_interval(secs => %s)
FROM (SELECT uav_id FROM telemetry_uavwatch WHERE uav_id = ANY(%s) AND holder = %s ORDER BY uav_id FOR UPDATE) held
WHERE watch.uav_id = held.uav_id RETURNING watch.uav_id
"""
_RELEASE = """
UPDATE telemetry_uavwatch SET holder = '', lease_expires_at = NULL, estimated = CASE WHEN %(is_over)s THEN NULL ELSE estimated END,
    mission_id = CASE WHEN %(is_over)s THEN NULL ELSE mission_id END, version = version + 1, updated_at = now()
WHERE holder = %(holder)s AND (%(uav_ids)s::bigint[] IS NULL OR uav_id = ANY(%(uav_ids)s))
"""
_FORGET_OVER = """
UPDATE telemetry_uavwatch SET estimated = NULL, mission_id = NULL, holder = '', lease_expires_at = NULL, version = version + 1,
    updated_at = now()
WHERE mission_id IS NOT NULL AND NOT uav_id = ANY(%s) AND (lease_expires_at IS NULL OR lease_expires_at < now())
"""
_SHOW = """
UPDATE telemetry_uavwatch watch SET estimated = made.estimated, mission_id = made.mission, version = version + 1, updated_at = now()
FROM (
    SELECT made.* FROM unnest(%s::bigint[], %s::uuid[], %s::jsonb[]) AS made(uav, mission, estimated)
    JOIN telemetry_uavwatch held ON held.uav_id = made.uav AND held.holder = %s
    ORDER BY held.uav_id FOR NO KEY UPDATE OF held -- in which records are stored, too: neither locks the other out
) made
WHERE watch.uav_id = made.uav
RETURNING watch.uav_id, watch.organisation_id
"""
_REPLACE = """
UPDATE telemetry_positionestimate estimate SET replaced_at = now() FROM unnest(%s::bigint[], %s::timestamptz[]) AS report(uav, second)
WHERE estimate.uav_id = report.uav AND estimate.estimated_for = report.second AND estimate.replaced_at IS NULL
"""
_COLUMNS = {
    "uav_id": "int8", "mission_id": "uuid", "estimated_for": "timestamptz", "report_at": "timestamptz", "longitude_deg": "float8",
    "latitude_deg": "float8", "altitude_amsl_m": "float8", "altitude_relative_m": "float8", "speed_mps": "float8",
    "heading_deg": "float8", "bound_along_m": "float8", "bound_across_m": "float8", "bound_bearing_deg": "float8",
    "bound_height_m": "float8", "bound_speed_mps": "float8", "waypoint_sequence": "int4", "is_lost": "bool",
}  # fmt: skip
_STORED_AS_THEY_ARE = tuple(name for name in _COLUMNS if name not in {"longitude_deg", "latitude_deg"})
_STORE = f"""
INSERT INTO telemetry_positionestimate (position, {", ".join(_STORED_AS_THEY_ARE)})
SELECT ST_SetSRID(ST_MakePoint(longitude_deg, latitude_deg), 4326), {", ".join(_STORED_AS_THEY_ARE)}
FROM unnest({", ".join(f"%s::{kind}[]" for kind in _COLUMNS.values())}) AS made({", ".join(_COLUMNS)})
WHERE uav_id IN (SELECT id FROM missions_uav) ON CONFLICT (uav_id, estimated_for) DO NOTHING
"""  # noqa: S608 (names of columns, all from here)


def estimate_to_json(estimate: Estimate) -> dict[str, Any]:
    """Times as RFC 3339 in UTC, to a tenth of a second; metres and degrees rounded to what they can be worth."""
    bound = estimate.bound
    return {
        "at": _time(estimate.at_s),
        "report_at": _time(estimate.report_s),
        "position": [round(estimate.position.lon, 7), round(estimate.position.lat, 7)],
        "altitude_relative_m": _rounded(estimate.altitude_relative_m),
        "altitude_amsl_m": _rounded(estimate.altitude_amsl_m),
        "speed_mps": round(estimate.speed_mps, 2),
        "heading_deg": _rounded(estimate.heading_deg),
        "bound": {
            "along_m": round(bound.along_m, 1),
            "across_m": round(bound.across_m, 1),
            "bearing_deg": round(bound.bearing_deg, 1) % 360.0,
            "height_m": round(estimate.bound_height_m, 1),
            "speed_mps": round(estimate.bound_speed_mps, 2),
        },
        "is_measured": estimate.is_measured,
        "is_lost": estimate.is_lost,
        "waypoint_sequence": estimate.waypoint_sequence,
        "along_route_m": _rounded(estimate.along_route_m),
        "to_go_m": _rounded(estimate.to_go_m),
        "arrivals": [_arrival(arrival) for arrival in estimate.arrivals],
        "ends_at": _time(estimate.ends_at_s),
        "contact_expected_at": _time(estimate.contact_expected_s),
        "report_interval_s": _rounded(estimate.report_interval_s),
    }


def _arrival(arrival: Arrival) -> dict[str, Any]:
    return {
        "waypoint_sequence": arrival.waypoint_sequence,
        "target": arrival.target,
        "at": _time(arrival.at_s),
        "earliest": _time(arrival.earliest_s),
        "latest": _time(arrival.latest_s),
    }


def _time(at_s: float | None) -> str | None:
    return None if at_s is None else datetime.fromtimestamp(round(at_s, 1), UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 1)


@dataclass(frozen=True, slots=True)
class Made:
    """An estimate of one UAV; `report_at` and `estimated_for` are its own times as the database has them.

    battery: what it allows, as live pages show it; None: not known.
    """

    uav_id: int
    mission_id: UUID
    estimated_for: datetime
    report_at: datetime | None
    estimate: Estimate
    battery: dict[str, Any] | None = None


def take_watches(*, missions: dict[int, UUID], holder: str, lease_s: float) -> set[int]:
    """Those of the UAVs, given with the mission that each flies, that the watch holds from now on. holder: "name/run"."""
    uav_ids = sorted(missions)
    values = {"uav_ids": uav_ids, "missions": [missions[uav_id] for uav_id in uav_ids], "holder": holder, "lease_s": lease_s}
    return _uav_ids(_TAKE, values)


def renew_watches(*, uav_ids: Collection[int], holder: str, lease_s: float) -> set[int]:
    """Those that are still held."""
    return _uav_ids(_RENEW, [lease_s, sorted(uav_ids), holder])


def release_watches(*, holder: str, uav_ids: Collection[int] | None = None, is_over: bool = False) -> None:
    """All of the holder, or these. is_over: they fly no mission any more, and nothing is estimated of them."""
    with connection.cursor() as cursor:
        cursor.execute(_RELEASE, {"holder": holder, "is_over": is_over, "uav_ids": None if uav_ids is None else sorted(uav_ids)})


def forget_what_is_over(*, flying: Collection[int]) -> None:
    """Estimates that a watch left behind when it died, of UAVs that fly no mission by now."""
    with connection.cursor() as cursor:
        cursor.execute(_FORGET_OVER, [sorted(flying)])


def show_estimates(*, made: Sequence[Made], holder: str) -> dict[int, int]:
    """For live pages; only of UAVs that the watch still holds. Returns these with their organisations."""
    made = sorted(made, key=lambda one: one.uav_id)
    uavs, missions = [one.uav_id for one in made], [one.mission_id for one in made]
    estimates = [json.dumps(estimate_to_json(one.estimate) | {"battery": one.battery}) for one in made]
    with connection.cursor() as cursor:
        cursor.execute(_SHOW, [uavs, missions, estimates, holder])
        return dict(cursor.fetchall())


def store_estimates(*, made: Sequence[Made]) -> None:
    """Beside the log. Safe to call again: of one moment one estimate is kept, the first."""
    rows = [_row(one) for one in made]
    with connection.cursor() as cursor:
        cursor.execute(_STORE, [[row[name] for row in rows] for name in _COLUMNS])


def replace_estimates(*, reports: Sequence[tuple[int, datetime]]) -> int:
    """UAVs, and moments that estimates may speak of: a report was measured in the second before. Returns how many were replaced."""
    with connection.cursor() as cursor:
        cursor.execute(_REPLACE, [[uav_id for uav_id, _ in reports], [second for _, second in reports]])
        return cursor.rowcount


def _row(one: Made) -> dict[str, Any]:
    estimate, bound = one.estimate, one.estimate.bound
    return {
        "uav_id": one.uav_id,
        "mission_id": one.mission_id,
        "estimated_for": one.estimated_for,
        "report_at": one.report_at,
        "longitude_deg": estimate.position.lon,
        "latitude_deg": estimate.position.lat,
        "altitude_amsl_m": estimate.altitude_amsl_m,
        "altitude_relative_m": estimate.altitude_relative_m,
        "speed_mps": estimate.speed_mps,
        "heading_deg": estimate.heading_deg,
        "bound_along_m": bound.along_m,
        "bound_across_m": bound.across_m,
        "bound_bearing_deg": bound.bearing_deg,
        "bound_height_m": estimate.bound_height_m,
        "bound_speed_mps": estimate.bound_speed_mps,
        "waypoint_sequence": estimate.waypoint_sequence,
        "is_lost": estimate.is_lost,
    }


def _uav_ids(statement: str, values: Any) -> set[int]:
    with connection.cursor() as cursor:
        cursor.execute(statement, values)
        return {uav_id for (uav_id,) in cursor.fetchall()}
