"""Proofs of stored plans in the background: a better bound for the plan, or a better plan to choose instead."""

from typing import Any

from django.db import transaction
from django.db.models import F, Max, Sum

from missions.models import Base, Mission, MissionState
from missions.services.manual_edits.edits import BY_HAND
from missions.services.mission_plans import PROOF_TASK, plannable_request
from missions.services.missions import MissionChanged, lock_mission
from missions.services.planning.later_departure import value_of_plan
from missions.services.planning.planner import make_plan
from operation.reasons import Reason
from planning.assignment.assignment import UNCOUNTED
from planning.problem import Objective
from planning.progress import OnPlanProgress
from planning.request import request_from_json, request_to_json
from planning.solver.solver import MAX_PROVEN_TARGETS, Prover, Stop
from workspace.jobs.services import JobCancelled, TooManyJobs, create_job, finish_job
from workspace.models import OPEN_STATES, Job, JobState
from workspace.tasks import send_job_on_commit

MAX_OPEN_PROOFS = 20  # of an organisation, each about a minute of the one worker
ROUNDING = 1e-6  # of values and bounds in plans
_BOUND = {
    Objective.TOTAL: "lower_bound_m", Objective.MAKESPAN: "lower_bound_s", Objective.TIME: "lower_bound_s",
    Objective.ENERGY: "lower_bound_wh",
}  # fmt: skip


class NothingToProve(Exception):
    """Raised for a mission without a plan, and for plans that are proven, changed by hand, frozen, or too large."""


def begin_proof(*, mission: Mission) -> Job:
    """Return the job that proves the mission's plan; created unless the plan has one that was not cancelled.

    The mission's revision stays: neither its targets nor its routes change. Raises NothingToProve, NothingToPlan, MissionFrozen,
    InvalidRequest where a base is missing, or TooManyJobs where enough plans of the organisation wait for their proof.
    """
    with transaction.atomic():
        locked = lock_mission(mission_id=mission.pk, expected_revision=None)
        quality = locked.plan_quality or {}
        known = str(quality.get("proof", ""))
        job = Job.objects.filter(pk=known).exclude(state=JobState.CANCELLED).first() if known else None
        if job is not None and _is_of(job, locked):
            return job
        if not _is_provable(locked, quality):
            raise NothingToProve
        waiting = Job.objects.filter(organisation=locked.organisation, task=PROOF_TASK, state__in=OPEN_STATES).count()
        if waiting >= MAX_OPEN_PROOFS:
            raise TooManyJobs(MAX_OPEN_PROOFS)
        parameters = {
            "mission": str(locked.pk),
            "planned_at": locked.planned_at and locked.planned_at.isoformat(),
            "request": request_to_json(plannable_request(mission=locked)),
        }
        message = Reason("looking_for_better_plan")
        job = create_job(organisation=locked.organisation, created_by=None, task=PROOF_TASK, parameters=parameters, message=message)
        Mission.objects.filter(pk=locked.pk).update(plan_quality=quality | {"proof": str(job.pk)})
        send_job_on_commit(job)
    return job


def _is_provable(mission: Mission, quality: dict[str, Any]) -> bool:
    return (
        mission.state == MissionState.PLANNED
        and bool(quality)
        and not quality.get("is_proven")
        and quality.get("method") != BY_HAND
        and mission.targets.count() <= MAX_PROVEN_TARGETS
    )


def prove_for_job(*, job: Job, prover: Prover, stop: Stop, on_progress: OnPlanProgress, search_s: float) -> None:
    """Prove the plan of the job's mission: its better bound is stored with it, the prover's plan becomes the job's result.

    Nothing is stored with a plan that was replaced meanwhile. Raises MissionChanged where it was at the beginning, JobCancelled if another
    worker holds the job by now, and what make_plan raises.
    """
    mission = Mission.objects.get(pk=job.parameters["mission"])
    if not _is_of(job, mission):
        raise MissionChanged
    request = request_from_json(job.parameters["request"])
    plan = make_plan(request=request, stop=stop, on_progress=on_progress, search_s=search_s, prover=prover)
    with transaction.atomic():
        locked = Mission.objects.select_for_update(no_key=True).get(pk=mission.pk)
        if _is_of(job, locked):
            Mission.objects.filter(pk=locked.pk).update(plan_quality=proven_quality(locked, plan))
        if not finish_job(job=job, result=plan, message=Reason("proof_ended")):
            raise JobCancelled


def _is_of(job: Job, mission: Mission) -> bool:
    """Whether the mission still has the plan that the job is to prove."""
    planned_at = None if mission.planned_at is None else mission.planned_at.isoformat()
    return (job.parameters.get("mission"), job.parameters.get("planned_at")) == (str(mission.pk), planned_at)


def proven_quality(mission: Mission, proven: dict[str, Any]) -> dict[str, Any]:
    """Return the quality of the mission's plan with what the proof of another plan for the same request says of it.

    Nothing is new where that plan was made on other map data, with other UAVs or bases, or visits other targets. A plan that was changed
    by hand meanwhile can be proven anew once that is undone.
    """
    quality = dict(mission.plan_quality or {})
    if quality.get("method") == BY_HAND:
        planned = {name: value for name, value in quality.get("planned", {}).items() if name != "proof"}
        return {name: value for name, value in quality.items() if name != "proof"} | {"planned": planned}
    left_out = sorted(mission.targets.exclude(unassigned_reason="").values_list("sequence", flat=True))
    alike = (
        proven["ground_revision"] == mission.ground_revision
        and sorted(item["target"] for item in proven["unassigned"]) == left_out
        and _grounded(proven["warnings"]) == _grounded(mission.plan_warnings)
        and _bases_are_there(mission)
    )
    objective = Objective(mission.objective)
    name, value = _BOUND[objective], _value(mission, objective)
    bound = proven[name]
    if not alike or bound is None or not (quality.get(name) or 0.0) < bound <= value * (1.0 + ROUNDING):
        return quality
    is_as_good = value <= value_of_plan(proven) + min(UNCOUNTED[objective], 1.0)
    is_proven = bool(proven["is_proven"]) and is_as_good
    gap = round(max(0.0, 1.0 - bound / value), 6)
    return quality | {name: bound, "gap": 0.0 if is_proven else gap, "is_proven": is_proven, "gap_of": proven["gap_of"]}


def _grounded(warnings: list[dict[str, Any]]) -> list[tuple[str, int | None]]:
    """Return what keeps which UAVs on the ground; that some are in the air does not."""
    return sorted((str(one["code"]), one.get("uav")) for one in warnings if one["code"] != "uav_in_air" and one.get("uav") is not None)


def _bases_are_there(mission: Mission) -> bool:
    """Whether the routes that land at bases still do."""
    landings = mission.routes.exclude(base_name="").values_list("base_name", "lands_at")
    places = dict(Base.objects.filter(organisation=mission.organisation).values_list("name", "location"))
    return all(name in places and at is not None and at.equals_exact(places[name], 1e-7) for name, at in landings)


def _value(mission: Mission, objective: Objective) -> float:
    """Return what the objective counts of the stored routes."""
    flown = mission.routes.filter(geometry__isnull=False)
    if objective is Objective.TOTAL:
        return mission.total_length_m or 0.0
    if objective is Objective.ENERGY:
        return mission.total_energy_wh or 0.0
    if objective is Objective.TIME:
        return float(flown.aggregate(value=Sum("duration_s"))["value"] or 0.0)
    return float(flown.aggregate(value=Max(F("departs_s") + F("duration_s")))["value"] or 0.0)
