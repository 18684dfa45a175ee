"""Campaigns from creation to deletion: a job plans the launch sites, all missions and the crews' days, and stores them at once."""

from dataclasses import replace
from typing import Any

from django.db import transaction
from django.utils import timezone

from inspection.geodesy import LonLat
from inspection.models import Asset
from missions.models import Campaign, Mission, Uav
from missions.models.missions import MAX_NAME_LENGTH
from missions.selectors.planning_context import current_airspace
from missions.selectors.resolved_targets import resolved_targets
from missions.services.mission_plans import NothingToPlan, store_plan
from missions.services.missions import EDITABLE, create_mission, delete_mission
from missions.services.planning.planner import make_plan
from operation.reasons import Reason
from planning.assignment.options import refuse_contradictions
from planning.campaigns.campaign import PlannedCampaign, SiteMission, Stopped, at_any_site, plan_campaign
from planning.campaigns.rules import CampaignRules, LaunchSite, rules_from_json, rules_to_json
from planning.progress import OnPlanProgress, PlanProgress
from planning.request import PlanRequest, UavRequest, request_from_json, request_to_json
from planning.solver.solver import Stop
from workspace.audit import record_change
from workspace.jobs.services import JobCancelled, TooManyJobs, cancel_job, create_job, finish_job
from workspace.models import OPEN_STATES, Job, Organisation, User
from workspace.tasks import send_job_on_commit

CAMPAIGN_TASK = "missions.tasks.plan_campaign"
MAX_OPEN_CAMPAIGNS = 2  # of an organisation: each plans many missions
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
    refuse_contradictions(at_any_site(request, rules))
    resolved_targets(request.targets)
    with transaction.atomic():
        campaign = Campaign.objects.create(
            organisation=organisation,
            author=author,
            name=name,
            request=request_to_json(request),
            rules=rules_to_json(rules),
            target_count=len(request.targets),
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
        if locked.job is not None:
            for job in Job.objects.filter(pk=locked.job, state__in=OPEN_STATES):
                cancel_job(job=job)
        for mission in _missions_of(locked).filter(state__in=EDITABLE):
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
        Mission.objects.filter(campaign=locked).update(campaign=None)  # those that are deleted: if restored, they are of their own
        crew_of = {visit.site: day.crew for day in planned.schedule.days for visit in day.visits}
        order = _order(planned)
        stored = [
            _stored(locked, job.created_by, number, planned.missions[place], is_first_crew=crew_of.get(place, 0) == 0)
            for number, place in enumerate(order, start=1)
        ]
        locked.schedule = _schedule_json(planned, order, stored)
        locked.planned_at = timezone.now()
        locked.mission_count = len(stored)
        locked.day_count = max((day["day"] for day in locked.schedule["days"]), default=0)
        locked.save()
        if stop() or not finish_job(
            job=job, result={"campaign": str(locked.pk)}, message=Reason("campaign_planned", {"count": len(stored)})
        ):
            raise JobCancelled


def _send_job(campaign: Campaign, actor: User) -> None:
    if Job.objects.filter(organisation=campaign.organisation, task=CAMPAIGN_TASK, state__in=OPEN_STATES).count() >= MAX_OPEN_CAMPAIGNS:
        raise TooManyJobs(MAX_OPEN_CAMPAIGNS)
    job = create_job(
        organisation=campaign.organisation,
        created_by=actor,
        task=CAMPAIGN_TASK,
        parameters={"campaign": str(campaign.pk), "request": campaign.request, "rules": campaign.rules},
        message=Reason("planning_targets", {"count": campaign.target_count}),
    )
    campaign.job = job.pk
    campaign.save(update_fields=["job", "updated_at"])
    send_job_on_commit(job)


def _missions_of(campaign: Campaign) -> Any:
    return Mission.objects.filter(campaign=campaign, deleted_at=None)


def _refuse_missions_in_use(campaign: Campaign) -> None:
    if count := _missions_of(campaign).exclude(state__in=EDITABLE).count():
        raise MissionsInUse(count)


def _planned(campaign: Campaign, request: PlanRequest, rules: CampaignRules, stop: Stop, on_progress: OnPlanProgress) -> PlannedCampaign:
    request = _as_there(request)
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
            on_progress(PlanProgress(began + min(share, 0.98 - began) * progress.share, progress.message))

        asked = replace(asked, organisation=campaign.organisation_id)
        plan = make_plan(request=asked, stop=stop, on_progress=note, search_s=SEARCH_S)
        if stop():
            raise Stopped
        done += share
        return plan

    return plan_campaign(courses, request, rules, airspace=airspace, make_plan=make, stop=stop)


def _as_there(request: PlanRequest) -> PlanRequest:
    """Return the request without assets and stored UAVs that were deleted since the campaign was created."""
    named = [target.asset for target in request.targets if target.asset is not None]
    assets = set(Asset.objects.filter(pk__in=named).values_list("pk", flat=True))
    uavs = set(Uav.objects.filter(pk__in=[uav.uav for uav in request.uavs if uav.uav is not None]).values_list("pk", flat=True))
    return replace(
        request,
        uavs=tuple(uav if uav.uav in uavs else _unlinked(uav) for uav in request.uavs),
        targets=tuple(
            target if target.asset is None or target.asset in assets else replace(target, asset=None, position=None, stretch=None)
            for target in request.targets
        ),
    )


def _unlinked(uav: UavRequest) -> UavRequest:
    """Return a UAV with the same figures that is no stored one."""
    return replace(uav, uav=None, own_figures=(), fleet_figures={})


def _order(planned: PlannedCampaign) -> list[int]:
    """Return the missions in the order in which they are flown; those that are too long for any day come last."""
    return [*(visit.site for day in planned.schedule.days for visit in day.visits), *planned.schedule.too_long]


def _stored(campaign: Campaign, author: User | None, number: int, mission: SiteMission, *, is_first_crew: bool) -> Mission:
    """Store a mission with its plan. The UAVs of the request are those of the first crew; others carry some of the same figures."""
    request = mission.request if is_first_crew else replace(mission.request, uavs=tuple(map(_unlinked, mission.request.uavs)))
    stored = create_mission(
        organisation=campaign.organisation, author=author, name=f"{campaign.name} · {number}"[:MAX_NAME_LENGTH], request=request
    )
    Mission.objects.filter(pk=stored.pk).update(campaign=campaign)
    stored.campaign = campaign
    return store_plan(mission=stored, actor=author, revision=stored.revision, plan=mission.plan)


def _schedule_json(planned: PlannedCampaign, order: list[int], stored: list[Mission]) -> dict[str, Any]:
    """Return sites, missions in this order, days and unassigned targets; see serializers/campaigns.py."""
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
            for day in planned.schedule.days
        ],
        "is_proven": planned.schedule.is_proven,
        "unassigned": [
            {"target": one.target, "reason": one.reason, "why": [reason.to_json() for reason in one.why]} for one in planned.unassigned
        ],
    }


def _site_json(site: LaunchSite) -> dict[str, Any]:
    return {"name": site.name, "position": list(site.position), "is_required": site.is_required}


def _mission_json(mission: SiteMission, sites: list[int], number: int, row: Mission, *, is_too_long: bool) -> dict[str, Any]:
    return {
        "number": number,
        "mission": str(row.pk),
        "site": sites.index(mission.site),
        "targets": len(mission.flown),
        "flights": mission.flights,
        "length_m": round(mission.plan["total_length_m"]),
        "work_s": round(mission.work_s),
        "farthest_m": round(mission.farthest_m()),
        "warnings": len(mission.plan["warnings"]),
        "is_too_long": is_too_long,
    }


def _note(campaign: Campaign, actor: User, action: str, *, before: Any, after: Any) -> None:
    record_change(
        organisation=campaign.organisation, actor=actor, action=action, subject_type="campaign", subject_id=campaign.pk,
        before=before, after=after,
    )  # fmt: skip
