"""Tasks: large plans in a worker that users can stop, offers, and the expiry of commands."""

from collections.abc import Callable

from celery import shared_task
from celery.exceptions import SoftTimeLimitExceeded
from django.conf import settings

from inspection.selectors import NoGraph
from missions import services
from missions.models import Campaign, Mission
from missions.services import GraphOutdated, InvalidRequest, MissionChanged, MissionFrozen, NothingToPlan, replanning
from missions.services.campaigns import MissionsInUse, plan_campaign_for_job
from missions.services.commands import commands
from missions.services.commands.planned_starts import carry_on_planned_starts
from operation.reasons import Reason
from planning.campaigns.campaign import MAX_MISSIONS, TooManyMissions
from planning.progress import OnPlanProgress, PlanProgress
from workspace.api.errors import DATABASE_UNAVAILABLE
from workspace.jobs.job_watch import JobWatch
from workspace.jobs.services import JobCancelled, confirm_cancelled, fail_job, finish_job, start_job
from workspace.models import Job, JobState
from workspace.tasks import send_job

SOFT_LIMIT_S = 540
HARD_LIMIT_S = 600
SHARES_OF_A_SEARCH = 10  # one of several searches gets this part of the time: a user waits while UAVs fly


def run_job(job_id: str, do: Callable[[Job, JobWatch], None]) -> None:
    """Take the job, do it, and store how it ended. Safe to run twice: a job is held by one worker, and finished once."""
    job = start_job(job_id=job_id)
    if job is None:
        return
    try:
        with JobWatch(job) as watch:
            do(job, watch)
    except JobCancelled:
        confirm_cancelled(job=job)
    except InvalidRequest as error:
        fail_job(job=job, code="invalid", message=next(iter(error.faults.values())))
    except NoGraph:
        fail_job(job=job, code="no_graph", message=Reason("no_network"))
    except GraphOutdated:
        fail_job(job=job, code="graph_outdated", message=Reason("zones_changing"))
    except (MissionChanged, Mission.DoesNotExist):
        fail_job(job=job, code="mission_changed", message=Reason("mission_changed"))
    except MissionFrozen:
        fail_job(job=job, code="mission_frozen", message=Reason("mission_frozen"))
    except NothingToPlan:
        fail_job(job=job, code="nothing_to_plan", message=Reason("nothing_to_plan"))
    except TooManyMissions:
        fail_job(job=job, code="too_many_missions", message=Reason("too_many_missions", {"most": MAX_MISSIONS}))
    except MissionsInUse as error:
        fail_job(job=job, code="missions_in_use", message=Reason("campaign_missions_in_use", {"count": error.count}))
    except Campaign.DoesNotExist:
        fail_job(job=job, code="campaign_deleted", message=Reason("campaign_deleted"))
    except SoftTimeLimitExceeded:
        fail_job(job=job, code="took_too_long", message=Reason("no_plan_in_time", {"minutes": SOFT_LIMIT_S // 60}))
    except DATABASE_UNAVAILABLE:
        raise  # the lease runs out, and the job is retried
    except Exception:
        fail_job(job=job, code="internal", message=Reason("planner_failed"))
        raise


def noted_by(watch: JobWatch) -> OnPlanProgress:
    def note(progress: PlanProgress) -> None:
        watch.note(progress.share, progress.message, progress.draw)

    return note


def _end_message(watch: JobWatch) -> Reason:
    return Reason("planning_stopped" if watch.is_cancelled else "planned")


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def solve_plan(job_id: str) -> None:
    """Make a plan that becomes the job's result and is not stored. If stopped, the result is the best plan found until then."""

    def do(job: Job, watch: JobWatch) -> None:
        plan = services.make_plan(
            request=services.request_from_json(job.parameters["request"]),
            stop=watch.stop,
            on_progress=noted_by(watch),
            search_s=settings.ROUTING_RULES.large_plan_search_s,
        )
        finish_job(job=job, result=plan, message=_end_message(watch))

    run_job(job_id, do)


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def plan_mission(job_id: str) -> None:
    """Plan a mission, and store the plan, or the best one found when stopped, if the mission is unchanged since the request."""

    def do(job: Job, watch: JobWatch) -> None:
        services.plan_mission_for_job(
            job=job,
            stop=watch.stop,
            on_progress=noted_by(watch),
            search_s=settings.ROUTING_RULES.large_plan_search_s,
            message=lambda: _end_message(watch),
        )

    run_job(job_id, do)


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def plan_campaign(job_id: str) -> None:
    """Plan launch sites, missions and days of a campaign, and store all of them, or nothing when stopped."""

    def do(job: Job, watch: JobWatch) -> None:
        plan_campaign_for_job(job=job, stop=watch.stop, on_progress=noted_by(watch))

    run_job(job_id, do)


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def replan_mission(job_id: str) -> None:
    """Plan the rest of a flying mission again and offer the result."""

    def do(job: Job, watch: JobWatch) -> None:
        replanning.work_out_for_job(
            job=job, stop=watch.stop, search_s=settings.ROUTING_RULES.large_plan_search_s / SHARES_OF_A_SEARCH, note=watch.note
        )

    run_job(job_id, do)


@shared_task(time_limit=60, soft_time_limit=55)
def look_after_offers() -> None:
    """Mark offers outdated, find zones that cross routes, and send the jobs of suggested offers."""
    replanning.settle_offers()
    replanning.suggest_for_zones()
    for job in Job.objects.filter(task=replanning.REPLAN, state=JobState.QUEUED, attempts=0, lease_expires_at=None):
        send_job(job)


@shared_task(time_limit=30, soft_time_limit=25)
def expire_commands() -> None:
    commands.expire_overdue()


@shared_task(time_limit=30, soft_time_limit=25)
def start_in_planned_order() -> None:
    carry_on_planned_starts()
