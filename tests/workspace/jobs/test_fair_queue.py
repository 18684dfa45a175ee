"""One organisation's jobs hold up no other's, and what has used up its time is not tried again."""

import threading
import time
from datetime import timedelta

import pytest
from django.db import connection
from django.utils import timezone

from tests.accounts.users import a_user
from workspace.jobs.processor_time import ProcessorTimeExceeded, processor_limit
from workspace.jobs.services import LEASE_S, create_job, finish_job, next_waiting, requeue_lost_jobs, start_fair_job, start_job
from workspace.models import Job, JobState, Organisation, User

READ = "inspection.tasks.read_proposal"


def user_of(name: str) -> User:
    return a_user(organisation=Organisation.objects.get_or_create(name=name)[0])


def waiting(user: User, number: int, task: str = READ) -> list[Job]:
    jobs = [create_job(organisation=user.organisation, created_by=user, task=task, parameters={}) for _ in range(number)]
    for place, job in enumerate(jobs):
        Job.objects.filter(pk=job.pk).update(created_at=timezone.now() + timedelta(milliseconds=place))
    return jobs


@pytest.mark.django_db
def test_of_one_organisation_no_more_runs_than_leaves_a_worker_to_the_others() -> None:
    many, one = waiting(user_of("Many"), 20), waiting(user_of("One"), 1)
    first = start_fair_job(job_id=many[0].pk, max_running=1)
    assert first is not None and first.pk == many[0].pk
    assert start_fair_job(job_id=one[0].pk, max_running=1).pk == one[0].pk
    assert start_fair_job(job_id=many[1].pk, max_running=1) is None
    assert Job.objects.get(pk=many[1].pk).state == JobState.QUEUED
    finish_job(job=first)
    assert next_waiting(task=READ).pk == many[1].pk
    assert start_fair_job(job_id=many[1].pk, max_running=1).pk == many[1].pk


@pytest.mark.django_db
def test_the_message_of_one_that_was_served_lately_takes_the_job_of_one_that_waits() -> None:
    many = waiting(user_of("Many"), 5)
    finish_job(job=start_fair_job(job_id=many[0].pk, max_running=1))
    one = waiting(user_of("One"), 1)
    served = []
    for message in many[1:] + one:
        job = start_fair_job(job_id=message.pk, max_running=1)
        assert job is not None
        served.append(job.pk)
        finish_job(job=job)
    assert served == [one[0].pk, *(job.pk for job in many[2:]), many[1].pk], "each once"


@pytest.mark.django_db
def test_the_message_of_a_job_that_runs_takes_another_that_waits() -> None:
    jobs = [*waiting(user_of("One"), 1), *waiting(user_of("Two"), 1)]
    taken = [start_fair_job(job_id=job.pk, max_running=1) for job in reversed(jobs)]
    assert [job and job.pk for job in taken] == [job.pk for job in jobs]


@pytest.mark.django_db
def test_jobs_of_another_app_and_of_another_task_are_not_taken() -> None:
    user = user_of("Many")
    plan, apply = waiting(user, 1, "missions.tasks.plan")[0], waiting(user_of("One"), 1, "inspection.tasks.apply_proposal")[0]
    (read,) = waiting(user, 1)
    assert start_job(job_id=plan.pk) is not None
    assert start_fair_job(job_id=read.pk, max_running=1).pk == read.pk
    assert Job.objects.get(pk=apply.pk).state == JobState.QUEUED


@pytest.mark.django_db(transaction=True)
def test_two_workers_at_once_take_two_jobs() -> None:
    jobs = [*waiting(user_of("One"), 1), *waiting(user_of("Two"), 1)]
    taken: list[Job | None] = []

    def work(job: Job) -> None:
        taken.append(start_fair_job(job_id=job.pk, max_running=1))
        connection.close()

    threads = [threading.Thread(target=work, args=[job]) for job in jobs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {job.pk for job in taken if job} == {job.pk for job in jobs}


@pytest.mark.django_db
@pytest.mark.parametrize("by", ["message", "sweep"])
def test_a_job_whose_worker_was_stopped_at_the_time_limit_is_not_tried_again(by: str, settings) -> None:
    (job,) = waiting(user_of("Many"), 1)
    assert start_job(job_id=job.pk) is not None
    now = timezone.now()
    began = now - timedelta(seconds=settings.CELERY_TASK_TIME_LIMIT + LEASE_S + 1)
    Job.objects.filter(pk=job.pk).update(started_at=began, lease_expires_at=now - timedelta(seconds=1))
    if by == "message":
        assert start_job(job_id=job.pk) is None
    else:
        assert requeue_lost_jobs() == []
    job.refresh_from_db()
    assert (job.state, job.attempts, job.error["code"]) == (JobState.FAILED, 1, "took_too_long")


@pytest.mark.long
def test_processor_time_is_bounded_and_waiting_is_not() -> None:
    with processor_limit(0.3):
        time.sleep(0.6)
    began_s = time.process_time()
    with pytest.raises(ProcessorTimeExceeded), processor_limit(0.3):
        while time.process_time() - began_s < 10.0:
            pass
    assert time.process_time() - began_s < 2.0
    while time.process_time() - began_s < 3.0:
        pass  # the bound is over
