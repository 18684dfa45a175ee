"""Planning workers that are killed with -9 in the middle of plans: every job ends once, none is lost."""

import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any
from unittest import mock
from urllib.parse import quote
from uuid import uuid4

import pytest
from celery import current_app
from django.conf import settings
from django.db import connection
from django.utils import timezone

from missions.models import Mission
from missions.services import PlanRequest, TargetRequest, UavRequest, create_mission
from planning.problem import Objective
from planning.request import EndAction
from tests.accounts.users import a_user
from tests.missions.worlds import UAV_AT, World, world
from workspace import tasks
from workspace.jobs.services import LEASE_S, create_job
from workspace.models import AuditEntry, Job, JobState, Role, User

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]

TIMEOUT_S = 420.0
LARGE = 14
KILLS = 20
JOBS = 100


def environment(state_dir: Path, **more: str) -> dict[str, str]:
    """What leads a worker to the test's database."""
    at = connection.settings_dict
    who = quote(at["USER"], safe="") + (f":{quote(at['PASSWORD'], safe='')}" if at["PASSWORD"] else "")
    port = f":{at['PORT']}" if at["PORT"] else ""
    servers = {"DATABASE_URL": f"postgis://{who}@{quote(at['HOST'], safe='')}{port}/{at['NAME']}", "REDIS_URL": settings.REDIS_URL}
    return os.environ | servers | {"SPANWISE_VAR": str(state_dir)} | more


@contextmanager
def worker(
    queue: str, state_dir: Path, *, app: str = "config.celery", processes: int = 1, **more: str
) -> Iterator[subprocess.Popen[bytes]]:
    """A real Celery worker with a process pool."""
    command = [
        sys.executable,
        "-m",
        "celery",
        "--app",
        app,
        "--quiet",
        "worker",
        "--queues",
        queue,
        "--concurrency",
        str(processes),
    ]
    process = subprocess.Popen(  # noqa: S603
        [*command, "--hostname", f"{uuid4()}@%h", "--without-mingle", "--without-gossip", "--without-heartbeat", "--loglevel", "ERROR"],
        cwd=settings.BASE_DIR,
        env=environment(state_dir, **more),
        start_new_session=True,
    )
    try:
        yield process
    finally:
        kill(process)


def kill(process: subprocess.Popen[bytes]) -> None:
    """The worker with its pool, without a word."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextmanager
def own_queue() -> Iterator[str]:
    """Every job goes to a queue of this test."""
    queue, original = f"planners-{uuid4()}", current_app.send_task

    def send(name: str, args: list[str], retry: bool) -> Any:
        return original(name, args=args, queue=queue, retry=retry)

    with mock.patch("workspace.tasks.current_app.send_task", send):
        yield queue


def wait_until(is_so: Callable[[], bool], patience_s: float = TIMEOUT_S) -> None:
    end_s = time.monotonic() + patience_s
    while not is_so():
        assert time.monotonic() < end_s, "it never came"
        time.sleep(0.1)


def mission_to_plan(author: User, here: World) -> Job:
    """A mission of many targets, and the job that plans it; the effect of the job is the mission's one new revision."""
    request = PlanRequest(
        (UavRequest("Tern", UAV_AT, None, 12.0, EndAction.HOVER),),
        tuple(TargetRequest(here.line.pk, type(UAV_AT)(10.0 + 0.001 * number, 56.0)) for number in range(LARGE)),
        Objective.TOTAL,
        False,
    )
    mission = create_mission(organisation=author.organisation, author=author, name="Lost", request=request)
    parameters = {"mission": str(mission.pk), "revision": mission.revision}
    return create_job(organisation=author.organisation, created_by=author, task="missions.tasks.plan_mission", parameters=parameters)


def test_a_plan_whose_worker_is_killed_is_taken_over(tmp_path: Path) -> None:
    job = mission_to_plan(a_user(Role.OPERATOR), world())
    with own_queue() as queue:
        with worker(queue, tmp_path, SPANWISE_LARGE_PLAN_SEARCH_S="60") as first:
            tasks.send_job(job)
            wait_until(lambda: Job.objects.get().state == JobState.RUNNING)
            kill(first)
        killed_s = time.monotonic()
        with worker(queue, tmp_path, SPANWISE_LARGE_PLAN_SEARCH_S="0.3"):

            def is_done() -> bool:
                tasks.requeue_lost_jobs()
                return Job.objects.get().state == JobState.DONE

            wait_until(is_done)
    assert time.monotonic() - killed_s < 4 * LEASE_S  # a busy machine takes its time to start a worker
    assert Job.objects.get().attempts == 2
    assert list(Mission.objects.values_list("revision", flat=True)) == [job.parameters["revision"] + 1]


def test_twenty_killed_workers_lose_no_job_and_end_none_twice(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], record_property: Any
) -> None:
    author, here, draw = a_user(Role.OPERATOR), world(), random.Random(5)
    jobs = [mission_to_plan(author, here) for _ in range(JOBS)]
    killed_at_work = 0
    with own_queue() as queue, ExitStack() as stack:

        def new_worker() -> subprocess.Popen[bytes]:
            return stack.enter_context(worker(queue, tmp_path, SPANWISE_LARGE_PLAN_SEARCH_S="0.7", processes=2))

        began_s = time.monotonic()
        for job in jobs:
            tasks.send_job(job)
        for _ in range(KILLS):
            begun_at, victim = timezone.now(), new_worker()

            def is_at_work(since: datetime = begun_at) -> bool:
                tasks.requeue_lost_jobs()  # beat does this every three seconds
                return Job.objects.filter(started_at__gt=since).exists()

            wait_until(is_at_work)
            time.sleep(draw.uniform(0.0, 3.0))
            killed_at_work += Job.objects.filter(state=JobState.RUNNING, started_at__gt=begun_at).exists()
            kill(victim)
        new_worker()

        def is_over() -> bool:
            tasks.requeue_lost_jobs()
            return not Job.objects.filter(state__in=(JobState.QUEUED, JobState.RUNNING)).exists()

        wait_until(is_over)
        took_s = time.monotonic() - began_s
    ended = Counter(Job.objects.values_list("state", flat=True))
    plans = Counter(AuditEntry.objects.filter(action="plan", subject_type="mission").values_list("subject_id", flat=True))
    attempts = sum(Job.objects.values_list("attempts", flat=True))
    record_property("figure", f"{KILLS} kills ({killed_at_work} at work), {JOBS} jobs, {attempts} attempts, {ended[JobState.DONE]} done")
    with capsys.disabled():
        print(f"\n{KILLS} kills ({killed_at_work} with jobs running), {JOBS} jobs, {attempts} attempts, {dict(ended)}, {took_s:.0f} s")
    assert ended == {JobState.DONE: JOBS}
    assert len(plans) == JOBS
    assert set(plans.values()) == {1}
    revisions = dict(Mission.objects.values_list("pk", "revision"))
    assert {str(key): revision for key, revision in revisions.items()} == {
        job.parameters["mission"]: job.parameters["revision"] + 1 for job in jobs
    }
