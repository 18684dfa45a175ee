"""A process that answers no requests tells at an address of its own how it does, and the probe asks there."""

import http.client
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from operation import loop_heartbeats
from operation.address import WrongAddress, address_of
from operation.exposition import Exposition
from operation.readiness import Readiness

PROJECT_DIR = Path(__file__).resolve().parents[2]
TIMEOUT_S = 60


@pytest.fixture
def faults() -> list[str]:
    """What the program lacks; a test may put something in."""
    return []


@pytest.fixture(autouse=True)
def _no_other_loops(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever went round in other tests is over."""
    monkeypatch.setattr(loop_heartbeats, "_due_s", {})


@pytest.fixture(params=["tcp", "unix"])
def served_at(request: pytest.FixtureRequest, faults: list[str], tmp_path: Path) -> Iterator[str]:
    place = "127.0.0.1:0" if request.param == "tcp" else f"unix:{tmp_path / 'told.sock'}"
    address = address_of(place)
    assert address is not None
    exposition = Exposition(address, Readiness(lambda: list(faults)))
    exposition.start()
    assert exposition.listening.wait(TIMEOUT_S)
    yield f"127.0.0.1:{exposition.port}" if request.param == "tcp" else place
    exposition.close()


def probe(*arguments: str, served_at: str = "") -> tuple[int, str, str]:
    environment = {**os.environ, "SPANWISE_METRICS": served_at}
    command = [sys.executable, "-m", "operation.probe", *arguments]
    answer = subprocess.run(command, cwd=PROJECT_DIR, env=environment, capture_output=True, text=True, check=False, timeout=TIMEOUT_S)
    return answer.returncode, answer.stdout.strip(), answer.stderr.strip()


def test_a_program_that_lives_and_can_work_says_so(served_at: str) -> None:
    assert probe("live", served_at=served_at) == (0, '{"alive": true}', "")
    assert probe("ready", served_at)[:2] == (0, '{"ready": true}')


def test_one_that_cannot_work_lives_all_the_same(served_at: str, faults: list[str]) -> None:
    faults.append("the database cannot be reached")
    assert probe("ready", served_at=served_at)[:2] == (1, '{"ready": false, "reasons": ["the database cannot be reached"]}')
    assert probe("live", served_at=served_at)[0] == 0


def test_a_loop_that_hangs_is_no_life(served_at: str) -> None:
    loop_heartbeats.send_heartbeat("the loop", within_s=-1.0)
    try:
        assert probe("live", served_at=served_at)[:2] == (1, '{"alive": false, "reasons": ["the loop hangs"]}')
        loop_heartbeats.send_heartbeat("the loop", within_s=-1.0, excuse=lambda: True)
        assert probe("live", served_at=served_at)[0] == 0
        loop_heartbeats.send_heartbeat("the loop", within_s=3_600.0)
        assert probe("live", served_at=served_at)[0] == 0
    finally:
        loop_heartbeats.stop("the loop")


def test_where_nobody_tells_there_is_no_life_and_without_an_address_no_question(tmp_path: Path) -> None:
    assert probe("live", served_at=f"unix:{tmp_path / 'nobody'}")[0] == 1
    assert probe("live")[0] == 2
    assert probe("something")[0] == 2


@pytest.mark.parametrize("text", ["9100", "host:", "host:99999", "unix:relative", ":9100"])
def test_what_is_no_address_is_refused(text: str) -> None:
    with pytest.raises(WrongAddress):
        address_of(text)


def test_metrics_are_told_at_the_same_address_and_nothing_else_is(served_at: str) -> None:
    assert b"spanwise_http_requests_total" in _get(served_at, "/metrics")[1]
    assert _get(served_at, "/admin/")[0] == 404


def test_an_address_that_somebody_else_holds_is_waited_for() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        address = address_of(f"127.0.0.1:{other.getsockname()[1]}")
        assert address is not None
        exposition = Exposition(address, Readiness(list))
        exposition.start()
        assert not exposition.listening.wait(0.2)
    assert exposition.listening.wait(TIMEOUT_S)
    exposition.close()


def _get(served_at: str, path: str) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("localhost", timeout=TIMEOUT_S)
    if served_at.startswith("unix:"):
        connection.sock = socket.socket(socket.AF_UNIX)
        connection.sock.connect(served_at.removeprefix("unix:"))
    else:
        host, _, port = served_at.rpartition(":")
        connection.sock = socket.create_connection((host, int(port)))
    connection.request("GET", path)
    answer = connection.getresponse()
    return answer.status, answer.read()
