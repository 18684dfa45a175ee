"""Sending jobs to the queue, and sending lost ones again."""

import logging
from functools import partial

from celery import current_app, shared_task
from django.db import transaction
from kombu.exceptions import OperationalError
from redis.exceptions import RedisError

from workspace.jobs import services
from workspace.models import Job
from workspace.sessions import browser_sessions

logger = logging.getLogger(__name__)


def send_job(job: Job) -> None:
    """Send the job to its queue. An unavailable queue loses nothing: the row stays, and the sweep sends it again."""
    try:
        current_app.send_task(job.task, args=[str(job.pk)], retry=False)
    except (OperationalError, RedisError, OSError) as error:
        logger.warning("job %s stays queued in the database, the queue is away: %s", job.pk, error)


def send_job_on_commit(job: Job) -> None:
    transaction.on_commit(partial(send_job, job))


@shared_task(time_limit=30, soft_time_limit=25)
def requeue_lost_jobs() -> None:
    for job in services.requeue_lost_jobs():
        send_job(job)


@shared_task(time_limit=30, soft_time_limit=25)
def forget_old_idempotency_keys() -> None:
    services.forget_old_idempotency_keys()


@shared_task(time_limit=60, soft_time_limit=50)
def forget_ended_sessions() -> None:
    browser_sessions.forget_ended_sessions()
