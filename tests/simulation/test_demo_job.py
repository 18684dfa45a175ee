"""The job that makes the demo missions does one thing at a time: between them its worker is free for rehearsals and plans of users."""

from collections.abc import Callable
from datetime import timedelta
from typing import Any

import pytest
from django.core.management import call_command
from django.utils import timezone

from config.celery import app
from missions.models import CommandKind, CommandState, Mission, MissionState, UavCommand
from simulation.models import SimulatedVehicle, Simulation, SimulationState
from simulation.services.demo_missions import DEMO_MISSIONS, remove_demo_data, want_demo_missions
from simulation.services.simulations import end_simulation
from simulation.tasks import fly_demo_missions
from tests.accounts.users import a_user
from tests.missions.flights import carry
from workspace.jobs.services import MAX_ATTEMPTS, requeue_lost_jobs
from workspace.models import Job, JobState, Role, User

pytestmark = pytest.mark.django_db
REAL_TIME, _planned_only, FAST = (demo.name for demo in DEMO_MISSIONS)


@pytest.fixture
def administrator(demo_region: None, db: None) -> User:
    call_command("load_demo")
    return a_user(role=Role.ADMINISTRATOR)


@pytest.fixture
def job(administrator: User) -> Job:
    return want_demo_missions(organisation=administrator.organisation, actor=administrator)


def work(job: Job) -> Job:
    """What a worker does with one message."""
    fly_demo_missions(str(job.pk))
    job.refresh_from_db()
    return job


def work_until(job: Job, is_so: Callable[[], Any], at_most: int = 12) -> None:
    for _ in range(at_most):
        if is_so():
            return
        assert work(job).is_open, job.error
    assert is_so()


def stand_ready() -> None:
    """What the simulator does."""
    SimulatedVehicle.objects.filter(state=SimulationState.WANTED).update(state=SimulationState.FLYING)


def mission_called(name: str) -> Mission:
    return Mission.objects.get(name=name)


@pytest.mark.long
def test_its_worker_is_free_while_simulated_uavs_get_ready_and_fly(job: Job) -> None:
    work_until(job, Simulation.objects.exists)
    assert mission_called(REAL_TIME).state == MissionState.APPROVED
    began = timezone.now()
    assert work(job).state == JobState.QUEUED  # no simulator is there: it waits, and not in the worker
    assert timezone.now() - began < timedelta(seconds=2)
    assert REAL_TIME in job.message
    assert [lost.pk for lost in requeue_lost_jobs()] == []  # a second has to pass
    Job.objects.update(lease_expires_at=timezone.now() - timedelta(seconds=1))
    assert [lost.pk for lost in requeue_lost_jobs()] == [job.pk]


def test_rehearsals_have_a_queue_of_their_own() -> None:
    queue_of = app.amqp.router.route
    assert queue_of({}, "simulation.tasks.make_demo_missions")["queue"].name == "planning"
    assert queue_of({}, "simulation.tasks.rehearse_mission")["queue"].name == "simulation"


@pytest.mark.long
def test_step_by_step_one_is_flown_one_is_in_flight_and_one_is_planned(job: Job) -> None:
    work_until(job, Simulation.objects.exists)
    for name in (REAL_TIME, FAST):
        work_until(job, lambda name=name: Simulation.objects.filter(mission__name=name).exists())
        stand_ready()
        for kind in (CommandKind.UPLOAD_MISSION, CommandKind.START):
            orders = UavCommand.objects.filter(mission__name=name, kind=kind)
            work_until(job, orders.exists)
            work(job)
            assert orders.count() == 1, "given once, however often it is looked at"
            carry(*(order.uav for order in orders))
    assert mission_called(REAL_TIME).state == MissionState.ACTIVE
    assert work(job).state == JobState.QUEUED
    Mission.objects.filter(name=FAST).update(state=MissionState.COMPLETED)
    assert work(job).state == JobState.DONE
    assert {mission["id"] for mission in Mission.objects.values("id")} == {*map(type(mission_called(FAST).pk), job.result["missions"])}


def planned_all(job: Job) -> None:
    work_until(job, Simulation.objects.exists)


@pytest.mark.long
def test_a_simulation_that_is_ended_by_hand_is_not_begun_again(job: Job, administrator: User) -> None:
    planned_all(job)
    end_simulation(simulation=Simulation.objects.get(), actor=administrator)
    work_until(job, lambda: Simulation.objects.filter(mission__name=FAST).exists())
    assert Simulation.objects.filter(mission__name=REAL_TIME).count() == 1


@pytest.mark.long
def test_a_command_that_fails_ends_the_job_with_the_reason(job: Job) -> None:
    planned_all(job)
    stand_ready()
    work_until(job, UavCommand.objects.exists)
    UavCommand.objects.update(state=CommandState.FAILED)
    assert work(job).state == JobState.FAILED
    why = [{"code": "command_not_taken", "params": {"uav": "Osprey 1"}}]
    assert job.error == {"code": "command_failed", "message": "Osprey 1 did not take a command.", "why": why}


@pytest.mark.long
def test_a_simulator_that_never_comes_ends_the_job(job: Job) -> None:
    planned_all(job)
    Simulation.objects.update(created_at=timezone.now() - timedelta(hours=1))
    Job.objects.update(created_at=timezone.now() - timedelta(hours=2))
    assert work(job).state == JobState.FAILED
    assert job.error is not None and job.error["code"] == "took_too_long"


@pytest.mark.long
def test_a_mission_deleted_meanwhile_is_not_planned_again(job: Job) -> None:
    work_until(job, lambda: Mission.objects.filter(name=_planned_only).exists())
    Mission.objects.filter(name=_planned_only).update(deleted_at=timezone.now())
    planned_all(job)
    assert Mission.objects.filter(name=_planned_only).count() == 1


@pytest.mark.long
def test_looks_are_no_lost_attempts(job: Job) -> None:
    """A worker that is killed after many looks has lost the job once."""
    planned_all(job)
    for _ in range(MAX_ATTEMPTS + 1):
        work(job)
    assert job.attempts > MAX_ATTEMPTS
    Job.objects.update(state=JobState.RUNNING, lease_expires_at=timezone.now() - timedelta(seconds=1))
    assert work(job).state == JobState.QUEUED


@pytest.mark.long
def test_removed_data_ends_the_job_between_two_looks(job: Job, administrator: User) -> None:
    planned_all(job)
    remove_demo_data(organisation=administrator.organisation, actor=administrator)
    assert work(job).state == JobState.CANCELLED
    assert not Mission.objects.exists()
