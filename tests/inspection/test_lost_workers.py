"""A worker that is killed in the middle of a file: the next one reads it, and nothing of the first is left."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from urllib.parse import quote
from uuid import uuid4

import pytest
from django.conf import settings
from django.db import connection
from django.utils import timezone

from inspection.models import ImportKind, ImportProposal, NoFlyZone, ProposedChange, ZoneSet
from inspection.services.imports.uploads import store_upload
from inspection.services.proposals.pipeline import ask_to_apply, start_proposal
from inspection.tasks import apply_proposal, read_proposal
from tests.accounts.users import a_user
from workspace.jobs.job_watch import INTERVAL_S
from workspace.jobs.services import cancel_job, requeue_lost_jobs
from workspace.models import Job, JobState, Role, User

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]

TIMEOUT_S = 60.0
RING = b"[[9,47],[9.1,47],[9.1,47.1],[9,47]]"
ZONE = b'{"type":"Feature","id":"A","properties":{"name":"A"},"geometry":{"type":"Polygon","coordinates":[' + RING + b"]}}"


@contextmanager
def worker(queue: str, state_dir: Path) -> Iterator[subprocess.Popen[bytes]]:
    """A real Celery worker with a process pool on the test's database."""
    at = connection.settings_dict
    who = quote(at["USER"], safe="") + (f":{quote(at['PASSWORD'], safe='')}" if at["PASSWORD"] else "")
    port = f":{at['PORT']}" if at["PORT"] else ""
    environment = os.environ | {
        "DATABASE_URL": f"postgis://{who}@{quote(at['HOST'], safe='')}{port}/{at['NAME']}",
        "REDIS_URL": settings.REDIS_URL,
        "SPANWISE_VAR": str(state_dir),
    }
    command = [sys.executable, "-m", "celery", "--app", "config.celery", "--quiet", "worker", "--queues", queue, "--concurrency", "1"]
    process = subprocess.Popen(  # noqa: S603
        [*command, "--without-mingle", "--without-gossip", "--without-heartbeat", "--loglevel", "ERROR"],
        cwd=settings.BASE_DIR,
        env=environment,
        start_new_session=True,
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@contextmanager
def table_held(model: type) -> Iterator[None]:
    """Nobody gets past this table meanwhile: whoever needs it stands in the middle of the work."""
    held, done = threading.Event(), threading.Event()

    def hold() -> None:
        with connection.cursor() as cursor:
            cursor.execute("BEGIN")
            cursor.execute(f"LOCK TABLE {model._meta.db_table} IN ACCESS EXCLUSIVE MODE")
            held.set()
            done.wait()
            cursor.execute("ROLLBACK")
        connection.close()

    thread = threading.Thread(target=hold)
    thread.start()
    held.wait()
    try:
        yield
    finally:
        done.set()
        thread.join()


def wait_until(is_so: Callable[[], bool]) -> None:
    end = time.monotonic() + TIMEOUT_S
    while not is_so():
        assert time.monotonic() < end, "it never came"
        time.sleep(0.1)


def someone_waits_for(model: type) -> bool:
    with connection.cursor() as cursor:
        cursor.execute("SELECT count(*) FROM pg_locks WHERE NOT granted AND relation = %s::regclass", [model._meta.db_table])
        return bool(cursor.fetchone()[0])


def kill(process: subprocess.Popen[bytes]) -> None:
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def lose_lease() -> None:
    Job.objects.filter(state=JobState.RUNNING).update(lease_expires_at=timezone.now() - timedelta(seconds=1))
    Job.objects.update(created_at=timezone.now() - timedelta(minutes=5))


def proposal_of(curator: User) -> ImportProposal:
    upload = store_upload(file_name="zones.geojson", chunks=[ZONE], created_by=curator)
    return start_proposal(kind=ImportKind.ZONES, upload=upload, file_name="zones.geojson", parameters={}, provenance={}, created_by=curator)


def test_a_file_whose_reader_and_applier_were_killed_is_read_and_applied_once_and_nothing_of_them_is_left(tmp_path: Path) -> None:
    queue = f"lost-{uuid4()}"
    curator = a_user(Role.CURATOR)
    proposal = proposal_of(curator)
    left = lambda: list((tmp_path / "uploads").glob("*/*"))  # noqa: E731

    with worker(queue, tmp_path) as first, table_held(ZoneSet):
        read_proposal.apply_async([str(proposal.job_id)], queue=queue)
        wait_until(lambda: someone_waits_for(ZoneSet))
        assert len(left()) == 1
        kill(first)
    lose_lease()
    assert [job.pk for job in requeue_lost_jobs()] == [proposal.job_id]
    assert ProposedChange.objects.count() == 0

    with worker(queue, tmp_path) as second:
        read_proposal.apply_async([str(proposal.job_id)], queue=queue)
        wait_until(lambda: ImportProposal.objects.get().state == "ready")
        assert left() == []
        assert ProposedChange.objects.count() == 1

        applying = ask_to_apply(proposal=proposal, parameters={}, actor=curator)
        with table_held(NoFlyZone):
            apply_proposal.apply_async([str(applying.job_id)], queue=queue)
            wait_until(lambda: someone_waits_for(NoFlyZone))
            kill(second)
    assert not NoFlyZone.objects.exists()
    assert ImportProposal.objects.get().state == "applying"
    lose_lease()
    assert [job.pk for job in requeue_lost_jobs()] == [applying.job_id]

    with worker(queue, tmp_path):
        apply_proposal.apply_async([str(applying.job_id)], queue=queue)
        wait_until(lambda: ImportProposal.objects.get().state == "applied")
    assert [zone.name for zone in NoFlyZone.objects.all()] == ["A"]
    assert left() == []
    assert Job.objects.get(pk=applying.job_id).attempts == 2


def test_a_reading_that_is_cancelled_in_the_middle_of_a_long_statement_ends_and_leaves_nothing(tmp_path: Path) -> None:
    queue = f"lost-{uuid4()}"
    proposal = proposal_of(a_user(Role.CURATOR))
    with worker(queue, tmp_path):
        with table_held(ZoneSet):
            read_proposal.apply_async([str(proposal.job_id)], queue=queue)
            wait_until(lambda: someone_waits_for(ZoneSet))
            cancel_job(job=proposal.job)
            time.sleep(2 * INTERVAL_S + 0.5)  # the watch looks once a second
        wait_until(lambda: ImportProposal.objects.get().state == "discarded")
    assert Job.objects.get().state == JobState.CANCELLED
    assert not ProposedChange.objects.exists()
    assert list((tmp_path / "uploads").glob("*/*")) == []
