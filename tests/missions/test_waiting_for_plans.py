"""Large plans: `Prefer: wait`, and how many of them one user may have at once."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from unittest import mock

import pytest
from django.db import connection
from django.test import Client

from missions import tasks
from missions.models import MissionUav
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, patch, plan_body, post
from tests.missions.worlds import UAV_AT, World, world
from workspace.jobs import views as waiting
from workspace.jobs.services import cancel_job
from workspace.models import Job, JobState, Role

pytestmark = pytest.mark.django_db(transaction=True)

LARGE = 14


@pytest.fixture
def here() -> World:
    return world()


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


@pytest.fixture(autouse=True)
def short_search(settings: Any) -> None:
    settings.ROUTING_RULES = replace(settings.ROUTING_RULES, large_plan_search_s=0.3)


def body(here: World, **more: Any) -> dict[str, Any]:
    return plan_body(*[{"asset": here.line.pk, "position": [10.0 + 0.001 * number, 56.0]} for number in range(LARGE)], **more)


def sent_to(do: Callable[[str], object]) -> Any:
    """Instead of the queue: a thread that does this with the job."""

    def send(name: str, args: list[str], retry: bool) -> None:
        def run() -> None:
            try:
                do(args[0])
            finally:
                connection.close()

        threads.append(threading.Thread(target=run))
        threads[-1].start()

    threads: list[threading.Thread] = []
    sending = mock.patch("workspace.tasks.current_app.send_task", send)
    sending.threads = threads  # type: ignore[attr-defined]
    return sending


def wait_with(client: Client, here: World, do: Callable[[str], object], wait: str, **headers: str) -> Any:
    sending = sent_to(do)
    with sending:
        response = post(client, "plans", body(here), prefer=wait, **headers)
    for thread in sending.threads:
        thread.join()
    return response


def nothing(job_id: str) -> None:
    """No worker is there."""


def test_a_plan_that_is_done_in_time_is_the_answer(here: World, client: Client) -> None:
    response = wait_with(client, here, tasks.solve_plan, "respond-async, wait=15")
    assert (response.status_code, response["Preference-Applied"]) == (200, "wait=15")
    assert sorted(response.json()["routes"][0]["targets"]) == list(range(LARGE))
    assert response["Location"] == f"/api/v1/jobs/{Job.objects.get().pk}"


def test_a_plan_that_takes_longer_is_a_job(here: World, client: Client) -> None:
    began_s = time.monotonic()
    response = wait_with(client, here, nothing, "wait=1")
    assert (response.status_code, response["Preference-Applied"]) == (202, "wait=1")
    assert 1.0 <= time.monotonic() - began_s < 5.0
    assert Job.objects.get().state == JobState.QUEUED


def test_nobody_waits_longer_than_the_settings_allow(here: World, client: Client, settings: Any) -> None:
    settings.MAX_WAIT_S = 1.0
    assert wait_with(client, here, nothing, "wait=600")["Preference-Applied"] == "wait=1"


@pytest.mark.parametrize("wait", ["", "wait", "wait=", "wait=-3", "wait=1.5", "wait=x", "waiting=3", "wait=99999999999"])
def test_what_is_no_preference_to_wait_is_ignored(here: World, client: Client, wait: str) -> None:
    response = wait_with(client, here, nothing, wait)
    assert response.status_code == 202
    assert "Preference-Applied" not in response


def test_when_enough_requests_wait_the_next_is_answered_at_once(here: World, client: Client) -> None:
    with mock.patch.object(waiting, "_places", threading.BoundedSemaphore(1)) as places:
        assert places.acquire(blocking=False)
        response = wait_with(client, here, nothing, "wait=15")
    assert response.status_code == 202
    assert "Preference-Applied" not in response


def test_a_plan_that_fails_meanwhile_is_answered_as_an_error(here: World, client: Client) -> None:
    with mock.patch("missions.services.planning.planner.MAX_CONTEXTS", 0):
        response = wait_with(client, here, tasks.solve_plan, "wait=15")
    assert (response.status_code, response.json()["error"]["code"]) == (503, "graph_outdated")
    assert int(response["Retry-After"]) > 0


def test_the_same_key_waits_for_the_same_job(here: World, client: Client) -> None:
    first = wait_with(client, here, nothing, "wait=1", idempotency_key="a")
    tasks.solve_plan(first.json()["job"])
    second = wait_with(client, here, nothing, "wait=1", idempotency_key="a")
    assert (first.status_code, second.status_code) == (202, 200)
    assert second["Idempotency-Replayed"] == "true"
    assert Job.objects.count() == 1


def test_who_has_enough_large_plans_is_told_before_any_work(here: World, client: Client, settings: Any) -> None:
    settings.MAX_OPEN_PLANS = 2
    with mock.patch("workspace.tasks.current_app.send_task"):
        assert [post(client, "plans", body(here)).status_code for _ in range(2)] == [202, 202]
        with mock.patch("missions.views.plans.PlanInputSerializer.read", side_effect=AssertionError("worked on")):
            refused = post(client, "plans", body(here))
        assert (refused.status_code, refused.json()["error"]["code"]) == (429, "too_many_jobs")
        assert int(refused["Retry-After"]) > 0
        assert post(client, "missions", mission_body(*body(here)["targets"], plan=True)).status_code == 429
        assert post(client, "plans", plan_body(here.towers[0])).status_code == 200  # a small one needs no worker
        assert post(client_of(a_user(Role.OPERATOR)), "plans", body(here)).status_code == 202
        cancel_job(job=Job.objects.filter(created_by__isnull=False).last())
        assert post(client, "plans", body(here)).status_code == 202


def test_a_plan_that_is_made_is_stored_however_many_others_are_open(here: World, client: Client, settings: Any) -> None:
    settings.MAX_OPEN_PLANS = 2
    heron = post(client, "uavs", {"name": "Heron", "position": list(UAV_AT)}).json()
    asked = body(here) | {"uavs": [{"id": heron["id"]}]}
    made = post(client, "missions", mission_body(*asked["targets"], uavs=asked["uavs"])).json()
    MissionUav.objects.update(sensors=["LiDAR"])  # that it had when the mission was stored; no target asks for one
    with mock.patch("workspace.tasks.current_app.send_task"):
        done = post(client, "plans", asked).json()["job"]
        tasks.solve_plan(done)
        assert [post(client, "plans", asked).status_code for _ in range(2)] == [202, 202]
        stored = patch(client, f"missions/{made['id']}", {"plan": True, "plan_of": done})
        assert (stored.status_code, stored.json()["state"]) == (200, "planned")
        again = patch(client, f"missions/{made['id']}", {"plan": True})
        assert (again.status_code, int(again["Retry-After"]) > 0) == (429, True)


def test_of_requests_at_the_same_moment_none_gets_past_the_limit(here: World, settings: Any) -> None:
    settings.MAX_OPEN_PLANS = 1
    user, statuses = a_user(Role.OPERATOR), []

    def ask(client: Client) -> None:
        try:
            statuses.append(post(client, "plans", body(here)).status_code)
        finally:
            connection.close()

    with mock.patch("workspace.tasks.current_app.send_task"):
        threads = [threading.Thread(target=ask, args=[client_of(user)]) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert sorted(statuses) == [202, 429, 429, 429]
