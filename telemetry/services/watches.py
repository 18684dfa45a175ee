"""Leases of UAVs by estimators, and the estimates that these store.

Another estimator may take a UAV when the lease has expired. One with the same name may take it before: it is the same one, restarted.
"""

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any
from uuid import UUID

from django.db import connection, transaction
from django.db.models import F
from django.db.models.functions import Now

from telemetry.estimation.estimate import Arrival, Estimate
from telemetry.models import UavWatch
from workspace.leases import is_free, is_free_for, release, renew, take

_ADD = """
INSERT INTO telemetry_uavwatch (uav_id, organisation_id, holder)
SELECT uav.id, uav.organisation_id, '' FROM missions_uav uav WHERE uav.id = ANY(%s) ORDER BY uav.id ON CONFLICT (uav_id) DO NOTHING
"""
_SET_MISSIONS = """
UPDATE telemetry_uavwatch watch SET mission_id = wanted.mission, organisation_id = uav.organisation_id
FROM unnest(%s::bigint[], %s::uuid[]) AS wanted(uav, mission) JOIN missions_uav uav ON uav.id = wanted.uav WHERE watch.uav_id = uav.id
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
_CHANGED: dict[str, Any] = {"holder": "", "version": F("version") + 1, "updated_at": Now()}
_IS_OVER: dict[str, Any] = {"estimated": None, "mission": None}
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
"""  # noqa: S608 (column names, all from here)


def estimate_to_json(estimate: Estimate) -> dict[str, Any]:
    """Return the estimate with times as RFC 3339 in UTC to 0.1 s, and values rounded to their precision."""
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
    """An estimate of one UAV; `report_at` and `estimated_for` are database times.

    battery: its forecast for live pages; None: unknown.
    """

    uav_id: int
    mission_id: UUID
    estimated_for: datetime
    report_at: datetime | None
    estimate: Estimate
    battery: dict[str, Any] | None = None


def take_watches(*, missions: dict[int, UUID], holder: str, lease_s: float) -> set[int]:
    """Return those of the UAVs, given with their missions, that the estimator now holds. holder: "name/run"."""
    with transaction.atomic():
        with connection.cursor() as cursor:
            cursor.execute(_ADD, [sorted(missions)])
        may_take = UavWatch.objects.filter(is_free_for(holder, lease_s=lease_s), uav__in=missions)
        taken = [watch.uav_id for watch in take(may_take, holder=holder, lease_s=lease_s)]
        if taken:
            with connection.cursor() as cursor:
                cursor.execute(_SET_MISSIONS, [taken, [missions[uav_id] for uav_id in taken]])
    return set(taken)


def renew_watches(*, uav_ids: Collection[int], holder: str, lease_s: float) -> set[int]:
    """Return the UAVs still held."""
    return set(renew(UavWatch.objects.filter(uav__in=uav_ids, holder=holder), lease_s=lease_s))


def release_watches(*, holder: str, uav_ids: Collection[int] | None = None, is_over: bool = False) -> None:
    """Release all UAVs of the holder, or these. is_over: they fly no mission any more, and their estimates are removed."""
    held = UavWatch.objects.filter(holder=holder)
    if uav_ids is not None:
        held = held.filter(uav__in=uav_ids)
    release(held, **_CHANGED, **(_IS_OVER if is_over else {}))


def forget_what_is_over(*, flying: Collection[int]) -> None:
    """Remove estimates left by a failed estimator for UAVs that fly no mission now."""
    release(UavWatch.objects.filter(is_free(), mission__isnull=False).exclude(uav__in=flying), **_CHANGED, **_IS_OVER)


def show_estimates(*, made: Sequence[Made], holder: str) -> dict[int, int]:
    """Store the estimates for live pages, of UAVs still held. Returns these with their organisations."""
    made = sorted(made, key=lambda one: one.uav_id)
    uavs, missions = [one.uav_id for one in made], [one.mission_id for one in made]
    estimates = [json.dumps(estimate_to_json(one.estimate) | {"battery": one.battery}) for one in made]
    with connection.cursor() as cursor:
        cursor.execute(_SHOW, [uavs, missions, estimates, holder])
        return dict(cursor.fetchall())


def store_estimates(*, made: Sequence[Made]) -> None:
    """Store the estimates beside the log. Idempotent: the first estimate of a moment is kept."""
    rows = [_row(one) for one in made]
    with connection.cursor() as cursor:
        cursor.execute(_STORE, [[row[name] for row in rows] for name in _COLUMNS])


def replace_estimates(*, reports: Sequence[tuple[int, datetime]]) -> int:
    """Mark estimates as replaced, given by UAV and moment: a report was measured in the second before it. Returns their number."""
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
