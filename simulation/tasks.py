"""Tasks of the queue `simulation`, and of `planning` for the demo missions."""

from celery import shared_task
from celery.exceptions import SoftTimeLimitExceeded

from inspection.selectors import NoGraph
from missions.models import Mission
from missions.services.commands.refused import Refused
from operation.reasons import Reason
from simulation.models import Rehearsal
from simulation.services.demo_missions import NotThere, make_demo_missions, missions_made
from simulation.services.rehearsals import GroundChanged, PlanChanged, rehearse_for_job
from workspace.api.errors import DATABASE_UNAVAILABLE
from workspace.jobs.job_watch import JobWatch
from workspace.jobs.services import JobCancelled, confirm_cancelled, fail_job, finish_job, pause_job, start_job

SOFT_LIMIT_S = 840
HARD_LIMIT_S = 900
DEMO_INTERVAL_S = 1.0  # minimum between two steps; the queue's sweep sends the next message


@shared_task(name="simulation.tasks.make_demo_missions", soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def fly_demo_missions(job_id: str) -> None:
    """Take one step of the demo missions, and free the worker until the job's next message. Safe to run twice."""
    job = start_job(job_id=job_id)
    if job is None or job.created_by is None:
        return
    since = job.created_at
    try:
        with JobWatch(job) as watch:
            step = make_demo_missions(organisation=job.organisation, actor=job.created_by, since=since, progress=watch.progress)
        if step is not None:
            pause_job(job=job, progress=step.share, message=step.message, pause_s=DEMO_INTERVAL_S)
            return
        made = missions_made(organisation=job.organisation, since=since)
        finish_job(job=job, result={"missions": [str(key) for key in made]}, message=Reason("demo_made"))
    except JobCancelled:
        confirm_cancelled(job=job)
    except (NotThere, Mission.DoesNotExist):
        fail_job(job=job, code="no_demo_region", message=Reason("demo_region_removed"))
    except Refused as refused:
        fail_job(job=job, code=refused.reasons[0].code, message=refused.reasons[0].why)
    except (TimeoutError, SoftTimeLimitExceeded):
        fail_job(job=job, code="took_too_long", message=Reason("demo_not_flown_in_time"))
    except DATABASE_UNAVAILABLE:
        raise  # the lease expires, and the job is retried
    except Exception:
        fail_job(job=job, code="internal", message=Reason("demo_failed"))
        raise


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def rehearse_mission(job_id: str) -> None:
    """Fly a mission in simulation. Safe to run twice: one worker holds a job, and each run is stored once."""
    job = start_job(job_id=job_id)
    if job is None:
        return
    try:
        with JobWatch(job) as watch:
            rehearse_for_job(job=job, progress=watch.progress)
    except JobCancelled:
        confirm_cancelled(job=job)
    except (PlanChanged, Mission.DoesNotExist, Rehearsal.DoesNotExist):
        fail_job(job=job, code="mission_changed", message=Reason("changed_while_rehearsed"))
    except GroundChanged:
        fail_job(job=job, code="ground_changed", message=Reason("ground_changed_while_rehearsed"))
    except Refused as refused:
        fail_job(job=job, code=refused.reasons[0].code, message=refused.reasons[0].why)
    except NoGraph:
        fail_job(job=job, code="no_graph", message=Reason("no_network"))
    except SoftTimeLimitExceeded:
        fail_job(job=job, code="took_too_long", message=Reason("not_flown_in_time", {"minutes": SOFT_LIMIT_S // 60}))
    except DATABASE_UNAVAILABLE:
        raise  # the lease expires, and the job is retried
    except Exception:
        fail_job(job=job, code="internal", message=Reason("rehearsal_failed"))
        raise
