"""UAVs are answered by a program of their own: by the real proxy, while the threads of every web program are taken by pages."""

import json
import socket
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import pytest

from scripts.places import WEB_PROGRAMS, Places
from scripts.supervision.programs import web_programs
from telemetry.models import TelemetryRecord
from tests.telemetry.links.uav_clients import UavClient, linked_uav, report
from tests.workspace.live.proxied_site import Endpoint, front_endpoint, redis_at, running, wait_until

pytestmark = pytest.mark.django_db(transaction=True)

WITHIN_S = 5.0  # on a machine that runs other tests as well


@dataclass(frozen=True)
class _Busy:
    """A web program whose threads are all taken: it takes connections and answers none."""

    path: Path

    @contextmanager
    def serves(self) -> Iterator[None]:
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind(str(self.path))
            listening.listen(64)
            yield


def _listens(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX) as caller:
        return caller.connect_ex(str(path)) == 0


@pytest.fixture
def endpoint(django_db_setup: None) -> Iterator[Endpoint]:
    """With the program of UAVs, a Redis, and web programs that are busy."""
    with front_endpoint() as endpoint, ExitStack() as programs:
        programs.enter_context(running(redis_at(endpoint.redis)))
        program = next(one for one in web_programs(Places(endpoint.folder), endpoint.folder) if one.name == "uav-link")
        programs.enter_context(running(program.command, **endpoint.environment))
        for name in WEB_PROGRAMS:
            programs.enter_context(_Busy(endpoint.folder / f"{name}.sock").serves())
        wait_until(lambda: _listens(endpoint.folder / "uav-link.sock"))
        yield endpoint


def sent(endpoint: Endpoint, kite: UavClient, body: dict[str, object]) -> tuple[int, float]:
    """Return the status of a report and how long its answer took."""
    request = urllib.request.Request(
        f"http://127.0.0.1:{endpoint.port}/api/v1/uav-link/telemetry",
        data=json.dumps(body).encode(),
        headers={"Authorization": f"Bearer {kite.token}", "Content-Type": "application/json"},
    )
    began_s = time.monotonic()
    with urllib.request.urlopen(request, timeout=60) as answer:  # noqa: S310
        return answer.status, time.monotonic() - began_s


@pytest.mark.long
def test_a_report_is_answered_while_pages_take_every_thread(endpoint: Endpoint) -> None:
    kite = linked_uav()
    waiting = [threading.Thread(target=_ask_for_a_page, args=[endpoint], daemon=True) for _ in range(16)]
    for page in waiting:
        page.start()
    sent(endpoint, kite, {"stream": "boot-1", "records": [report(0)]})
    taken_s = []
    for number in range(1, 21):
        status, lasted_s = sent(endpoint, kite, {"stream": "boot-1", "records": [report(number)]})
        assert status == 200
        taken_s.append(lasted_s)
    assert all(page.is_alive() for page in waiting)  # none of the pages has been answered meanwhile
    assert max(taken_s) < WITHIN_S, taken_s
    assert TelemetryRecord.objects.count() == 21


def _ask_for_a_page(endpoint: Endpoint) -> None:
    with suppress(OSError):
        urllib.request.urlopen(f"http://127.0.0.1:{endpoint.port}/missions", timeout=110).close()


def test_the_program_of_uavs_answers_nothing_else(endpoint: Endpoint) -> None:
    with socket.socket(socket.AF_UNIX) as asked:
        asked.settimeout(60)
        asked.connect(str(endpoint.folder / "uav-link.sock"))
        asked.sendall(b"GET /api/v1/missions HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
        assert asked.recv(100).split()[1] == b"404"
