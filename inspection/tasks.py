"""Tasks of the data queue: reading and applying files, and keeping the graph up to date."""

from collections.abc import Callable

from celery import shared_task
from celery.exceptions import SoftTimeLimitExceeded
from django.conf import settings

from inspection import services
from inspection.models import ImportProposal
from inspection.services import exports
from inspection.services.imports import subscriptions
from inspection.services.imports.uploads import forget_old_uploads as forget_uploads
from inspection.services.proposals import pipeline
from inspection.services.proposals.reading import Progress
from inspection.services.regions import delete_region_of
from operation.reasons import Reason
from workspace.api.errors import DATABASE_UNAVAILABLE
from workspace.jobs.job_watch import JobWatch
from workspace.jobs.processor_time import ProcessorTimeExceeded, processor_limit
from workspace.jobs.services import JobCancelled, confirm_cancelled, fail_job, next_waiting, start_fair_job
from workspace.models import Job
from workspace.tasks import send_job, send_job_on_commit

SOFT_LIMIT_S = 870
HARD_LIMIT_S = 900


@shared_task(time_limit=900, soft_time_limit=870)
def refresh_graph() -> None:
    """Build a graph if the map data have changed since the newest one; several changes make one build."""
    services.refresh_graph()


@shared_task(name="inspection.tasks.find_gaps", time_limit=900, soft_time_limit=870)  # as the version before sends it
def find_issues() -> None:
    """Search for issues if the map data have changed since the last search; several changes make one search, and one runs at a time."""
    services.find_issues()


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def read_proposal(job_id: str) -> None:
    """Read an incoming file and store its changes. Safe to run twice: a job is held by one worker, and finished once."""
    _work(job_id, _read_within_bounds)


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def apply_proposal(job_id: str) -> None:
    """Update the map data to a file, completely or not at all."""
    _work(job_id, pipeline.apply_proposal)


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def delete_region(job_id: str) -> None:
    """Delete a region, completely or not at all."""
    _work(job_id, delete_region_of)


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def export_register(job_id: str) -> None:
    """Write a file of a register and keep it for its user."""
    _work(job_id, exports.export_register)


@shared_task(time_limit=60, soft_time_limit=50)
def settle_proposals() -> None:
    """Settle proposals whose worker was lost."""
    for proposal in pipeline.unsettled_proposals():
        if proposal.job is not None:
            pipeline.settle_proposal_of(job=proposal.job)


@shared_task(time_limit=60, soft_time_limit=50)
def fetch_due_subscriptions() -> None:
    """Start a job for each zone set that is due to be fetched."""
    for job in subscriptions.start_due_fetches():
        send_job_on_commit(job)


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def fetch_subscription(job_id: str) -> None:
    """Fetch a zone set's next file; a new one becomes a proposal."""
    _work(job_id, _fetch)


def _read_within_bounds(*, job: Job, progress: Progress) -> None:
    with processor_limit(settings.READ_PROCESSOR_S + settings.READ_PROCESSOR_S_PER_MIB * pipeline.size_mib_of(job=job)):
        applying = pipeline.read_proposal(job=job, progress=progress)
    if applying is not None:
        send_job_on_commit(applying)


def _fetch(*, job: Job, progress: Progress) -> None:
    proposal = subscriptions.fetch_subscription(job=job, progress=progress)
    if proposal is not None:
        send_job_of(proposal)


def send_job_of(proposal: ImportProposal) -> None:
    """Send the job that reads or applies a proposal to its queue after the commit."""
    if proposal.job is not None:
        send_job_on_commit(proposal.job)


@shared_task(time_limit=300, soft_time_limit=280)
def forget_old_uploads() -> None:
    forget_uploads()


def _work(job_id: str, do: Callable[..., None]) -> None:
    job = start_fair_job(job_id=job_id, max_running=max(settings.DATA_WORKERS - 1, 1))
    if job is None:
        return
    try:
        _do(job, do)
    finally:
        if (waiting := next_waiting(task=job.task)) is not None:
            send_job(waiting)


def _do(job: Job, do: Callable[..., None]) -> None:
    try:
        with JobWatch(job) as watch:
            progress: Progress = watch.progress
            do(job=job, progress=progress)
    except JobCancelled:
        confirm_cancelled(job=job)
        pipeline.settle_proposal_of(job=job)
    except pipeline.LostJob:
        return
    except SoftTimeLimitExceeded:
        _fail(job, "took_too_long", Reason("not_read_in_time", {"minutes": SOFT_LIMIT_S // 60}))
    except ProcessorTimeExceeded:
        _fail(job, "took_too_long", Reason("too_much_processor_time"))
    except MemoryError:
        _fail(job, "too_large", Reason("too_much_memory"))
    except DATABASE_UNAVAILABLE:
        raise  # the lease runs out, and the job is retried
    except Exception:
        _fail(job, "internal", Reason("reading_failed"))
        raise


def _fail(job: Job, code: str, message: Reason) -> None:
    fail_job(job=job, code=code, message=message)
    pipeline.settle_proposal_of(job=job)
