"""A job's watch reports from outside the job's transaction, renews the lease and brings the wish to stop in."""

import threading
import time
from collections.abc import Callable
from datetime import timedelta
from typing import Any, TypeVar

import pytest
from django.db import connection, transaction
from django.utils import timezone

from tests.accounts.users import a_user
from workspace.jobs.job_watch import JobWatch
from workspace.jobs.services import LEASE_S, JobCancelled, cancel_job, create_job, finish_job, start_job
from workspace.models import Job, JobState

pytestmark = pytest.mark.django_db(transaction=True)

TIMEOUT_S = 60.0
OFTEN_S = 0.02
Found = TypeVar("Found")


@pytest.fixture
def job() -> Job:
    user = a_user()
    queued = create_job(organisation=user.organisation, created_by=user, task="inspection.tasks.read_proposal", parameters={})
    running = start_job(job_id=queued.pk)
    assert running is not None
    return running


def wait_until(is_so: Callable[[], bool]) -> None:
    end = time.monotonic() + TIMEOUT_S
    while not is_so():
        assert time.monotonic() < end, "it never came"
        time.sleep(OFTEN_S)


def elsewhere(look: Callable[[], Found]) -> Found:
    """What another connection sees, which knows nothing of this one's transaction."""
    found: list[Found] = []

    def run() -> None:
        try:
            found.append(look())
        finally:
            connection.close()

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    return found[0]


def stored(job: Job) -> Job:
    return elsewhere(lambda: Job.objects.get(pk=job.pk))


def test_progress_is_seen_while_the_transaction_of_the_work_is_open(job: Job) -> None:
    with JobWatch(job, interval_s=OFTEN_S) as watch, transaction.atomic():
        watch.progress("writing the zones", 0.4)
        wait_until(lambda: stored(job).message == "writing the zones")
        assert stored(job).progress == pytest.approx(0.4)


def test_the_lease_is_renewed_while_one_long_statement_runs(job: Job) -> None:
    Job.objects.update(lease_expires_at=timezone.now() + timedelta(seconds=1))
    with JobWatch(job, interval_s=OFTEN_S), connection.cursor() as cursor:
        cursor.execute("SELECT pg_sleep(0.5)")
    assert stored(job).lease_expires_at > timezone.now() + timedelta(seconds=LEASE_S / 2)


def _fails() -> dict[str, float]:
    raise IndexError("nothing to draw")


@pytest.mark.parametrize("draw", [_fails, object], ids=["cannot be drawn", "cannot be stored"])
def test_the_lease_is_renewed_whatever_becomes_of_the_drawing(job: Job, draw: Callable[[], Any]) -> None:
    Job.objects.update(lease_expires_at=timezone.now())
    with JobWatch(job, interval_s=OFTEN_S) as watch:
        watch.note(0.3, "searching", draw)
        wait_until(lambda: stored(job).message == "searching")
        assert stored(job).lease_expires_at > timezone.now()
        watch.note(0.6, "better", lambda: {"value": 7.0})
        wait_until(lambda: stored(job).best == {"value": 7.0})
        assert not watch.stop()


def test_a_wish_to_stop_reaches_the_work_at_its_next_look_and_nothing_is_written(job: Job) -> None:
    with pytest.raises(JobCancelled), JobWatch(job, interval_s=OFTEN_S) as watch, transaction.atomic():
        a_user()  # a row of the work
        elsewhere(lambda: cancel_job(job=job))
        end = time.monotonic() + TIMEOUT_S
        while time.monotonic() < end:
            watch.progress("writing", 0.5)
            time.sleep(OFTEN_S)
    assert type(job.created_by).objects.count() == 1
    assert stored(job).state == JobState.RUNNING  # the task says that it has stopped


def test_a_job_that_another_worker_took_over_is_stopped(job: Job) -> None:
    with pytest.raises(JobCancelled), JobWatch(job, interval_s=OFTEN_S) as watch:
        Job.objects.update(attempts=2)
        end = time.monotonic() + TIMEOUT_S
        while time.monotonic() < end:
            watch.check()
            time.sleep(OFTEN_S)


def test_a_job_that_ends_in_the_work_stays_ended(job: Job) -> None:
    with JobWatch(job, interval_s=OFTEN_S) as watch:
        watch.progress("writing", 0.9)
        with transaction.atomic():
            assert finish_job(job=job, message="Applied")
            time.sleep(OFTEN_S * 5)  # the thread waits for the row
    ended = stored(job)
    assert (ended.state, ended.progress, ended.message) == (JobState.DONE, 1.0, "Applied")


def test_the_thread_and_its_connection_are_gone_afterwards(job: Job) -> None:
    """By name: a count would change with whatever else comes and goes, as autovacuum and what earlier tests have left."""

    def connections() -> set[int]:
        with connection.cursor() as cursor:
            cursor.execute("SELECT pid FROM pg_stat_activity WHERE datname = current_database() AND backend_type = 'client backend'")
            return {pid for (pid,) in cursor.fetchall()}

    connections_before, threads_before = connections(), set(threading.enumerate())
    with JobWatch(job, interval_s=OFTEN_S) as watch:
        watch.progress("reading", 0.1)
        wait_until(lambda: Job.objects.get(pk=job.pk).message == "reading")
        own_connections, own_threads = connections() - connections_before, set(threading.enumerate()) - threads_before
    assert own_connections
    assert own_threads
    wait_until(lambda: not own_connections & connections())
    wait_until(lambda: not own_threads & set(threading.enumerate()))


def test_a_worker_that_is_told_to_stop_gives_the_job_back_to_whoever_is_next(job: Job) -> None:
    """Without waiting for the lease to run out; what this attempt still writes meets no row."""
    with pytest.raises(SystemExit), JobWatch(job, interval_s=OFTEN_S), transaction.atomic():
        raise SystemExit
    assert stored(job).state == JobState.QUEUED
    again = start_job(job_id=job.pk)
    assert again is not None
    assert again.attempts == job.attempts + 1
    assert not finish_job(job=job)
    assert finish_job(job=again)
