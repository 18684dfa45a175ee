"""Redis and the live program are killed while pages are open: nothing is lost, and pages are live again within ten seconds."""

import os
import signal
import subprocess
import time
from datetime import timedelta
from pathlib import Path

import pytest
from django.utils import timezone
from websocket import WebSocketBadStatusException, WebSocketException

from missions.models import Uav
from telemetry.models import TelemetryRecord
from telemetry.services import store_records
from tests.accounts.users import a_user
from tests.missions.commands.outbox import a_uav
from tests.telemetry.gateway.outages.test_outages import database_away
from tests.telemetry.live.page import Page
from tests.telemetry.records import record
from tests.workspace.live.proxied_site import Endpoint, redis_at, running, wait_until
from workspace.api_tokens import create_api_token
from workspace.models import User

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]

AGAIN_WITHIN_S = 10.0


class Flight:
    """A UAV that reports, and pages that should show it."""

    def __init__(self) -> None:
        self.uav: Uav = a_uav("Tern")
        self.sent = 0

    def report(self) -> None:
        self.sent += 1
        assert store_records([record(self.uav, self.sent, longitude_deg=self.here_deg)]).stored == 1

    @property
    def here_deg(self) -> float:
        return round(10.0 + self.sent / 1000, 6)

    def is_shown_by(self, page: Page) -> bool:
        return self.uav.pk in page.shows["uavs"] and page.shows["uavs"][self.uav.pk]["measured"]["position"][0] == self.here_deg


def wipe(redis: Path) -> None:
    subprocess.run(["redis-cli", "-s", str(redis), "flushall"], check=True, capture_output=True)  # noqa: S603, S607


def kill_redis_often(endpoint: Endpoint, times: int) -> None:
    flight = Flight()
    flight.report()
    page = Page(endpoint.open("/ws/live", user=a_user()))
    for _ in range(times):
        with running(redis_at(endpoint.redis)) as redis:
            wait_until(endpoint.redis.exists)
            for harm in (lambda: None, lambda: wipe(endpoint.redis)):
                harm()
                flight.report()
                page.take_until(flight.is_shown_by, AGAIN_WITHIN_S)
            redis.kill()
            redis.wait()
            endpoint.redis.unlink(missing_ok=True)
        flight.report()  # without any
        page.take_until(flight.is_shown_by, AGAIN_WITHIN_S)
    assert TelemetryRecord.objects.filter(uav=flight.uav).count() == flight.sent


def test_while_redis_is_killed_and_emptied_pages_stay_live(without_redis: Endpoint) -> None:
    kill_redis_often(without_redis, 2)


def test_redis_may_be_killed_and_emptied_ten_times(without_redis: Endpoint) -> None:
    kill_redis_often(without_redis, 10)


def test_a_redis_that_is_back_brings_word_at_once_again(without_redis: Endpoint) -> None:
    flight = Flight()
    flight.report()
    page = Page(without_redis.open("/ws/live", user=a_user()))
    page.take()
    with running(redis_at(without_redis.redis)):
        wait_until(without_redis.redis.exists)
        waits_s: list[float] = []
        until_s = time.monotonic() + AGAIN_WITHIN_S
        while len(waits_s) < 3 or max(waits_s[-3:]) > 0.5:  # without word each would wait for the next look, a second later
            assert time.monotonic() < until_s, waits_s
            flight.report()
            began_s = time.monotonic()
            page.take_until(flight.is_shown_by, AGAIN_WITHIN_S)
            waits_s.append(time.monotonic() - began_s)


def test_who_comes_while_the_database_is_away_is_told_to_try_again(here: Endpoint) -> None:
    token = create_api_token(user=a_user(), name="test", expires_at=timezone.now() + timedelta(hours=1))
    with database_away(), pytest.raises(WebSocketBadStatusException) as refused:
        here.open("/ws/live", token=token, origin=None)
    assert refused.value.status_code == 503
    assert int(refused.value.resp_headers["retry-after"]) > 0
    page = Page(here.open("/ws/live", token=token, origin=None))
    assert page.take()["type"] == "snapshot"


def processes_below(pid: int) -> list[int]:
    children = [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    return [below for child in children for below in (child, *processes_below(child))]


def reopened(endpoint: Endpoint, user: User, until_s: float) -> Page:
    """As a page's own program does: it tries until it is told everything."""
    while True:
        try:
            page = Page(endpoint.open("/ws/live", user=user))
            page.take()
        except (WebSocketException, OSError):
            assert time.monotonic() < until_s, "the live program does not come back"
            time.sleep(0.2)
        else:
            return page


def test_the_live_program_is_killed_and_pages_that_come_back_are_whole(here: Endpoint, live_program: int) -> None:
    user, flight = a_user(), Flight()
    flight.report()
    page = Page(here.open("/ws/live", user=user))
    page.take()
    for pid in processes_below(live_program):
        os.kill(pid, signal.SIGKILL)
    flight.report()
    began_s = time.monotonic()
    with pytest.raises((WebSocketException, OSError)):
        while True:
            page.take()
    page = reopened(here, user, began_s + AGAIN_WITHIN_S)
    assert flight.is_shown_by(page)
    flight.report()
    page.take_until(flight.is_shown_by)
