"""Campaigns from creation to deletion: a job plans the launch sites, all missions and the crews' days, and stores them at once."""

from dataclasses import replace
from typing import Any

from django.db import transaction
from django.utils import timezone

from inspection.geodesy import LonLat
from missions.models import Campaign, Mission, MissionState
from missions.models.missions import MAX_NAME_LENGTH
from missions.selectors.planning_context import current_airspace
from missions.selectors.resolved_targets import resolved_targets
from missions.services.mission_plans import NothingToPlan, store_plan
from missions.services.missions import create_mission, delete_mission
from missions.services.planning.planner import make_plan
from operation.reasons import Reason
from planning.airspace import zone_at
from planning.assignment.options import refuse_contradictions
from planning.campaigns.campaign import PlannedCampaign, SiteMission, Stopped, plan_campaign
from planning.campaigns.rules import CampaignRules, rules_from_json, rules_to_json
from planning.progress import OnPlanProgress, PlanProgress
from planning.request import BaseRequest, PlanRequest, request_from_json, request_to_json
from planning.solver.solver import Stop
from workspace.audit import record_change
from workspace.jobs.services import JobCancelled, create_job_within, finish_job
from workspace.models import OPEN_STATES, Job, Organisation, User
from workspace.tasks import send_job_on_commit

CAMPAIGN_TASK = "missions.tasks.plan_campaign"
MAX_OPEN_CAMPAIGNS = 3  # of a user: each plans many missions
SEARCH_S = 1.0  # for each mission


class CampaignIsPlanned(Exception):
    """Raised while a job plans the campaign."""


class MissionsInUse(Exception):
    """Raised where missions of the campaign are approved, fly, or have flown: a new schedule would not know of that."""

    def __init__(self, count: int) -> None:
        super().__init__(count)
        self.count = count


def create_campaign(*, organisation: Organisation, author: User, name: str, request: PlanRequest, rules: CampaignRules) -> Campaign:
    """Store a campaign and send the job that plans it.

    Raises InvalidRequest if a target is not on the map, NothingToPlan without UAVs or targets, or TooManyJobs.
    """
    if not (request.uavs and request.targets):
        raise NothingToPlan
    refuse_contradictions(request)
    resolved_targets(request.targets)
    with transaction.atomic():
        campaign = Campaign.objects.create(
            organisation=organisation, author=author, name=name, request=request_to_json(request), rules=rules_to_json(rules)
        )
        _send_job(campaign, author)
        _note(campaign, author, "create", before=None, after={"name": name, "targets": len(request.targets), "uavs": len(request.uavs)})
    return campaign


def plan_campaign_again(*, campaign: Campaign, actor: User, rules: CampaignRules) -> Campaign:
    """Plan it with other rules; its missions are replaced once the new ones are there.

    Raises CampaignIsPlanned, MissionsInUse or TooManyJobs.
    """
    with transaction.atomic():
        locked = Campaign.objects.select_for_update(no_key=True).get(pk=campaign.pk)
        if locked.job and Job.objects.filter(pk=locked.job, state__in=OPEN_STATES).exists():
            raise CampaignIsPlanned
        _refuse_missions_in_use(locked)
        before, locked.rules = locked.rules, rules_to_json(rules)
        locked.save(update_fields=["rules", "updated_at"])
        _send_job(locked, actor)
        _note(locked, actor, "change", before=before, after=locked.rules)
    return locked


def delete_campaign(*, campaign: Campaign, actor: User) -> None:
    """Delete the campaign, and those of its missions that are not approved yet; they can be restored. The others stay."""
    with transaction.atomic():
        locked = Campaign.objects.select_for_update().get(pk=campaign.pk)
        for mission in _missions_of(locked).filter(state__in=(MissionState.DRAFT, MissionState.PLANNED)):
            delete_mission(mission=mission, actor=actor)
        _note(locked, actor, "delete", before={"name": locked.name}, after=None)
        locked.delete()


def plan_campaign_for_job(*, job: Job, stop: Stop, on_progress: OnPlanProgress) -> None:
    """Plan the job's campaign, and store its missions, its schedule and the job's end in one transaction.

    Raises JobCancelled when the user stops it or another worker holds the job by now, MissionsInUse, TooManyMissions,
    Campaign.DoesNotExist, and what make_plan raises.
    """
    campaign = Campaign.objects.get(pk=job.parameters["campaign"])
    request, rules = request_from_json(job.parameters["request"]), rules_from_json(job.parameters["rules"])
    try:
        planned = _planned(campaign, request, rules, stop, on_progress)
    except Stopped as error:
        raise JobCancelled from error
    with transaction.atomic():
        locked = Campaign.objects.select_for_update().get(pk=campaign.pk)
        _refuse_missions_in_use(locked)
        for mission in _missions_of(locked):
            delete_mission(mission=mission, actor=job.created_by)
        order = _order(planned)
        stored = [_stored(locked, job.created_by, number, planned.missions[place]) for number, place in enumerate(order, start=1)]
        locked.schedule = _schedule_json(planned, order, stored)
        locked.planned_at = timezone.now()
        locked.save(update_fields=["schedule", "planned_at", "updated_at"])
        if not finish_job(job=job, result={"campaign": str(locked.pk)}, message=Reason("campaign_planned", {"count": len(stored)})):
            raise JobCancelled


def _send_job(campaign: Campaign, actor: User) -> None:
    targets = len(campaign.request["targets"])
    job = create_job_within(
        MAX_OPEN_CAMPAIGNS,
        organisation=campaign.organisation,
        created_by=actor,
        task=CAMPAIGN_TASK,
        parameters={"campaign": str(campaign.pk), "request": campaign.request, "rules": campaign.rules},
        message=Reason("planning_targets", {"count": targets}),
    )
    campaign.job = job.pk
    campaign.save(update_fields=["job", "updated_at"])
    send_job_on_commit(job)


def _missions_of(campaign: Campaign) -> Any:
    return Mission.objects.filter(campaign=campaign, deleted_at=None)


def _refuse_missions_in_use(campaign: Campaign) -> None:
    if count := _missions_of(campaign).exclude(state__in=(MissionState.DRAFT, MissionState.PLANNED)).count():
        raise MissionsInUse(count)


def _planned(campaign: Campaign, request: PlanRequest, rules: CampaignRules, stop: Stop, on_progress: OnPlanProgress) -> PlannedCampaign:
    places, _deleted = resolved_targets(request.targets)
    courses: list[tuple[LonLat, ...]] = [()] * len(request.targets)
    for place in places:
        courses[place.target] = place.course
    airspace = current_airspace(request)
    done = 0.0

    def make(asked: PlanRequest, share: float) -> dict[str, Any]:
        nonlocal done
        began = min(done, 0.95)

        def note(progress: PlanProgress) -> None:
            on_progress(PlanProgress(began + min(share, 0.98 - began) * progress.share, progress.message, progress.draw))

        asked = replace(asked, organisation=campaign.organisation_id)
        plan = make_plan(request=asked, stop=stop, on_progress=note, search_s=SEARCH_S)
        if stop():
            raise Stopped
        done += share
        return plan

    return plan_campaign(
        courses,
        request,
        rules,
        may_launch_at=lambda position: zone_at(position, airspace) is None,
        make_plan=make,
        stop=stop,
    )


def _order(planned: PlannedCampaign) -> list[int]:
    """Return the missions in the order in which they are flown; those that are too long for any day come last."""
    days = sorted(planned.schedule.days, key=lambda day: (day.day, day.crew))
    return [*(visit.site for day in days for visit in day.visits), *planned.schedule.too_long]


def _stored(campaign: Campaign, author: User | None, number: int, mission: SiteMission) -> Mission:
    stored = create_mission(
        organisation=campaign.organisation,
        author=author,
        name=f"{campaign.name} · {number}"[:MAX_NAME_LENGTH],
        request=mission.request,
    )
    Mission.objects.filter(pk=stored.pk).update(campaign=campaign)
    stored.campaign = campaign
    return store_plan(mission=stored, actor=author, revision=stored.revision, plan=mission.plan)


def _schedule_json(planned: PlannedCampaign, order: list[int], stored: list[Mission]) -> dict[str, Any]:
    """Return sites, missions in this order, days and what is left out; see serializers/campaigns.py."""
    number_of = {place: number for number, place in enumerate(order, start=1)}
    used = list(dict.fromkeys(planned.missions[place].site for place in order))  # in the order in which they are visited
    sites = [planned.sites[site] for site in used]
    return {
        "sites": [_site_json(site) for site in sites],
        "blocked_sites": [_site_json(site) for site in planned.blocked],
        "missions": [
            _mission_json(planned.missions[place], used, number_of[place], row, is_too_long=place in planned.schedule.too_long)
            for place, row in zip(order, stored, strict=True)
        ],
        "days": [
            {
                "day": day.day + 1,
                "crew": day.crew + 1,
                "visits": [
                    {
                        "mission": number_of[visit.site],
                        "drive_m": round(visit.drive_m),
                        "drive_s": round(visit.drive_s),
                        "arrives_s": round(visit.arrives_s),
                        "leaves_s": round(visit.leaves_s),
                    }
                    for visit in day.visits
                ],
                "back_m": round(day.back_m),
                "back_s": round(day.back_s),
                "ends_s": round(day.ends_s),
            }
            for day in sorted(planned.schedule.days, key=lambda day: (day.day, day.crew))
        ],
        "is_proven": planned.schedule.is_proven,
        "left_out": [{"target": one.target, "reason": one.reason, "why": list(one.why)} for one in planned.left_out],
    }


def _site_json(site: BaseRequest) -> dict[str, Any]:
    return {"name": site.name, "position": list(site.position)}


def _mission_json(mission: SiteMission, sites: list[int], number: int, row: Mission, *, is_too_long: bool) -> dict[str, Any]:
    return {
        "number": number,
        "mission": str(row.pk),
        "site": sites.index(mission.site),
        "targets": len(mission.visited),
        "flights": mission.flights,
        "length_m": round(mission.plan["total_length_m"]),
        "work_s": round(mission.work_s),
        "farthest_m": round(mission.farthest_m()),
        "is_too_long": is_too_long,
    }


def _note(campaign: Campaign, actor: User, action: str, *, before: Any, after: Any) -> None:
    record_change(
        organisation=campaign.organisation, actor=actor, action=action, subject_type="campaign", subject_id=campaign.pk,
        before=before, after=after,
    )  # fmt: skip
