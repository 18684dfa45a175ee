"""One of two live programs is told to stop: its pages come back to the other one, a few at a time, and miss nothing."""

import asyncio
import signal
import socket
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from missions.models import Uav
from scripts import commands
from scripts.installation.system_packages import find_program
from scripts.places import Places
from scripts.proxy.proxy import site_configuration
from scripts.proxy.proxy_site import Site
from telemetry.services import store_records
from tests.accounts.users import a_user
from tests.missions.commands.outbox import a_uav
from tests.telemetry.gateway.program import free_port
from tests.telemetry.live.page import HungUp, Page
from tests.telemetry.records import record
from tests.workspace.live.proxied_site import Endpoint, front_endpoint, redis_at, running, wait_until
from workspace.live.graceful_shutdown import RESTARTS, GracefulShutdown
from workspace.live.timed_waits import wait_for_event

pytestmark = pytest.mark.django_db(transaction=True)

PAGES = 8
TIMEOUT_S = 120.0


@dataclass
class Replicas:
    """Two programs behind one port, in turn."""

    endpoint: Endpoint
    programs: list[subprocess.Popen[bytes]]


@pytest.fixture
def replicas(django_db_setup: None) -> Iterator[Replicas]:
    with ExitStack() as running_here:
        endpoint = running_here.enter_context(front_endpoint())
        running_here.enter_context(running(redis_at(endpoint.redis)))
        sockets = [endpoint.folder / f"live-{number}.sock" for number in (1, 2)]
        port, places = free_port(), Places(endpoint.folder / "two")
        places.process("proxy").mkdir(parents=True)
        live = tuple(f"unix:{path}" for path in sockets)
        site = Site(places.process("proxy"), places.static, web=live, live=live, listens_at=f"127.0.0.1:{port}")
        configuration = places.process("proxy") / "nginx.conf"
        configuration.write_text(site_configuration(site))
        nginx = find_program("nginx") or "nginx"
        running_here.enter_context(running([nginx, "-e", "stderr", "-c", str(configuration)]))
        programs = [running_here.enter_context(running(commands.live("--uds", str(path)), **endpoint.environment)) for path in sockets]
        two = replace(endpoint, port=port)
        wait_until(lambda: all(accepts(path) for path in sockets) and two.is_open, TIMEOUT_S)
        yield Replicas(two, programs)


def accepts(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX) as caller:
        return caller.connect_ex(str(path)) == 0


def shows(page: Page, uav: Uav, lon_deg: float) -> bool:
    shown = page.shows["uavs"].get(uav.pk)
    return shown is not None and shown["measured"] is not None and shown["measured"]["position"][0] == lon_deg


@pytest.mark.long
def test_pages_of_a_program_that_is_told_to_stop_come_back_to_the_other_one(replicas: Replicas) -> None:
    uav, person = a_uav("Tern"), a_user()
    assert store_records([record(uav, 1, longitude_deg=10.0)]).stored == 1
    pages = [Page(replicas.endpoint.open("/ws/live", user=person)) for _ in range(PAGES)]
    for page in pages:
        page.take_until(lambda one: shows(one, uav, 10.0), TIMEOUT_S)
    stopped = replicas.programs[0]
    stopped.send_signal(signal.SIGTERM)
    assert store_records([record(uav, 2, longitude_deg=10.5)]).stored == 1
    stopped.wait(TIMEOUT_S)
    assert store_records([record(uav, 3, longitude_deg=11.0)]).stored == 1
    came_back = 0
    for page in pages:
        try:
            page.take_until(lambda one: shows(one, uav, 11.0), TIMEOUT_S)
        except HungUp as goodbye:
            assert goodbye.code == RESTARTS
            again = Page(replicas.endpoint.open("/ws/live", user=person))
            again.take_until(lambda one: shows(one, uav, 11.0), TIMEOUT_S)
            came_back += 1
    assert 0 < came_back < PAGES


def test_pages_are_not_all_told_at_once_and_newcomers_are_told_as_well() -> None:
    class Reported:
        def __init__(self, shutdown: GracefulShutdown) -> None:
            self.shutdown = shutdown
            self.reported: list[tuple[int, float]] = []
            shutdown.expect(self)

        def hang_up(self, code: int) -> None:
            self.reported.append((code, asyncio.get_running_loop().time()))
            self.shutdown.forget(self)

    async def all_reported() -> tuple[list[Reported], int]:
        loop, left = asyncio.get_running_loop(), asyncio.Event()
        loop.add_signal_handler(signal.SIGINT, left.set)
        shutdown = GracefulShutdown(loop, spread_s=0.2)
        sockets = [Reported(shutdown) for _ in range(19)]
        shutdown.begin()
        shutdown.begin()
        sockets.append(Reported(shutdown))
        assert await wait_for_event(left, TIMEOUT_S)
        loop.remove_signal_handler(signal.SIGINT)
        return sockets, len(shutdown._sockets)

    sockets, still_there = asyncio.run(all_reported())
    assert still_there == 0
    assert [[code for code, _ in one.reported] for one in sockets] == [[RESTARTS]] * 20
    moments_s = [at_s for one in sockets for _, at_s in one.reported]
    assert max(moments_s) - min(moments_s) > 0.05
