"""A real worker of the queue `simulation` that is killed with -9 in mid-flight: the rehearsal is flown by the next one."""

from datetime import timedelta
from pathlib import Path

import pytest
from django.utils import timezone

from simulation.models import Rehearsal, RehearsalRun, RehearsalTrack
from tests.missions.flights import an_operator, fleet, ground, planned
from tests.missions.test_lost_planners import kill, own_queue, wait_until, worker
from tests.missions.worlds import world
from tests.simulation.rehearsals.rehearsed import asked
from workspace import tasks
from workspace.jobs.services import LEASE_S
from workspace.models import Job, JobState

pytestmark = pytest.mark.django_db(transaction=True)


def has_flown_once() -> bool:
    """One of its runs is stored, and it is at the next."""
    tasks.requeue_lost_jobs()  # as the schedule does
    job = Job.objects.get()
    assert job.state in (JobState.QUEUED, JobState.RUNNING), (job.state, job.error)
    return RehearsalRun.objects.exclude(level="").exists()


@pytest.mark.long
def test_a_rehearsal_whose_worker_is_killed_is_taken_over(tmp_path: Path) -> None:
    here, person = world(), an_operator()
    ground(tmp_path / "ground.tif")
    rehearsal = asked(planned(person, fleet("Tern", "Gull"), [here.towers[0], here.towers[3]]), person, "calm", "strong-wind")
    with own_queue() as queue:
        with worker(queue, tmp_path) as first:
            tasks.send_job(rehearsal.job)
            wait_until(has_flown_once)
            kill(first)
        assert Job.objects.get().state == JobState.RUNNING
        (kept,) = RehearsalRun.objects.exclude(level="").values("pk", "finished_at")
        lease_ends_at = Job.objects.get().lease_expires_at
        assert lease_ends_at is not None and lease_ends_at <= timezone.now() + timedelta(seconds=LEASE_S), "it is missed within seconds"
        with worker(queue, tmp_path):

            def is_done() -> bool:
                tasks.requeue_lost_jobs()
                return Job.objects.get().state == JobState.DONE

            wait_until(is_done)
    assert Job.objects.get().attempts == 2
    assert RehearsalRun.objects.filter(**kept).exists(), "what was flown whole is not flown again"
    assert Rehearsal.objects.get().level in ("pass", "warnings")
    assert RehearsalTrack.objects.count() == 4
