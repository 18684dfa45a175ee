"""A task is delivered again while it still runs, and once more when it is over: the plan is made once, and no delivery does harm."""

from pathlib import Path
from typing import Any
from uuid import uuid4

import pytest
from django.conf import settings
from redis import Redis

from missions.models import Mission
from tests.accounts.users import a_user
from tests.missions.test_lost_planners import mission_to_plan, own_queue, wait_until, worker
from tests.missions.worlds import world
from workspace import tasks
from workspace.models import AuditEntry, Job, JobState, Role

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]

SEARCH_S = "12"  # four times as long as the broker waits
OFTEN = 5


class Deliveries:
    def __init__(self) -> None:
        self.key, self.redis = f"deliveries-{uuid4()}", Redis.from_url(settings.REDIS_URL)

    @property
    def number(self) -> int:
        return int(self.redis.get(self.key) or 0)


@pytest.fixture
def deliveries() -> Any:
    made = Deliveries()
    yield made
    made.redis.delete(made.key)


def environment_of(deliveries: Deliveries) -> dict[str, str]:
    return {"SPANWISE_LARGE_PLAN_SEARCH_S": SEARCH_S, "SPANWISE_TEST_DELIVERIES": deliveries.key}


def is_done() -> bool:
    return Job.objects.get().state == JobState.DONE


def done(job: Job) -> tuple[int, int, int]:
    """How often it was taken, how often its mission was planned, and by how many revisions that changed."""
    planned = AuditEntry.objects.filter(action="plan", subject_type="mission").count()
    return Job.objects.get().attempts, planned, Mission.objects.get().revision - job.parameters["revision"]


def test_a_job_longer_than_the_broker_waits_is_done_once(tmp_path: Path, deliveries: Deliveries, record_property: Any) -> None:
    job = mission_to_plan(a_user(Role.OPERATOR), world())
    more = environment_of(deliveries)
    with own_queue() as queue, worker(queue, tmp_path, app="tests.missions.property_tests.impatient_planners", processes=2, **more):
        tasks.send_job(job)
        wait_until(lambda: is_done() and deliveries.number > 1)
    record_property("figure", f"longer than the visibility timeout: delivered {deliveries.number} times, done {done(job)[1]} time")
    assert done(job) == (1, 1, 1)


def test_a_job_that_is_sent_five_times_is_done_once(tmp_path: Path, deliveries: Deliveries, record_property: Any) -> None:
    job = mission_to_plan(a_user(Role.OPERATOR), world())
    more = environment_of(deliveries)
    with own_queue() as queue, worker(queue, tmp_path, app="tests.missions.property_tests.impatient_planners", processes=2, **more):
        for _ in range(OFTEN):
            tasks.send_job(job)
        wait_until(lambda: is_done() and deliveries.number >= OFTEN)
        tasks.send_job(job)
        wait_until(lambda: deliveries.number > OFTEN)
    record_property("figure", f"sent {OFTEN} times and once more when it was over: done {done(job)[1]} time")
    assert done(job) == (1, 1, 1)
