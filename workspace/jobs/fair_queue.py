"""Whose job is next: of those that wait that of the organisation served longest ago, and of one no more than leave a worker free."""

from datetime import timedelta
from uuid import UUID

from django.db import transaction
from django.db.models import Count, Max, Min, Q
from django.utils import timezone

from workspace.jobs.services import start_job
from workspace.leases import lock_until_end
from workspace.models import Job, JobState

TURNS_LOCK = 0x05A7_0030  # advisory lock: one worker at a time chooses
REMEMBERED = timedelta(hours=1)  # for which it counts who was served


def start_fair_job(*, job_id: UUID | str, max_running: int) -> Job | None:
    """Take the job that the message is about, or one of the same task whose organisation waits for its turn in its place.

    None where none waits, and where each organisation that waits has `max_running` running jobs of the app: these wait until one of them
    ends. A job whose worker was lost goes on before any other.
    """
    with transaction.atomic():
        lock_until_end(TURNS_LOCK)
        job = Job.objects.filter(pk=job_id).first()
        if job is None:
            return None
        next_id = job.pk if job.state == JobState.RUNNING and not job.is_held else _next_of(job, max_running)
        return None if next_id is None else start_job(job_id=next_id)


def next_waiting(*, task: str) -> Job | None:
    """The oldest job of the task's app that waits; its message is to be sent again where one has just ended."""
    return Job.objects.filter(state=JobState.QUEUED, task__startswith=_app(task)).order_by("created_at").first()


def _next_of(job: Job, max_running: int) -> UUID | None:
    now = timezone.now()
    is_running = Q(state=JobState.RUNNING, lease_expires_at__gt=now)
    lately = Job.objects.filter(Q(started_at__gte=now - REMEMBERED) | Q(state=JobState.RUNNING), task__startswith=_app(job.task)).order_by()
    rows = lately.values_list("organisation").annotate(running=Count("pk", filter=is_running), last=Max("started_at"))
    served = {organisation: (running, last) for organisation, running, last in rows}
    waiting = Job.objects.filter(state=JobState.QUEUED, task=job.task).order_by()
    turns = []
    for organisation, first in waiting.values_list("organisation").annotate(first=Min("created_at")):
        running, last = served.get(organisation, (0, now - REMEMBERED))
        if running < max_running:
            turns.append((running, last, first, organisation))
    if not turns:
        return None
    turn = min(turns)[3]
    if job.state == JobState.QUEUED and job.organisation_id == turn:
        return job.pk
    return waiting.filter(organisation=turn).order_by("created_at").values_list("pk", flat=True).first()


def _app(task: str) -> str:
    return task.partition(".")[0] + "."
