"""A job from its request to its end, whoever drops it on the way."""

import time
from datetime import timedelta
from typing import Any
from uuid import uuid4

import pytest
from celery import Celery
from django.conf import settings
from django.utils import timezone
from kombu.exceptions import OperationalError

from tests.accounts.users import a_user, client_of
from workspace import tasks
from workspace.jobs.services import (
    LEASE_S,
    MAX_ATTEMPTS,
    QUEUE_TIMEOUT_S,
    JobCancelled,
    JobLost,
    cancel_is_requested,
    cancel_job,
    confirm_cancelled,
    create_job,
    fail_job,
    finish_job,
    report_progress,
    requeue_lost_jobs,
    start_job,
)
from workspace.models import Job, JobState, Organisation, Role, User

pytestmark = pytest.mark.django_db


def new_job(user: User | None = None) -> Job:
    user = user or a_user()
    return create_job(organisation=user.organisation, created_by=user, task="missions.tasks.plan", parameters={"mission": "1"})


def running_job() -> Job:
    job = start_job(job_id=new_job().pk)
    assert job is not None
    return job


def lose(job: Job) -> None:
    """The worker dies: its lease runs out."""
    Job.objects.filter(pk=job.pk).update(lease_expires_at=timezone.now() - timedelta(seconds=1))


def grow_old(job: Job) -> None:
    Job.objects.filter(pk=job.pk).update(created_at=timezone.now() - timedelta(seconds=QUEUE_TIMEOUT_S + 1))


def state(job: Job) -> str:
    job.refresh_from_db()
    return job.state


def test_a_job_is_started_told_of_and_finished() -> None:
    job = running_job()
    report_progress(job=job, progress=0.5, message="half")
    assert finish_job(job=job, result={"answer": 42})
    job.refresh_from_db()
    assert (job.state, job.progress, job.result, job.attempts) == (JobState.DONE, 1.0, {"answer": 42}, 1)
    assert job.finished_at is not None


def test_two_workers_cannot_hold_one_job() -> None:
    assert start_job(job_id=running_job().pk) is None


def test_a_job_that_is_not_there_is_not_started() -> None:
    assert start_job(job_id=uuid4()) is None


def test_a_lost_job_is_taken_over_and_the_first_worker_can_no_longer_write() -> None:
    first = running_job()
    lose(first)
    second = start_job(job_id=first.pk)
    assert second is not None
    assert second.attempts == 2
    with pytest.raises(JobCancelled):
        report_progress(job=first, progress=0.9)
    assert not finish_job(job=first, result="stale")
    fail_job(job=first, code="stale", message="stale")
    confirm_cancelled(job=first)
    assert state(second) == JobState.RUNNING
    assert finish_job(job=second, result="fresh")


def test_telling_of_progress_renews_the_lease() -> None:
    job = running_job()
    lose(job)
    report_progress(job=job, progress=7.0)
    job.refresh_from_db()
    assert job.progress == 1.0
    assert job.lease_expires_at > timezone.now() + timedelta(seconds=LEASE_S - 10)


def test_a_queued_job_is_cancelled_at_once() -> None:
    job = cancel_job(job=new_job())
    assert state(job) == JobState.CANCELLED
    assert start_job(job_id=job.pk) is None


def test_a_running_job_is_asked_to_stop() -> None:
    job = running_job()
    assert not cancel_is_requested(job=job)
    assert cancel_job(job=job).state == JobState.RUNNING
    assert cancel_is_requested(job=job)
    with pytest.raises(JobCancelled):
        report_progress(job=job, progress=0.5)
    confirm_cancelled(job=job)
    assert state(job) == JobState.CANCELLED


def test_a_finished_job_stays_finished() -> None:
    job = running_job()
    finish_job(job=job, result=1)
    assert cancel_job(job=job).state == JobState.DONE
    assert job.cancel_requested_at is None


def test_a_cancelled_job_whose_worker_died_is_not_started_again() -> None:
    job = running_job()
    cancel_job(job=job)
    lose(job)
    assert start_job(job_id=job.pk) is None
    assert state(job) == JobState.CANCELLED


def test_the_sweep_queues_what_a_dead_worker_held() -> None:
    job = running_job()
    grow_old(job)
    lose(job)
    assert requeue_lost_jobs() == [job]
    assert state(job) == JobState.QUEUED
    assert start_job(job_id=job.pk) is not None


def test_the_sweep_sends_a_lost_job_at_once_however_new_it_is() -> None:
    job = running_job()
    lose(job)
    assert requeue_lost_jobs() == [job]


def test_a_worker_whose_job_was_put_back_cannot_finish_it() -> None:
    job = running_job()
    lose(job)
    requeue_lost_jobs()
    assert not finish_job(job=job, result="late")
    with pytest.raises(JobLost):
        report_progress(job=job, progress=0.9)
    assert state(job) == JobState.QUEUED


def test_the_best_so_far_is_there_until_the_job_ends() -> None:
    job = running_job()
    report_progress(job=job, progress=0.5, best={"value": 3})
    report_progress(job=job, progress=0.6)
    job.refresh_from_db()
    assert job.best == {"value": 3}
    finish_job(job=job, result=1)
    job.refresh_from_db()
    assert job.best is None


def test_a_cancelled_job_keeps_its_lease_while_the_worker_writes_up_what_it_has() -> None:
    job = running_job()
    cancel_job(job=job)
    lose(job)
    with pytest.raises(JobCancelled):
        report_progress(job=job, progress=0.5)
    assert requeue_lost_jobs() == []
    assert finish_job(job=job, result="the best until then")


def test_the_sweep_leaves_alone_what_is_worked_on_and_what_is_new() -> None:
    grow_old(running_job())
    new_job()
    assert requeue_lost_jobs() == []


def test_the_sweep_sends_what_nobody_took_once_per_patience() -> None:
    job = new_job()
    grow_old(job)
    assert requeue_lost_jobs() == [job]
    assert requeue_lost_jobs() == []
    lose(job)
    assert requeue_lost_jobs() == [job]


def test_the_sweep_gives_up_after_some_attempts() -> None:
    job = new_job()
    for _ in range(MAX_ATTEMPTS):
        assert start_job(job_id=job.pk) is not None
        lose(job)
        requeue_lost_jobs()
    assert state(job) == JobState.FAILED
    assert job.error["code"] == "worker_lost"


def test_a_message_that_comes_before_the_sweep_does_not_start_a_job_beyond_its_attempts() -> None:
    job = running_job()
    for _ in range(MAX_ATTEMPTS - 1):
        lose(job)
        assert start_job(job_id=job.pk) is not None
    lose(job)
    assert start_job(job_id=job.pk) is None
    assert state(job) == JobState.FAILED
    assert job.error["code"] == "worker_lost"


def test_the_sweep_ends_what_was_cancelled_and_lost() -> None:
    job = running_job()
    cancel_job(job=job)
    lose(job)
    assert requeue_lost_jobs() == []
    assert state(job) == JobState.CANCELLED


def test_a_queue_that_is_away_loses_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def away(*args: object, **options: object) -> None:
        raise OperationalError("no broker")

    monkeypatch.setattr("celery.current_app.send_task", away)
    job = new_job()
    tasks.send_job(job)
    assert state(job) == JobState.QUEUED


def test_a_request_does_not_wait_for_a_queue_that_is_away(monkeypatch: pytest.MonkeyPatch) -> None:
    away = Celery("away", broker="redis+socket:///nowhere/redis.sock", set_as_current=False)
    away.conf.broker_transport_options = settings.CELERY_BROKER_TRANSPORT_OPTIONS
    monkeypatch.setattr(tasks, "current_app", away)
    started_s = time.monotonic()
    tasks.send_job(new_job())
    assert time.monotonic() - started_s < 15.0  # a client without limits of its own tries for minutes


def test_the_task_sends_lost_jobs_by_their_name(monkeypatch: pytest.MonkeyPatch) -> None:
    sent = []
    monkeypatch.setattr("celery.current_app.send_task", lambda name, args, retry: sent.append((name, args)))
    job = new_job()
    grow_old(job)
    tasks.requeue_lost_jobs()
    assert sent == [("missions.tasks.plan", [str(job.pk)])]


def test_the_api_shows_a_job_to_its_organisation_alone() -> None:
    user = a_user()
    job = new_job(user)
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    shown = client_of(user).get(f"/api/v1/jobs/{job.pk}").json()
    assert shown["id"] == str(job.pk)
    assert shown["state"] == "queued"
    assert stranger.get(f"/api/v1/jobs/{job.pk}").status_code == 404
    assert stranger.post(f"/api/v1/jobs/{job.pk}/cancel").status_code == 404
    assert stranger.get("/api/v1/jobs").json() == {"results": [], "next": None}
    assert state(job) == JobState.QUEUED


def test_the_api_cancels_a_job() -> None:
    user = a_user()
    job = new_job(user)
    answer = client_of(user).post(f"/api/v1/jobs/{job.pk}/cancel")
    assert (answer.status_code, answer.json()["state"]) == (200, "cancelled")


def test_a_list_of_jobs_leaves_their_results_out(django_assert_num_queries: Any) -> None:
    user = a_user()
    jobs = [new_job(user) for _ in range(3)]
    Job.objects.update(result={"routes": []}, state=JobState.DONE)
    client = client_of(user)
    client.get("/api/v1/jobs")
    with django_assert_num_queries(3):  # session, user with organisation, jobs
        listed = client.get("/api/v1/jobs").json()["results"]
    assert len(listed) == len(jobs)
    assert "result" not in listed[0]
    assert client.get(f"/api/v1/jobs/{jobs[0].pk}").json()["result"] == {"routes": []}


def test_a_page_that_is_loaded_again_finds_the_open_jobs_of_its_user() -> None:
    user, other = a_user(), a_user()
    waiting, running, done, of_another = new_job(user), new_job(user), new_job(user), new_job(other)
    Job.objects.filter(pk=running.pk).update(state=JobState.RUNNING)
    Job.objects.filter(pk=done.pk).update(state=JobState.DONE)

    def listed(query: str) -> set[str]:
        return {job["id"] for job in client_of(user).get(f"/api/v1/jobs?{query}").json()["results"]}

    assert listed("open=true&mine=true") == {str(waiting.pk), str(running.pk)}
    assert listed("open=true") == {str(waiting.pk), str(running.pk), str(of_another.pk)}
    assert listed("mine=true") == {str(waiting.pk), str(running.pk), str(done.pk)}


def test_pages_of_jobs_follow_one_another_newest_first() -> None:
    user = a_user()
    client = client_of(user)
    jobs = [new_job(user) for _ in range(5)]
    for age, job in enumerate(reversed(jobs)):
        Job.objects.filter(pk=job.pk).update(created_at=timezone.now() - timedelta(minutes=age // 2))  # pairs of the same time
    seen, address = [], "/api/v1/jobs?limit=2&state=queued"
    while address:
        page = client.get(address).json()
        seen += [job["id"] for job in page["results"]]
        address = page["next"]
        assert address is None or address.startswith("/api/v1/jobs?")
    assert len(seen) == 5
    assert set(seen) == {str(job.pk) for job in jobs}
    times = [Job.objects.get(pk=pk).created_at for pk in seen]
    assert times == sorted(times, reverse=True)


@pytest.mark.parametrize(
    "query",
    [
        "limit=0",
        "limit=-1",
        "limit=x",
        "limit=²",
        "cursor=x",
        "cursor=WyJhIl0",
        "cursor=WzEsMl0",
        "cursor=%00",
        f"cursor={'W1tb' * 1_000}",
        "state=x",
    ],
)
def test_a_page_that_cannot_be_is_refused(query: str) -> None:
    assert client_of(a_user()).get(f"/api/v1/jobs?{query}").status_code == 400


@pytest.mark.parametrize("role", list(Role))
def test_the_page_of_the_account_offers_to_cancel_jobs_to_whoever_may(role: Role) -> None:
    user = a_user(role)
    client, job = client_of(user), new_job(user)
    offers = "data-may-cancel" in client.get("/account").content.decode()
    assert offers == (client.post(f"/api/v1/jobs/{job.pk}/cancel").status_code == 200)
    assert offers == (role != Role.VIEWER)
