"""Mission report: what was planned, what was flown, and the outcome of each target."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime, timedelta
from typing import Any
from uuid import UUID

from django.db.models import Count, F

from inspection.geodesy import LonLat
from mavlink.approved_route import FrozenRoute, route_from_json
from missions.models import ENDED_STATES, Approval, InspectionTarget, LinkKind, Mission, OfferState, TargetState, Uav
from telemetry.mission_report.fix import Fix, airborne, in_order, uav_after_s, uav_span_s
from telemetry.mission_report.flown_route import ReportedRoute, flown_route
from telemetry.mission_report.outcomes import FlightFacts, Incident, OutcomeReason, Result, TargetFacts, TargetOutcome, outcome_of
from telemetry.mission_report.visits import ReportedVisit, visits_of
from telemetry.models import Alert, AlertLevel, InspectionResult, TelemetryRecord
from telemetry.selectors.captures import photos_by_uav
from telemetry.selectors.columns import latitude, longitude, unix_s
from telemetry.selectors.estimates import estimate_quality_of
from telemetry.selectors.incidents import incidents_of
from telemetry.selectors.report_words import reason_words
from workspace.models import Organisation
from workspace.reason_texts import column_text, reasons_of_column, why_text

_FIX_COLUMNS = ("altitude_relative_m", "battery_percent", "waypoint_sequence", "is_in_air")
HASTE = 1.5  # factor on the planned speed that a UAV may reach with tailwind or flown manually


@dataclass(frozen=True)
class RouteOnRecord:
    """One UAV's part. `planned` has the values of the approval; times of `flown` and `visits` are Unix seconds."""

    place: int
    uav_id: int | None
    name: str
    route: FrozenRoute
    planned: dict[str, Any]
    flown: ReportedRoute
    visits: tuple[ReportedVisit, ...]
    in_air: tuple[Fix, ...]


@dataclass(frozen=True)
class TargetOnRecord:
    """A target with its outcome, and its UAV's route and visit, None without a route.

    Seconds are after that UAV's take-off, flown ones by its clock; None if unknown.
    """

    row: InspectionTarget
    route: RouteOnRecord | None
    visit: ReportedVisit | None
    outcome: TargetOutcome
    planned_after_s: float | None
    reached_after_s: float | None


@dataclass(frozen=True)
class WholeRecord:
    """Input of the report and of result files. Targets are in the operator's order."""

    mission: Mission
    approval: Approval | None
    routes: tuple[RouteOnRecord, ...]
    targets: tuple[TargetOnRecord, ...]
    incidents: tuple[Incident, ...]


def mission_on_record(organisation: Organisation, mission_id: UUID) -> Mission | None:
    return Mission.objects.filter(organisation=organisation, deleted_at=None, pk=mission_id).select_related("continues").first()


def approval_on_record(mission: Mission) -> Approval | None:
    """Return the approval that was flown: the one in force, else the last one."""
    return mission.approvals.select_related("approved_by").order_by(F("revoked_at").asc(nulls_first=True), "-approved_at").first()


def fixes_of(mission: Mission, uav_id: int) -> list[Fix]:
    """Return a UAV's positions in a mission by time, without those from the future."""
    rows = TelemetryRecord.objects.filter(mission=mission, uav=uav_id, is_from_future=False, position__isnull=False).order_by("measured_at")
    columns = rows.values_list(unix_s("measured_at"), longitude(), latitude(), "stream__link", "stream_id", "sequence", *_FIX_COLUMNS)
    return in_order([_fix(*row) for row in columns.iterator(chunk_size=5_000)])


def _fix(
    at_s: float, lon: float, lat: float, link: str, stream: int, sequence: int, altitude_relative_m: float | None,
    battery_percent: float | None, waypoint: int | None, is_in_air: bool | None,
) -> Fix:  # fmt: skip
    """Return the fix of a row. A MAVLink record's number is the time since boot [ms]."""
    clock_s = sequence / 1_000.0 if link == LinkKind.MAVLINK else None
    return Fix(at_s, LonLat(lon, lat), altitude_relative_m, battery_percent, waypoint, is_in_air, boot=stream, clock_s=clock_s)


def fastest_mps(route: FrozenRoute, figures: dict[str, Any]) -> float:
    """Return the highest possible ground speed."""
    assigned_speeds = [route.cruise_speed_mps, (figures.get("performance") or {}).get("max_airspeed_mps") or 0.0]
    return HASTE * max([*assigned_speeds, *(waypoint.speed_mps or 0.0 for waypoint in route.waypoints)])


def routes_on_record(mission: Mission, approval: Approval | None) -> list[RouteOnRecord]:
    """Return the routes as approved; none for a mission without approval."""
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
                in_air=tuple(airborne(fixes)),
            )
        )
    return found


def whole_record(mission: Mission) -> WholeRecord:
    """Read everything planned, flown and reported."""
    approval = approval_on_record(mission)
    routes = routes_on_record(mission, approval)
    flown = {route.uav_id: (route.place, route.name, route.in_air) for route in routes if route.uav_id is not None}
    incidents = incidents_of(mission, flown)
    return WholeRecord(mission, approval, tuple(routes), tuple(_targets_on_record(mission, routes, incidents)), tuple(incidents))


def in_flown_order(targets: Sequence[TargetOnRecord]) -> list[TargetOnRecord]:
    """Return the targets in the order reached; then those not reached, by UAV and plan; those without a route last."""

    def order(target: TargetOnRecord) -> tuple[bool, float, bool, int, int]:
        reached_s = None if target.visit is None or target.outcome.result is Result.NOT_INSPECTED else target.visit.reached_s
        place = -1 if target.route is None else target.route.place
        sequence = target.row.sequence if target.visit is None else target.visit.waypoint_sequence
        return reached_s is None, reached_s or 0.0, target.route is None, place, sequence

    return sorted(targets, key=order)


def mission_record(mission: Mission) -> dict[str, Any]:
    """Return the report for the API, with times as datetimes."""
    whole = whole_record(mission)
    approval, routes = whole.approval, whole.routes
    flown_by = [route.uav_id for route in routes if route.uav_id is not None]
    simulated = set(Uav.objects.filter(pk__in=flown_by, is_simulated=True).values_list("pk", flat=True))
    photos = photos_by_uav(mission)
    return {
        "mission": {
            "id": mission.pk,
            "name": mission.name,
            "external_id": mission.external_id,
            "attributes": mission.attributes,
            "colours": mission.colours,
            "state": mission.state,
            "departs_at": mission.departs_at,
            "started_at": mission.started_at,
            "ended_at": mission.ended_at,
            "continues": mission.continues_id,
            "continued_by": _continuation(mission),
            "approval": None if approval is None else _approval(approval),
        },
        "summary": _summary(whole),
        "incidents": [_incident(one, routes) for one in whole.incidents],
        "routes": [
            _route(route, mission) | {"is_simulated": route.uav_id in simulated, "photos": photos.get(route.uav_id or 0, 0)}
            for route in routes
        ],
        "targets": _targets(whole),
        "results": _results(mission),
    }


def _incident(incident: Incident, routes: Sequence[RouteOnRecord]) -> dict[str, Any]:
    return {
        "kind": incident.kind.value,
        "at": at(incident.at_s),
        "uav": incident.place,
        "uav_name": next((route.name for route in routes if route.place == incident.place), ""),
        "position": None if incident.position is None else list(incident.position),
        "message": reason_words(incident.reason),
    }


def _continuation(mission: Mission) -> UUID | None:
    """Return the mission that flies the rest of this one, once a user has accepted it."""
    return mission.continued_by.filter(offered_by__state=OfferState.ACCEPTED, deleted_at=None).values_list("pk", flat=True).first()


def _approval(approval: Approval) -> dict[str, Any]:
    by = approval.approved_by
    return {
        "id": approval.pk,
        "content_sha256": approval.content_sha256,
        "approved_at": approval.approved_at,
        "approved_by": by.display_name if by else None,
        "failed_rehearsal_reason": approval.failed_rehearsal_reason,
        "revoked_at": approval.revoked_at,
    }


def _summary(whole: WholeRecord) -> dict[str, Any]:
    mission, routes = whole.mission, whole.routes
    states = Counter(target.row.state for target in whole.targets)
    results = Counter(target.outcome.result for target in whole.targets)
    levels = dict(Alert.objects.filter(mission=mission).values_list("level").annotate(Count("pk")).order_by())
    flown = [route.flown for route in routes if route.flown.reports]
    departs_s = min((route.route.departs_s for route in routes), default=0.0)
    return {
        "targets": {state.value: states[state] for state in TargetState} | {"all": len(whole.targets)},
        "results": {result.value: results[result] for result in Result} | {"all": len(whole.targets)},
        "alerts": {level.value: levels.get(level, 0) for level in AlertLevel},
        "planned": {
            "length_m": sum(route.planned["length_m"] for route in routes),
            "duration_s": max((route.route.departs_s + route.planned["duration_s"] for route in routes), default=0.0) - departs_s,
            "energy_wh": _sum([route.planned["energy_wh"] for route in routes]),
        },
        "flown": {
            "length_m": sum(route.flown_m for route in flown),
            "duration_s": uav_span_s([route.in_air for route in routes]) if flown else None,
            "energy_wh": _sum([_used_wh(route) for route in routes]),
            "unreported_m": sum(gap.length_m for route in flown for gap in route.gaps),
            "unreported_s": sum(gap.ended_s - gap.began_s for route in flown for gap in route.gaps),
        },
        "clock_rate": _clock_rate(flown),
        "across_rms_m": _rms([(route.across_rms_m, route.reports) for route in flown]),
        "height_rms_m": _rms([(route.height_rms_m, route.reports) for route in flown]),
        "lowest_battery_percent": min((low for route in flown if (low := route.battery_lowest_percent) is not None), default=None),
        "estimates": _estimates(mission),
    }


def _clock_rate(flown: Sequence[ReportedRoute]) -> float:
    """Return the rate over all UAVs: seconds of their clocks per server second."""
    ours_s = sum(route.duration_s / route.clock_rate for route in flown if route.duration_s)
    return sum(route.duration_s for route in flown if route.duration_s) / ours_s if ours_s else 1.0


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


def _used_wh(route: RouteOnRecord) -> float | None:
    battery_wh = (route.planned["figures"].get("performance") or {}).get("battery_wh")
    used = route.flown.battery_used_percent
    return None if battery_wh is None or used is None else battery_wh * used / 100.0


def _sum(values: Sequence[float | None]) -> float | None:
    """Return the sum; None if any value is unknown or there are none."""
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
    """Return Unix seconds as a datetime."""
    return None if seconds is None else datetime.fromtimestamp(seconds, UTC)


def _reasons_of(target: InspectionTarget) -> list[dict[str, Any]]:
    """Return why the target was not done, except for text that a user wrote."""
    return reasons_of_column(target.state_why, target.state_reason) if target.state_reason else target.unassigned_why


def _reason_text(target: InspectionTarget) -> str:
    """The same in the reader's language."""
    if target.state_reason:
        return column_text(target.state_why, target.state_reason)
    return why_text(target.unassigned_why, target.unassigned_message)


def _targets_on_record(mission: Mission, routes: Sequence[RouteOnRecord], incidents: Sequence[Incident]) -> list[TargetOnRecord]:
    on_route = {point.target: (route, point) for route in routes for point in route.route.waypoints if point.target is not None}
    visits = {visit.target: visit for route in routes for visit in route.visits}
    last_visits = {route.place: max((v.reached_s for v in route.visits if v.is_done and v.reached_s), default=None) for route in routes}
    rows = InspectionResult.objects.filter(target__mission=mission).order_by("measured_at", "pk")
    reported = {place: (outcome, note) for place, outcome, note in rows.values_list("target__sequence", "outcome", "note")}
    continued = set(mission.routes.filter(continued_by__isnull=False).values_list("mission_uav__sequence", flat=True))
    found = []
    for target in mission.targets.order_by("sequence").select_related("asset__line"):
        route, waypoint = on_route.get(target.sequence, (None, None))
        visit = visits.get(target.sequence)
        flight = None
        if route is not None:
            flight = FlightFacts(
                route.place, route.name, visit, bool(route.in_air), last_visits[route.place], is_continued=route.place in continued
            )
        facts = TargetFacts(
            target.state, target.state_reason, target.unassigned_message, _reasons_of(target),
            None if target.reached_at is None else target.reached_at.timestamp(), reported.get(target.sequence),
        )  # fmt: skip
        outcome = outcome_of(facts, flight, incidents, is_over=mission.state in ENDED_STATES)
        arrival_s = None if waypoint is None else waypoint.arrival_s
        reached_s = None if visit is None else visit.reached_s
        found.append(
            TargetOnRecord(
                target, route, visit, outcome,
                planned_after_s=None if route is None or arrival_s is None else arrival_s - route.route.departs_s,
                reached_after_s=None if route is None or reached_s is None or not route.in_air else uav_after_s(route.in_air, reached_s),
            )
        )  # fmt: skip
    return found


def _targets(whole: WholeRecord) -> list[dict[str, Any]]:
    flown_places = {target.row.pk: number for number, target in enumerate(in_flown_order(whole.targets), start=1)}
    return [_target(target, whole.mission) | {"flown_place": flown_places[target.row.pk]} for target in whole.targets]


def _target(target: TargetOnRecord, mission: Mission) -> dict[str, Any]:
    row, route, visit, after_s = target.row, target.route, target.visit, target.planned_after_s
    departs_at, departs_s = mission.departs_at, route.route.departs_s if route else 0.0
    return {
        "place": row.sequence,
        "label": row.label,
        "asset": row.asset_id,
        "external_id": row.external_id,
        "attributes": row.attributes,
        "state": row.state,
        "state_at": row.state_at,
        "state_reason": _reason_text(row),
        "result": target.outcome.result.value,
        "reason": _reason(target.outcome.reason),
        "uav": None if route is None else route.place,
        "waypoint_sequence": None if visit is None else visit.waypoint_sequence,
        "planned_at": None if departs_at is None or after_s is None else departs_at + timedelta(seconds=departs_s + after_s),
        "reached_at": None if visit is None else at(visit.reached_s),
        "planned_after_s": after_s,
        "reached_after_s": target.reached_after_s,
        "closest_m": None if visit is None else visit.closest_m,
        "planned_hold_s": None if visit is None else visit.planned_hold_s,
        "held_s": None if visit is None else visit.held_s,
    }


def _reason(reason: OutcomeReason | None) -> dict[str, Any] | None:
    if reason is None:
        return None
    return {"code": reason.code, "message": reason_words(reason), "at": at(reason.at_s)}


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
