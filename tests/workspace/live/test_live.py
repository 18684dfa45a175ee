"""Jobs over websockets, through the real front door: nginx, and granian behind it."""

import asyncio
import json
import socket
import subprocess
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from datetime import timedelta
from typing import Any
from uuid import uuid4

import pytest
from asgiref.sync import async_to_sync
from django.utils import timezone
from websocket import WebSocket, WebSocketBadStatusException

from tests.accounts.users import a_user
from tests.workspace.live.proxied_site import (
    TIMEOUT_S,
    Endpoint,
    close_code,
    front_endpoint,
    redis_at,
    running,
    through_its_redis,
    wait_until,
)
from workspace.api_tokens import create_api_token
from workspace.jobs.consumers import ENDED, JobConsumer
from workspace.jobs.services import cancel_job, create_job, finish_job, report_progress, start_job
from workspace.live import changes as words
from workspace.models import ApiToken, BrowserSession, Job, Organisation, User
from workspace.sessions.browser_sessions import end_session

pytestmark = pytest.mark.django_db(transaction=True)


@pytest.fixture(scope="module")
def endpoint(django_db_setup: None) -> Iterator[Endpoint]:
    with front_endpoint() as endpoint, endpoint.serves_live():
        wait_until(lambda: endpoint.is_open)
        yield endpoint


@pytest.fixture
def here(endpoint: Endpoint, settings: Any) -> Iterator[Endpoint]:
    """With a Redis of its own, which the tests' own words go through as well."""
    through_its_redis(endpoint, settings)
    with running(redis_at(endpoint.redis)):
        wait_until(endpoint.redis.exists)
        yield endpoint


def at(job: Job) -> str:
    return f"/ws/jobs/{job.pk}"


def running_job(user: User) -> Job:
    created = create_job(
        organisation=user.organisation, created_by=user, task="missions.tasks.solve_plan", parameters={}, message="Planning"
    )
    job = start_job(job_id=created.pk)
    assert job is not None
    return job


def reported(live: WebSocket) -> dict[str, Any]:
    """The job of the next message about one."""
    while True:
        message = json.loads(live.recv())
        if message["type"] == "job":
            job: dict[str, Any] = message["job"]
            return job


def test_a_page_is_told_of_a_job_at_once_at_each_change_and_at_its_end(here: Endpoint) -> None:
    user = a_user()
    job = running_job(user)
    live = here.open(at(job), user=user)
    first = reported(live)
    assert (first["id"], first["state"], first["message"]) == (str(job.pk), "running", "Planning")
    report_progress(job=job, progress=0.5, message="half way", best={"value": 7.0, "bound": 6.0})
    half = reported(live)
    assert (half["progress"], half["message"], half["best"]) == (0.5, "half way", {"value": 7.0, "bound": 6.0})
    finish_job(job=job, result={"routes": []}, message="Planned")
    last = reported(live)
    assert (last["state"], last["result"], last["best"]) == ("done", {"routes": []}, None)
    assert close_code(live) == 1000


@pytest.mark.parametrize("origin", ["", None], ids=["from this host", "that names no origin"])
def test_a_program_listens_with_its_token(here: Endpoint, origin: str | None) -> None:
    user = a_user()
    token = create_api_token(user=user, name="test", expires_at=timezone.now() + timedelta(hours=1))
    assert reported(here.open(at(running_job(user)), token=token, origin=origin))["state"] == "running"


def test_who_may_not_listen_is_refused_at_the_door(here: Endpoint) -> None:
    user = a_user()
    job = running_job(user)
    stranger = a_user(organisation=Organisation.objects.create(name="Elsewhere"))
    token = create_api_token(user=user, name="test", expires_at=timezone.now() + timedelta(hours=1))
    refused: list[dict[str, Any]] = [
        {},
        {"user": stranger},
        {"token": "spw_none"},
        {"token": "spw_none", "origin": None},
        {"token": "spw_none", "user": user, "origin": None},
        {"token": token, "origin": "http://evil.example"},
        {"user": user, "origin": "http://evil.example"},
        {"user": user, "origin": None},
    ]
    for who in refused:
        with pytest.raises(WebSocketBadStatusException) as caught:
            here.open(at(job), **who)
        assert caught.value.status_code == 403, who
    with pytest.raises(WebSocketBadStatusException):
        here.open(at(Job(organisation=user.organisation)), user=user)  # is not there


def test_a_socket_is_closed_soon_after_its_session_or_token_ends_or_its_user_is_moved(here: Endpoint) -> None:
    user = a_user()
    job = running_job(user)
    token = create_api_token(user=user, name="test", expires_at=timezone.now() + timedelta(hours=1))
    by_session, by_token = here.open(at(job), user=user), here.open(at(job), token=token)
    moved = a_user()
    of_old_organisation = here.open(at(running_job(moved)), user=moved)
    ended, idle = a_user(), a_user()
    of_ended, of_idle = (here.open(at(running_job(person)), user=person) for person in (ended, idle))
    reported(by_session), reported(by_token), reported(of_old_organisation), reported(of_ended), reported(of_idle)
    ended_s = time.monotonic()
    User.objects.filter(pk=user.pk).update(session_generation=1)
    ApiToken.objects.update(revoked_at=timezone.now())
    User.objects.filter(pk=moved.pk).update(organisation=Organisation.objects.create(name="Elsewhere"))
    end_session(BrowserSession.objects.get(user=ended), actor=ended)
    long_ago = timezone.now() - timedelta(hours=3)
    BrowserSession.objects.filter(user=idle).update(acted_at=long_ago, present_at=long_ago)
    assert {close_code(live) for live in (by_session, by_token, of_old_organisation, of_ended, of_idle)} == {4401}
    assert time.monotonic() - ended_s < 8.0  # four seconds, and a busy machine


def test_whoever_sends_something_is_hung_up_on(here: Endpoint) -> None:
    user = a_user()
    live = here.open(at(running_job(user)), user=user)
    reported(live)
    live.send("x" * 100_000)
    assert close_code(live) == 4400


def test_a_dead_redis_delays_word_and_comes_back(endpoint: Endpoint, here: Endpoint) -> None:
    user = a_user()
    job = running_job(user)
    live = here.open(at(job), user=user)
    reported(live)
    subprocess.run(["redis-cli", "-s", str(endpoint.redis), "shutdown", "nosave"], check=False)  # noqa: S603, S607
    wait_until(lambda: not endpoint.redis.exists())
    report_progress(job=job, progress=0.3, message="without Redis")
    assert reported(live)["message"] == "without Redis"
    other = here.open(at(job), user=user)  # a page that is opened meanwhile
    assert reported(other)["progress"] == 0.3
    with running(redis_at(endpoint.redis)):
        wait_until(endpoint.redis.exists)
        report_progress(job=job, progress=0.6, message="it is back")
        assert [reported(live)["message"], reported(other)["message"]] == ["it is back", "it is back"]
        cancel_job(job=job)
        finish_job(job=job, result=1)
        assert reported(live)["state"] in {"running", "done"}


def test_a_job_that_is_deleted_between_two_looks_closes_the_socket(monkeypatch: pytest.MonkeyPatch) -> None:
    async def still_there(consumer: JobConsumer, user: User) -> tuple[str]:
        return ("running",)

    async def followed(user: User) -> int:
        consumer = JobConsumer()
        consumer._job_id, consumer._hung_up = uuid4(), asyncio.get_running_loop().create_future()
        await consumer._follow(user)
        return consumer._hung_up.result()

    monkeypatch.setattr(JobConsumer, "_version", still_there)
    assert async_to_sync(followed)(a_user()) == ENDED


@pytest.mark.long
def test_nobody_waits_for_a_redis_that_does_not_answer(
    settings: Any, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(words, "DEADLINE_S", 0.05)
    monkeypatch.setattr(words, "_quiet_until_s", 0.0)
    layer = settings.CHANNEL_LAYERS["default"]
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"redis://127.0.0.1:{silent.getsockname()[1]}/0"
        settings.CHANNEL_LAYERS = {"default": layer | {"CONFIG": layer["CONFIG"] | {"hosts": [{"address": address}]}}}
        sending = threading.Thread(target=words.publish_job, args=[uuid4()], daemon=True)
        sending.start()
        sending.join(TIMEOUT_S)
        assert not sending.is_alive()
    assert "Redis is away" in caplog.text


def test_plain_http_is_told_to_upgrade(here: Endpoint) -> None:
    with pytest.raises(urllib.error.HTTPError) as caught:
        urllib.request.urlopen(f"http://127.0.0.1:{here.port}/ws/jobs/{Job().pk}", timeout=TIMEOUT_S)
    assert caught.value.code == 426
    assert json.loads(caught.value.read())["error"]["code"] == "upgrade_required"


@pytest.mark.long
def test_without_the_program_the_door_says_try_again(here: Endpoint) -> None:
    (here.folder / "live.sock").rename(here.folder / "away.sock")
    try:
        with pytest.raises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(f"http://127.0.0.1:{here.port}/ws/jobs/{Job().pk}", timeout=TIMEOUT_S)
        assert (caught.value.code, int(caught.value.headers["Retry-After"]) > 0) == (503, True)
    finally:
        (here.folder / "away.sock").rename(here.folder / "live.sock")
