"""Jobs from request to result: claimed with a lease, reported, ended, cancelled, and requeued where a worker was lost."""

from datetime import timedelta
from functools import partial
from typing import Any
from uuid import UUID

from celery import current_app
from django.conf import settings
from django.db import transaction
from django.db.models import Count, F, Max, Min, Q, QuerySet
from django.db.models.functions import Now
from django.utils import timezone
from django.utils.translation import gettext as _

from operation.reasons import Reason, Why
from workspace.leases import from_now, is_free, lock_until_end, release
from workspace.live.changes import publish_job
from workspace.models import (
    OPEN_STATES,
    IdempotencyKey,
    Job,
    JobState,
    Organisation,
    User,
)
from workspace.reason_texts import message_json, text_and_column, why_of_column

LEASE_S = 15  # without a renewal for this long a worker counts as dead; it renews once a second
QUEUE_TIMEOUT_S = 30  # a queued job that no worker took for this long is sent again
MAX_ATTEMPTS = 5
_ATTEMPTS_BEFORE = "attempts_before_pause"  # key in a job's parameters
IDEMPOTENCY_KEPT = timedelta(hours=48)


class JobCancelled(Exception):
    """Raised when a user has cancelled the job."""


class JobLost(JobCancelled):
    """Raised when another worker holds the job, or it has ended: this worker's results are discarded."""


class TooManyJobs(Exception):
    """Raised when the user has the maximum number of jobs waiting and running."""

    def __init__(self, limit: int) -> None:
        super().__init__(_("%(limit)s of your jobs are waiting or running already. Wait for one, or stop it.") % {"limit": limit})


def create_job(*, organisation: Organisation, created_by: User | None, task: str, parameters: dict[str, Any], message: Why = "") -> Job:
    return Job.objects.create(
        organisation=organisation, created_by=created_by, task=task, parameters=parameters, **message_columns(message)
    )


def create_job_within(
    limit: int, *, organisation: Organisation, created_by: User, task: str, parameters: dict[str, Any], message: Why = ""
) -> Job:
    """Create a job for a user with fewer than `limit` open jobs of this app. Raises TooManyJobs; concurrent calls are serialised."""
    with transaction.atomic():
        User.objects.select_for_update(no_key=True).filter(pk=created_by.pk).values_list("pk").first()
        refuse_jobs_beyond(limit, user=created_by, task=task)
        return create_job(organisation=organisation, created_by=created_by, task=task, parameters=parameters, message=message)


def refuse_jobs_beyond(limit: int, *, user: User, task: str) -> None:
    """Raise TooManyJobs when the user has at least `limit` open jobs of the task's app."""
    app = task.partition(".")[0]
    if Job.objects.filter(created_by=user, state__in=OPEN_STATES, task__startswith=f"{app}.").count() >= limit:
        raise TooManyJobs(limit)


def start_job(*, job_id: UUID | str) -> Job | None:
    """Claim the job for this worker, or return None if it is finished, cancelled or held by another worker."""
    with transaction.atomic():
        job = Job.objects.select_for_update().filter(pk=job_id).first()
        if job is None or not job.is_open:
            return None
        if job.is_held:
            return None
        if job.cancel_requested_at is not None:
            confirm_cancelled(job=job)
            return None
        if job.state == JobState.RUNNING and (_attempts_lost(job) >= MAX_ATTEMPTS or _has_used_its_time(job)):
            _give_up(job)
            return None
        values = {"state": JobState.RUNNING, "attempts": F("attempts") + 1, "started_at": Now(), "best": None}
        Job.objects.filter(pk=job.pk).update(**values, lease_expires_at=from_now(LEASE_S))
        job.refresh_from_db()
        transaction.on_commit(partial(publish_job, job.pk))
    return job


def report_progress(*, job: Job, progress: float, message: Why = "", best: Any = None) -> None:
    """Store the progress and the best result so far if there is a new one, and renew the lease.

    Raises JobCancelled when the user has cancelled the job (the lease is renewed, so that results can still be stored), and JobLost when
    this worker no longer holds the job.
    """
    held = _held(job)
    values: dict[str, Any] = {"lease_expires_at": from_now(LEASE_S)}
    reported = values | {"progress": min(max(progress, 0.0), 1.0), **message_columns(message)} | ({} if best is None else {"best": best})
    if not held.filter(cancel_requested_at=None).update(**reported):
        raise JobCancelled if held.update(**values) else JobLost
    publish_job(job.pk)


def release_job(*, job: Job) -> bool:
    """Release the job of a stopping worker: the next receiver of its message continues it without waiting for the lease."""
    return bool(release(_held(job), after_s=LEASE_S, state=JobState.QUEUED))


def pause_job(*, job: Job, progress: float, message: Why, pause_s: float) -> None:
    """Requeue a job that waits for something; the sweep sends it again after `pause_s`.

    Attempts until now no longer count as lost. A cancelled job ends. Nothing happens if another worker has taken it over.
    """
    parameters = job.parameters | {_ATTEMPTS_BEFORE: job.attempts}
    reported = {"progress": progress, **message_columns(message), "parameters": parameters}
    if release(_held(job).filter(cancel_requested_at=None), after_s=pause_s, state=JobState.QUEUED, **reported):
        publish_job(job.pk)
    else:
        confirm_cancelled(job=job)


def _attempts_lost(job: Job) -> int:
    """Return the number of lost attempts since the last pause, or in total."""
    return job.attempts - int(job.parameters.get(_ATTEMPTS_BEFORE, 0))


def cancel_is_requested(*, job: Job) -> bool:
    return not _held(job).filter(cancel_requested_at=None).exists()


def finish_job(*, job: Job, result: Any = None, message: Why = "") -> bool:
    """Store the result once. Returns False if another worker finished the job, or the user cancelled it, in the meantime."""
    return _end(job, state=JobState.DONE, progress=1.0, result=result, **message_columns(message))


def fail_job(*, job: Job, code: str, message: Why) -> None:
    _end(job, state=JobState.FAILED, error={"code": code, **message_json(message)}, **message_columns(message))


def message_of(job: Job) -> Why:
    """Return the job's last message, to be stored elsewhere."""
    return why_of_column(job.message_why, job.message)


def message_columns(message: Why) -> dict[str, Any]:
    text, column = text_and_column(message, 300)
    return {"message": text, "message_why": column}


def _end(job: Job, **values: Any) -> bool:
    """End the job if this attempt still holds it; an attempt that lost its lease changes nothing."""
    ended = bool(release(_held(job), **values, best=None, finished_at=timezone.now()))
    if ended:
        transaction.on_commit(partial(publish_job, job.pk))
    return ended


def _held(job: Job) -> QuerySet[Job]:
    """Return the job's row while this attempt holds it; the attempt takes the place of the holder's name in other leases."""
    return Job.objects.filter(pk=job.pk, state=JobState.RUNNING, attempts=job.attempts)


def _has_used_its_time(job: Job) -> bool:
    """Whether its worker was stopped at the time limit: a retry would end the same way, and occupy a worker as long."""
    if job.started_at is None or job.lease_expires_at is None:
        return False
    last_message_s = (job.lease_expires_at - job.started_at).total_seconds() - LEASE_S
    limit_s = getattr(current_app.tasks.get(job.task), "soft_time_limit", None) or settings.CELERY_TASK_SOFT_TIME_LIMIT
    return last_message_s >= limit_s


def _give_up(job: Job) -> None:
    if _has_used_its_time(job):
        fail_job(job=job, code="took_too_long", message=Reason("job_time_limit"))
        return
    fail_job(job=job, code="worker_lost", message=Reason("worker_lost", {"times": MAX_ATTEMPTS}))


def confirm_cancelled(*, job: Job) -> None:
    """Record that a worker has stopped on request. Nothing happens if another worker has taken the job over since."""
    _end(job, state=JobState.CANCELLED, **message_columns(Reason("job_cancelled")))


def cancel_job(*, job: Job) -> Job:
    """Cancel a job: at once if it is queued, else at the worker's next report. A finished job is unchanged."""
    now = timezone.now()
    with transaction.atomic():
        locked = Job.objects.select_for_update().get(pk=job.pk)
        if locked.is_open:
            locked.cancel_requested_at = locked.cancel_requested_at or now
            if locked.state == JobState.QUEUED:
                locked.state = JobState.CANCELLED
                locked.message, locked.message_why = text_and_column(Reason("job_cancelled"), 300)
                locked.finished_at = now
                locked.lease_expires_at = None
            locked.save()
            transaction.on_commit(partial(publish_job, locked.pk))
    return locked


def requeue_lost_jobs() -> list[Job]:
    """Requeue jobs of dead workers and find those that no worker picked up; the caller sends them to the queue again.

    The lease of a queued job is the time until which its message is assumed to be on its way.
    """
    lost = []
    with transaction.atomic():
        for job in Job.objects.select_for_update(skip_locked=True).filter(is_free(), state=JobState.RUNNING):
            if job.cancel_requested_at is not None:
                confirm_cancelled(job=job)
            elif _attempts_lost(job) >= MAX_ATTEMPTS or _has_used_its_time(job):
                _give_up(job)
            else:
                release(Job.objects.filter(pk=job.pk), state=JobState.QUEUED)
                lost.append(job.pk)  # sent at once, however new it is
        is_due = Q(pk__in=lost) | Q(lease_expires_at=None, created_at__lt=from_now(-QUEUE_TIMEOUT_S)) | Q(lease_expires_at__lt=Now())
        jobs = list(Job.objects.select_for_update(skip_locked=True).filter(is_due, state=JobState.QUEUED))
        Job.objects.filter(pk__in=[job.pk for job in jobs]).update(lease_expires_at=from_now(QUEUE_TIMEOUT_S))
    return jobs


def forget_old_idempotency_keys() -> int:
    deleted, _ = IdempotencyKey.objects.filter(created_at__lt=timezone.now() - IDEMPOTENCY_KEPT).delete()
    return deleted


FAIR_QUEUE_LOCK = 0x05A7_0030  # advisory lock: one worker at a time chooses
REMEMBERED = timedelta(hours=1)  # how long past jobs of an organisation count


def start_fair_job(*, job_id: UUID | str, max_running: int) -> Job | None:
    """Claim the message's job, or instead one of the same task whose organisation is next in turn.

    Returns None where none waits, and where each waiting organisation has `max_running` running jobs of the app: these wait until one ends.
    A job whose worker was lost takes precedence.
    """
    with transaction.atomic():
        lock_until_end(FAIR_QUEUE_LOCK)
        job = Job.objects.filter(pk=job_id).first()
        if job is None:
            return None
        next_id = job.pk if job.state == JobState.RUNNING and not job.is_held else _next_of(job, max_running)
        return None if next_id is None else start_job(job_id=next_id)


def next_waiting(*, task: str) -> Job | None:
    """Return the oldest waiting job of the task's app; its message is sent again after a job has ended."""
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
