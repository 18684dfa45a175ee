"""Rehearsals in API responses."""

from collections.abc import Mapping
from typing import Any

from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

from missions.models import Mission
from simulation.models import Rehearsal, RehearsalRun, RehearsalTrack
from simulation.serializers.places import WaypointPlaces, waypoint_places
from simulation.serializers.words import render_finding
from simulation.services.fleet import CHOSEN
from workspace.jobs.serializers import JobSerializer

CONDITIONS = {
    "calm": gettext_noop("Calm"),
    "as-planned": gettext_noop("As planned"),
    "strong-wind": gettext_noop("Strong wind"),
    "weak-battery": gettext_noop("Weak battery"),
    "own": gettext_noop("Custom conditions"),
}
LIMITS = {
    "waypoint_warn_m": gettext_noop("a waypoint is passed within"),
    "waypoint_fail_m": gettext_noop("a waypoint counts as reached within"),
    "hold_slack_s": gettext_noop("a stay may be shorter by"),
    "across_warn_m": gettext_noop("off the line, warning"),
    "across_fail_m": gettext_noop("off the line, fail"),
    "height_warn_m": gettext_noop("off the height, warning"),
    "height_fail_m": gettext_noop("off the height, fail"),
    "reserve_spare_percent": gettext_noop("battery above the reserve, warning"),
    "late_warn_s": gettext_noop("off the planned time, warning"),
    "zone_beside_m": gettext_noop("beside a zone in force, warning"),
    "zone_height_m": gettext_noop("below or above a zone in force, warning"),
    "obstacle_warn_m": gettext_noop("from towers and wires, warning"),
    "obstacle_fail_m": gettext_noop("from towers and wires, fail"),
    "ground_warn_m": gettext_noop("above the ground, warning"),
    "ground_fail_m": gettext_noop("above the ground, fail"),
    "photo_ground_warn_m": gettext_noop("above the ground on photo flights"),
    "photo_ground_fail_m": gettext_noop("above the ground on photo flights, fail"),
    "apart_fail_m": gettext_noop("between UAVs, fail"),
    "apart_warn_beside_m": gettext_noop("between UAVs across the ground, warning"),
    "apart_warn_height_m": gettext_noop("between UAVs in height, warning"),
    "column_m": gettext_noop("around take-off and landing heights are not looked at within"),
}
SOURCES = (
    gettext_noop("acceptance radius of the simulated autopilot"),
    gettext_noop("PX4, NAV_ACC_RAD, default"),
    gettext_noop("slowing down and setting out"),
    gettext_noop("bar of the flight model with gusts of 2 m/s"),
    gettext_noop("a third of the distance that UAVs are kept apart"),
    gettext_noop("height margin from zones"),
    gettext_noop("doubt of a battery's gauge"),
    gettext_noop("SPANWISE_ZONE_CLEARANCE_M less 2 m of tracking"),
    gettext_noop("SPANWISE_ZONE_HEIGHT_MARGIN_M less 2 m of tracking"),
    gettext_noop("SPANWISE_CLEARANCE_M less 5 m"),
    gettext_noop("arms of a tower beside its middle"),
    gettext_noop("trees, and errors of terrain models"),
    gettext_noop("usual least height of photos less 1 m"),
    gettext_noop("errors of terrain models"),
    gettext_noop("errors of two satellite positions"),
    gettext_noop("where a UAV takes off and lands is its operator's choice"),
)


def rehearsal_json(rehearsal: Rehearsal, *, content_sha256: str | None, ground_revision: int) -> dict[str, Any]:
    """Return a rehearsal. content_sha256: of the mission's present plan, None without one."""
    job = JobSerializer(rehearsal.job).data
    return {
        "id": str(rehearsal.pk),
        "mission": str(rehearsal.mission_id),
        "job": str(rehearsal.job_id),
        **{name: job[name] for name in ("state", "progress", "message", "error")},
        "is_simulated": True,
        "level": rehearsal.level,
        "is_outdated": rehearsal.content_sha256 != content_sha256,
        "content_sha256": rehearsal.content_sha256,
        "mission_revision": rehearsal.mission_revision,
        "ground_revision": rehearsal.ground_revision,
        "ground_changed": rehearsal.ground_revision != ground_revision,
        "seed": rehearsal.seed,
        "uavs": [{**uav, "words": _render_stand_in(uav)} for uav in rehearsal.uavs],
        "created_at": rehearsal.created_at,
        "created_by": rehearsal.created_by.username if rehearsal.created_by else None,
        "runs": [_run(run, rehearsal) for run in rehearsal.runs.all()],
    }


def rehearsal_detail_json(rehearsal: Rehearsal, mission: Mission, **known: Any) -> dict[str, Any]:
    """Return a rehearsal with its assessments. Places are named as long as the plan is the one that was flown."""
    places = waypoint_places(mission) if known["content_sha256"] == rehearsal.content_sha256 else {}
    names = {uav["uav"]: uav["name"] for uav in rehearsal.uavs}
    labels = {target.sequence: target.label for target in mission.targets.all()}
    return {
        **rehearsal_json(rehearsal, **known),
        "runs": [{**_run(run, rehearsal), "assessment": _assessment(run, names, labels, places)} for run in rehearsal.runs.all()],
        "limits": [
            {"name": name, **limit, "source": _(limit["source"]), "words": _(LIMITS[name]) if name in LIMITS else name}
            for name, limit in rehearsal.limits.items()
        ],
    }


def track_json(
    run: int, tracks: Mapping[int, RehearsalTrack], rehearsal: Rehearsal, planned: Mapping[int, list[dict[str, Any]]]
) -> dict[str, Any]:
    names = {uav["uav"]: uav["name"] for uav in rehearsal.uavs}
    return {
        "run": run,
        "is_simulated": True,
        "routes": [
            {"uav": uav, "name": names.get(uav, ""), "flights": track.flights, "planned": planned.get(uav, [])}
            for uav, track in tracks.items()
        ],
    }


def planned_points(mission: Mission) -> dict[int, list[dict[str, Any]]]:
    """Return the points of each UAV's route, by its place."""
    sequence_of = {target.pk: target.sequence for target in mission.targets.all()}
    return {
        route.mission_uav.sequence: [
            {
                "waypoint": waypoint.sequence,
                "position": list(waypoint.position.coords[:2]),
                "altitude_amsl_m": waypoint.altitude_amsl_m,
                "altitude_relative_m": waypoint.altitude_relative_m,
                "at_s": waypoint.arrival_s,
                "target": None if waypoint.target_id is None else sequence_of.get(waypoint.target_id),
                "battery_percent": waypoint.battery_left_percent,
            }
            for waypoint in route.waypoints.all()
        ]
        for route in mission.routes.all()
    }


def _render_stand_in(uav: Mapping[str, Any]) -> str:
    values = {"uav": uav["name"], "airframe": uav["airframe_name"], "battery": f"{uav['battery_wh']:.0f}"}
    if uav["why"] == CHOSEN:
        if uav["has_own_battery"]:
            return _("%(uav)s: the simulated %(airframe)s, as said for its type, with its own battery of %(battery)s Wh") % values
        return _("%(uav)s: the simulated %(airframe)s, as said for its type, with that one's battery of %(battery)s Wh") % values
    if uav["has_own_battery"]:
        return _("%(uav)s: the simulated %(airframe)s, the nearest by mass and endurance, with its own battery of %(battery)s Wh") % values
    return _("%(uav)s: the simulated %(airframe)s, the nearest by speed and mass, with that one's battery of %(battery)s Wh") % values


def _run(run: RehearsalRun, rehearsal: Rehearsal) -> dict[str, Any]:
    return {
        "sequence": run.sequence,
        "conditions": run.conditions,
        "words": run.conditions["name"] or _(CONDITIONS[run.conditions["code"]]),
        "level": run.level,
        "took_s": None if run.took_s is None else round(run.took_s, 1),
        "finished_at": run.finished_at,
        "is_reused": run.finished_at is not None and run.finished_at < rehearsal.created_at,
    }


def _assessment(run: RehearsalRun, names: Mapping[int, str], labels: Mapping[int, str], places: WaypointPlaces) -> dict[str, Any] | None:
    if run.assessment is None:
        return None
    findings = [render_finding(finding, names, labels, places) for finding in run.assessment["findings"]]
    return {
        **run.assessment,
        "findings": findings,
        "routes": [
            {
                **route,
                "targets": [
                    {**target, "label": labels.get(target["target"], ""), "reasons": _reasons(findings, target=target["target"])}
                    for target in route["targets"]
                ],
                "reasons": [finding["reason"] for finding in findings if finding["uav"] == route["uav"] and finding["target"] is None],
            }
            for route in run.assessment["routes"]
        ],
    }


def _reasons(findings: list[dict[str, Any]], *, target: int) -> list[str]:
    return [finding["reason"] for finding in findings if finding["target"] == target]
