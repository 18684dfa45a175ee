"""The record of a mission: what was planned, what was flown, and what came of each target."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime, timedelta
from typing import Any
from uuid import UUID

from django.db.models import Count, F

from inspection.geodesy import LonLat
from missions.mavlink.frozen import FrozenRoute, route_from_json
from missions.models import Approval, InspectionTarget, LinkKind, Mission, OfferState, TargetState, Uav
from telemetry.mission_report.fix import Fix, in_order
from telemetry.mission_report.flown_route import FlownRoute, flown_route
from telemetry.mission_report.visits import Visit, visits_of
from telemetry.models import Alert, AlertLevel, InspectionResult, TelemetryRecord
from telemetry.selectors.columns import latitude, longitude, unix_s
from telemetry.selectors.estimates import estimate_quality_of
from workspace.models import Organisation

_FIX_COLUMNS = ("altitude_relative_m", "battery_percent", "waypoint_sequence", "is_in_air")
HASTE = 1.5  # so much faster than it was told may a UAV be: down the wind, or flown by hand


@dataclass(frozen=True)
class RouteOnRecord:
    """One UAV's part. `planned` has the figures of the approval; times of `flown` and `visits` are Unix seconds."""

    place: int
    uav_id: int | None
    name: str
    route: FrozenRoute
    planned: dict[str, Any]
    flown: FlownRoute
    visits: tuple[Visit, ...]


def mission_on_record(organisation: Organisation, mission_id: UUID) -> Mission | None:
    return Mission.objects.filter(organisation=organisation, deleted_at=None, pk=mission_id).select_related("continues").first()


def approval_on_record(mission: Mission) -> Approval | None:
    """By which it was flown: the one in force, else the last one."""
    return mission.approvals.select_related("approved_by").order_by(F("revoked_at").asc(nulls_first=True), "-approved_at").first()


def fixes_of(mission: Mission, uav_id: int) -> list[Fix]:
    """Where a UAV was in a mission, by time; none of the future."""
    rows = TelemetryRecord.objects.filter(mission=mission, uav=uav_id, is_from_future=False, position__isnull=False).order_by("measured_at")
    columns = rows.values_list(unix_s("measured_at"), longitude(), latitude(), "stream__link", "stream_id", "sequence", *_FIX_COLUMNS)
    return in_order([_fix(*row) for row in columns.iterator(chunk_size=5_000)])


def _fix(
    at_s: float, lon: float, lat: float, link: str, stream: int, sequence: int, altitude_relative_m: float | None,
    battery_percent: float | None, waypoint: int | None, is_in_air: bool | None,
) -> Fix:  # fmt: skip
    """By MAVLink a record's number is the time since boot [ms]."""
    clock_s = sequence / 1_000.0 if link == LinkKind.MAVLINK else None
    return Fix(at_s, LonLat(lon, lat), altitude_relative_m, battery_percent, waypoint, is_in_air, boot=stream, clock_s=clock_s)


def fastest_mps(route: FrozenRoute, figures: dict[str, Any]) -> float:
    """Over ground, by any means."""
    told = [route.cruise_speed_mps, (figures.get("performance") or {}).get("max_airspeed_mps") or 0.0]
    return HASTE * max([*told, *(waypoint.speed_mps or 0.0 for waypoint in route.waypoints)])


def routes_on_record(mission: Mission, approval: Approval | None) -> list[RouteOnRecord]:
    """As approved; none for a mission that nobody has approved."""
    found = []
    for approved in approval.document["routes"] if approval else ():
        route = route_from_json(approved["route"])
        fixes = [] if approved["uav"] is None else fixes_of(mission, approved["uav"])
        found.append(
            RouteOnRecord(
                place=approved["place"],
                uav_id=approved["uav"],
                name=approved["name"],
                route=route,
                planned={name: approved[name] for name in ("length_m", "duration_s", "energy_wh")} | {"figures": approved["figures"]},
                flown=flown_route(route, fixes),
                visits=tuple(visits_of(route, fixes, fastest_mps=fastest_mps(route, approved["figures"]))),
            )
        )
    return found


def mission_record(mission: Mission) -> dict[str, Any]:
    """As the API shows it, times as datetimes."""
    approval = approval_on_record(mission)
    routes = routes_on_record(mission, approval)
    targets = list(mission.targets.order_by("sequence"))
    flown_by = [route.uav_id for route in routes if route.uav_id is not None]
    simulated = set(Uav.objects.filter(pk__in=flown_by, is_simulated=True).values_list("pk", flat=True))
    return {
        "mission": {
            "id": mission.pk,
            "name": mission.name,
            "external_id": mission.external_id,
            "attributes": mission.attributes,
            "state": mission.state,
            "departs_at": mission.departs_at,
            "started_at": mission.started_at,
            "ended_at": mission.ended_at,
            "continues": mission.continues_id,
            "continued_by": _continuation(mission),
            "approval": None if approval is None else _approval(approval),
        },
        "summary": _summary(mission, routes, targets),
        "routes": [_route(route, mission) | {"is_simulated": route.uav_id in simulated} for route in routes],
        "targets": _targets(mission, targets, routes),
        "results": _results(mission),
    }


def _continuation(mission: Mission) -> UUID | None:
    """The mission that flies what is left of this one, once a person has confirmed it."""
    return mission.continued_by.filter(offered_by__state=OfferState.ACCEPTED, deleted_at=None).values_list("pk", flat=True).first()


def _approval(approval: Approval) -> dict[str, Any]:
    by = approval.approved_by
    return {
        "id": approval.pk,
        "content_sha256": approval.content_sha256,
        "approved_at": approval.approved_at,
        "approved_by": by.get_full_name() or by.username if by else None,
        "revoked_at": approval.revoked_at,
    }


def _summary(mission: Mission, routes: Sequence[RouteOnRecord], targets: Sequence[InspectionTarget]) -> dict[str, Any]:
    states = Counter(target.state for target in targets)
    levels = dict(Alert.objects.filter(mission=mission).values_list("level").annotate(Count("pk")).order_by())
    flown = [route.flown for route in routes if route.flown.reports]
    return {
        "targets": {state.value: states[state] for state in TargetState} | {"all": len(targets)},
        "alerts": {level.value: levels.get(level, 0) for level in AlertLevel},
        "planned": {
            "length_m": sum(route.planned["length_m"] for route in routes),
            "duration_s": max((route.route.departs_s + route.planned["duration_s"] for route in routes), default=0.0),
            "energy_wh": _sum([route.planned["energy_wh"] for route in routes]),
        },
        "flown": {
            "length_m": sum(route.flown_m for route in flown),
            "duration_s": _duration_s(flown),
            "energy_wh": _sum([_used_wh(route) for route in routes]),
            "unreported_m": sum(gap.length_m for route in flown for gap in route.gaps),
            "unreported_s": sum(gap.ended_s - gap.began_s for route in flown for gap in route.gaps),
        },
        "across_rms_m": _rms([(route.across_rms_m, route.reports) for route in flown]),
        "height_rms_m": _rms([(route.height_rms_m, route.reports) for route in flown]),
        "lowest_battery_percent": min((low for route in flown if (low := route.battery_lowest_percent) is not None), default=None),
        "estimates": _estimates(mission),
    }


def _estimates(mission: Mission) -> dict[str, Any]:
    quality = estimate_quality_of(mission.pk)
    whole = quality.whole
    return {
        "compared": whole.count,
        "untold": quality.untold,
        "share_inside": whole.inside_share,
        "rms_m": whole.rms_m,
        "largest_m": whole.largest_m,
        "height_share_inside": whole.height_inside_share,
        "height_rms_m": whole.height_rms_m,
    }


def _duration_s(flown: Sequence[FlownRoute]) -> float | None:
    began = [route.began_s for route in flown if route.began_s is not None]
    ended = [route.ended_s for route in flown if route.ended_s is not None]
    return max(ended) - min(began) if began and ended else None


def _used_wh(route: RouteOnRecord) -> float | None:
    battery_wh = (route.planned["figures"].get("performance") or {}).get("battery_wh")
    used = route.flown.battery_used_percent
    return None if battery_wh is None or used is None else battery_wh * used / 100.0


def _sum(values: Sequence[float | None]) -> float | None:
    """None where one is not known, or there are none."""
    known = [value for value in values if value is not None]
    return sum(known) if known and len(known) == len(values) else None


def _rms(values: Sequence[tuple[float | None, int]]) -> float | None:
    known = [(value, weight) for value, weight in values if value is not None]
    weights = sum(weight for _, weight in known)
    return (sum(value * value * weight for value, weight in known) / weights) ** 0.5 if weights else None


def _route(route: RouteOnRecord, mission: Mission) -> dict[str, Any]:
    flown = asdict(route.flown)
    legs, stages = flown.pop("legs"), flown.pop("stages")
    return {
        "place": route.place,
        "uav": route.uav_id,
        "name": route.name,
        "departs_at": None if mission.departs_at is None else mission.departs_at + timedelta(seconds=route.route.departs_s),
        "planned": {name: route.planned[name] for name in ("length_m", "duration_s", "energy_wh")},
        "flown": _with_times(flown) | {"energy_wh": _used_wh(route), "gaps": [_with_times(gap) for gap in flown["gaps"]]},
        "legs": [_with_times(leg) for leg in legs],
        "stages": [{"flight": stage["flight"], "target": stage["target"], **_with_times(stage["whole"])} for stage in stages],
        "waypoints": [
            {
                "sequence": waypoint.sequence,
                "kind": waypoint.kind.value,
                "position": list(waypoint.position),
                "altitude_relative_m": waypoint.altitude_relative_m,
                "arrival_s": waypoint.arrival_s,
                "target": waypoint.target,
            }
            for waypoint in route.route.waypoints
        ],
    }


def _with_times(values: dict[str, Any]) -> dict[str, Any]:
    return {
        **{name: value for name, value in values.items() if name not in {"began_s", "ended_s"}},
        "began_at": at(values["began_s"]),
        "ended_at": at(values["ended_s"]),
    }


def at(seconds: float | None) -> datetime | None:
    """Return the time of Unix seconds."""
    return None if seconds is None else datetime.fromtimestamp(seconds, UTC)


def _targets(mission: Mission, targets: Sequence[InspectionTarget], routes: Sequence[RouteOnRecord]) -> list[dict[str, Any]]:
    visits = {visit.target: (route, visit) for route in routes for visit in route.visits}
    found = []
    for target in targets:
        route, visit = visits.get(target.sequence, (None, None))
        arrival_s = next((point.arrival_s for point in route.route.waypoints if point.target == target.sequence), None) if route else None
        planned_at = None if mission.departs_at is None or arrival_s is None else mission.departs_at + timedelta(seconds=arrival_s)
        found.append(
            {
                "place": target.sequence,
                "label": target.label,
                "asset": target.asset_id,
                "external_id": target.external_id,
                "attributes": target.attributes,
                "state": target.state,
                "state_at": target.state_at,
                "state_reason": target.state_reason or target.unassigned_message,
                "uav": None if route is None else route.place,
                "waypoint_sequence": None if visit is None else visit.waypoint_sequence,
                "planned_at": planned_at,
                "reached_at": None if visit is None else at(visit.reached_s),
                "closest_m": None if visit is None else visit.closest_m,
                "planned_hold_s": None if visit is None else visit.planned_hold_s,
                "held_s": None if visit is None else visit.held_s,
            }
        )
    return found


def _results(mission: Mission) -> list[dict[str, Any]]:
    rows = InspectionResult.objects.filter(mission=mission).select_related("uav").order_by("place", "measured_at")
    return [
        {
            "id": row.pk,
            "place": row.place,
            "uav": row.uav_id,
            "uav_name": row.uav.name,
            "outcome": row.outcome,
            "note": row.note,
            "values": row.values,
            "measured_at": row.measured_at,
            "received_at": row.received_at,
        }
        for row in rows
    ]
