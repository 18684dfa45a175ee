"""Storing a plan on its mission: completely or not at all, and only on the mission that it was made for."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from django.contrib.gis.geos import LineString, Point
from django.db import transaction
from django.utils import timezone

from inspection.models import Asset
from missions.models import Mission, MissionState, Route, Waypoint
from missions.selectors.planning_context import with_bases
from missions.services.manual_edits.preserved import keep_by_hand
from missions.services.missions import check_lost_link, drop_plan, lock_mission, request_of_mission
from missions.services.planning.planner import make_plan
from operation.reasons import Reason
from planning.assignment.options import has_sensor
from planning.plan_json import NO_SHORTFALL
from planning.progress import OnPlanProgress
from planning.request import GO_ON, PlanRequest, request_from_json
from planning.solver.solver import Stop
from workspace.audit import record_change
from workspace.jobs.services import JobCancelled, finish_job
from workspace.models import Job, User

PLANNING_TASK = "missions.tasks.solve_plan"
PROOF_TASK = "missions.proof_tasks.prove_mission"
QUALITY = (
    "lower_bound_m",
    "lower_bound_s",
    "lower_bound_wh",
    "gap",
    "is_proven",
    "gap_of",
    "method",
    "wish",
)  # of a plan's JSON, stored with its mission


class NothingToPlan(Exception):
    """Raised for a mission without UAVs or without targets."""


def plan_mission(*, mission: Mission, actor: User | None, expected_revision: int | None = None) -> Mission:
    """Plan the mission and store the plan. Raises what make_plan raises, MissionChanged, MissionFrozen or NothingToPlan.

    The mission is not locked during planning; if it is changed in the meantime, nothing is stored.
    """
    request = plannable_request(mission=mission)
    plan = make_plan(request=request)
    return store_plan(
        mission=mission, actor=actor, revision=mission.revision if expected_revision is None else expected_revision, plan=plan
    )


def take_plan(*, mission: Mission, actor: User | None, revision: int, job: Job) -> bool:
    """Store the plan that a job has already made, if its request equals the mission's; returns False where it does not."""
    if job.task not in {PLANNING_TASK, PROOF_TASK} or not job.result or "request" not in job.parameters:
        return False
    wanted, asked = plannable_request(mission=mission), request_from_json(job.parameters["request"])
    if len(asked.targets) != len(wanted.targets):
        return False
    targets = tuple(
        replace(target, task=stored.task) if target.task is None else target  # the mission stores the planner's default
        for target, stored in zip(asked.targets, wanted.targets, strict=True)
    )
    if _that_counts(replace(asked, targets=targets)) != _that_counts(wanted):
        return False
    with transaction.atomic():
        planned = store_plan(mission=mission, actor=actor, revision=revision, plan=job.result)
        if asked.lost_link != wanted.lost_link:
            check_lost_link(mission=planned)
            planned.save(update_fields=["lost_link_check"])
    return True


def _that_counts(request: PlanRequest) -> PlanRequest:
    """Return the request without what does not affect routes: sensors that no target needs, the lost-link action and the owner.

    A UAV may have got other sensors since the request.
    """
    needed = [target.sensor for target in request.targets if target.sensor]
    uavs = (replace(uav, sensors=tuple(sensor for sensor in needed if has_sensor(uav, sensor))) for uav in request.uavs)
    return replace(request, uavs=tuple(uavs), lost_link=GO_ON, organisation=None, mission=None)


def plannable_request(*, mission: Mission) -> PlanRequest:
    """Return the planning request of a mission, with current bases. Raises NothingToPlan, or InvalidRequest where a base is missing."""
    request = request_of_mission(mission=mission)
    if not request.uavs or not request.targets:
        raise NothingToPlan
    return replace(with_bases(request, mission.organisation), organisation=mission.organisation_id, mission=str(mission.pk))


def plan_mission_for_job(*, job: Job, stop: Stop, on_progress: OnPlanProgress, search_s: float, message: Callable[[], Reason]) -> None:
    """Plan the job's mission, and store the plan and the job's end in one transaction.

    If the user stops the job, the best plan found until then is stored; `message` is called at the end for the result. Raises JobCancelled
    if another worker holds the job by now, and what plan_mission raises.
    """
    mission = Mission.objects.get(pk=job.parameters["mission"])
    request = plannable_request(mission=mission)
    plan = make_plan(request=request, stop=stop, on_progress=on_progress, search_s=search_s)
    with transaction.atomic():
        planned = store_plan(mission=mission, actor=job.created_by, revision=job.parameters["revision"], plan=plan)
        if not finish_job(job=job, result={"mission": str(planned.pk), "revision": planned.revision}, message=message()):
            raise JobCancelled


def store_plan(*, mission: Mission, actor: User | None, revision: int, plan: dict[str, Any]) -> Mission:
    """Replace the mission's routes by the plan's, in one transaction that locks the mission's row.

    `revision` is the mission's for which the plan was made. Raises MissionChanged for a second plan, or one for older targets.
    """
    with transaction.atomic():
        locked = lock_mission(mission_id=mission.pk, expected_revision=revision)
        before = {"revision": locked.revision, "total_length_m": locked.total_length_m, "graph_version": locked.graph_version}
        drop_plan(mission=locked)
        locked.state = MissionState.PLANNED
        locked.planned_at = timezone.now()
        locked.graph_version = plan["graph_version"]
        locked.ground_revision = plan["ground_revision"]
        locked.flat_ground_assumed = plan["flat_ground_assumed"]
        locked.total_length_m = plan["total_length_m"]
        locked.longest_route_m = plan["longest_route_m"]
        locked.total_energy_wh = plan.get("total_energy_wh")
        locked.separation = plan.get("separation")
        locked.lost_link_check = plan.get("lost_link")
        locked.plan_warnings = plan["warnings"]
        locked.plan_quality = {name: plan.get(name) for name in QUALITY}
        locked.revision += 1
        locked.save()
        _store_routes(locked, plan)
        _store_left_out(locked, plan)
        kept_by_hand = keep_by_hand(locked)
        locked.save()
        record_change(
            organisation=locked.organisation,
            actor=actor,
            action="plan",
            subject_type="mission",
            subject_id=locked.pk,
            before=before,
            after={
                "revision": locked.revision,
                "total_length_m": locked.total_length_m,
                "graph_version": locked.graph_version,
                "unassigned": len(plan["unassigned"]),
                "by_hand": kept_by_hand,
            },
        )
    return locked


def _store_routes(mission: Mission, plan: dict[str, Any]) -> None:
    targets = dict(mission.targets.values_list("sequence", "pk"))
    assets = {waypoint["asset"] for route in plan["routes"] for waypoint in route["waypoints"]} - {None}
    still_there = set(Asset.objects.filter(pk__in=assets).values_list("pk", flat=True))
    routes = Route.objects.bulk_create(
        Route(
            mission=mission,
            mission_uav=mission_uav,
            graph_version=plan["graph_version"],
            length_m=route["length_m"],
            duration_s=route["duration_s"],
            departs_s=route.get("departs_s", 0.0),
            energy_wh=route.get("energy_wh"),
            charging=route.get("charging", []),
            battery_percent=route.get("battery_percent"),
            base_name=route.get("base") or "",
            begun_by=route.get("begun_by"),
            lands_at=Point(route["geometry"]["coordinates"][-1], srid=4326) if route.get("base") and route["geometry"] else None,
            geometry=LineString(route["geometry"]["coordinates"], srid=4326) if route["geometry"] else None,
        )
        for mission_uav, route in zip(mission.mission_uavs.all(), plan["routes"], strict=True)
    )
    Waypoint.objects.bulk_create(
        (
            Waypoint(
                route=row,
                sequence=sequence,
                kind=waypoint["kind"],
                position=Point(waypoint["position"], srid=4326),
                asset_id=waypoint["asset"] if waypoint["asset"] in still_there else None,
                target_id=None if waypoint["target"] is None else targets[waypoint["target"]],
                task=waypoint["task"],
                altitude_agl_m=waypoint["altitude_agl_m"],
                altitude_amsl_m=waypoint["altitude_amsl_m"],
                altitude_relative_m=waypoint["altitude_relative_m"],
                arrival_s=arrival_s,
                used_wh=used_wh,
                battery_left_percent=percent,
            )
            for row, route in zip(routes, plan["routes"], strict=True)
            for sequence, (waypoint, arrival_s, used_wh, percent) in enumerate(_timed(route))
        ),
        batch_size=1_000,
    )


def _timed(route: dict[str, Any]) -> Iterator[tuple[Any, ...]]:
    """Yield each waypoint with its arrival, energy and battery; an old plan, or a UAV without a battery, has none."""
    count = len(route["waypoints"])
    columns = (route.get(name) or [None] * count for name in ("arrival_s", "used_wh", "battery_left_percent"))
    return zip(route["waypoints"], *columns, strict=True)


def _store_left_out(mission: Mission, plan: dict[str, Any]) -> None:
    left_out = {item["target"]: item for item in plan["unassigned"]}
    rows = list(mission.targets.filter(sequence__in=left_out))
    for row in rows:
        row.unassigned_reason = left_out[row.sequence]["reason"]
        row.unassigned_message = left_out[row.sequence]["message"][:500]
        row.unassigned_why = left_out[row.sequence].get("why", [])
        row.unassigned_missing = {name: left_out[row.sequence].get(name) for name in NO_SHORTFALL}
    mission.targets.bulk_update(rows, ["unassigned_reason", "unassigned_message", "unassigned_why", "unassigned_missing"])
