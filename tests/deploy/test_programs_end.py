"""Every program as a container starts it: it comes up, is ready, ends within ten seconds of SIGTERM, and writes JSON alone."""

import http.client
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from django.conf import settings

from scripts.container import container
from scripts.places import PROJECT_DIR
from tests.telemetry.gateway.program import free_port
from tests.workspace.live.proxied_site import environment_of

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]

TIMEOUT_S = 600.0  # where the planners' core has to be compiled first
ENDS_WITHIN_S = 10.0  # the promise
PROGRAMS = sorted({*container.PROGRAMS} - {"migrate"})


@contextmanager
def started(name: str, folder: Path) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """The program, and the port at which it tells how it does."""
    port = free_port()
    own = {
        "REDIS_URL": settings.REDIS_URL,
        "SPANWISE_LOG_FORMAT": "json",
        "SPANWISE_METRICS": f"127.0.0.1:{port}",
        "SPANWISE_LISTEN_HOST": "127.0.0.1",
        "SPANWISE_WEB_PORT": str(free_port()),
        "SPANWISE_LIVE_PORT": str(free_port()),
        "SPANWISE_GATEWAY_UDP": f"127.0.0.1:{free_port()}",
        "SPANWISE_GATEWAY_TCP": f"127.0.0.1:{free_port()}",
        "PYTHONPATH": str(PROJECT_DIR),
    }
    with (folder / "lines").open("wb") as lines:
        process = subprocess.Popen(
            [sys.executable, "-m", "scripts.container.container", name],
            cwd=folder, env=os.environ | environment_of(folder) | own, stdout=lines, stderr=lines, start_new_session=True,
        )  # fmt: skip
        try:
            yield process, port
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def is_ready(port: int) -> bool:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    try:
        connection.request("GET", "/readyz")
        return connection.getresponse().status == 200
    except OSError:
        return False
    finally:
        connection.close()


def wait_until_ready(process: subprocess.Popen[bytes], port: int) -> None:
    end_s = time.monotonic() + TIMEOUT_S
    while not is_ready(port):
        assert process.poll() is None, "it has ended by itself"
        assert time.monotonic() < end_s, "it was never ready"
        time.sleep(0.1)


def end(process: subprocess.Popen[bytes]) -> float:
    """How long it took, in seconds."""
    began_s = time.monotonic()
    process.terminate()
    process.wait(TIMEOUT_S)
    return time.monotonic() - began_s


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_that_is_ready_ends_in_time_and_writes_json(name: str, tmp_path: Path) -> None:
    with started(name, tmp_path) as (process, port):
        wait_until_ready(process, port)
        took_s = end(process)
    lines = (tmp_path / "lines").read_text().splitlines()
    print(f"{name}: ended after {took_s:.1f} s, {len(lines)} lines")
    for line in lines:
        assert json.loads(line)["message"]
    assert took_s <= ENDS_WITHIN_S


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_that_has_hardly_begun_ends_in_time(name: str, tmp_path: Path) -> None:
    """While it imports what it needs, or warms up."""
    with started(name, tmp_path) as (process, _):
        end_s = time.monotonic() + TIMEOUT_S
        while b"-m\0scripts.container.container" in Path(f"/proc/{process.pid}/cmdline").read_bytes():
            assert time.monotonic() < end_s
            time.sleep(0.02)
        time.sleep(1.0)
        assert end(process) <= ENDS_WITHIN_S
