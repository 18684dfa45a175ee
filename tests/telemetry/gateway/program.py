"""The gateway as a program of its own, so that it can be killed."""

import os
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

from django.conf import settings
from django.db import connection

from tests.telemetry.gateway.station import TIMEOUT_S

PROJECT_DIR = Path(__file__).resolve().parents[3]


def free_port(transport: str = "udp") -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM if transport == "udp" else socket.SOCK_STREAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def environment(log_dir: Path) -> dict[str, str]:
    """What leads it to the test's database."""
    at = connection.settings_dict
    who = quote(at["USER"], safe="") + (f":{quote(at['PASSWORD'], safe='')}" if at["PASSWORD"] else "")
    port = f":{at['PORT']}" if at["PORT"] else ""
    address = f"postgis://{who}@{quote(at['HOST'], safe='')}{port}/{at['NAME']}"
    own = {"DATABASE_URL": address, "SPANWISE_SECRET_KEY": settings.SECRET_KEY, "SPANWISE_LOG_DIR": str(log_dir)}
    return os.environ | {"REDIS_URL": settings.REDIS_URL} | own


@contextmanager
def gateway_program(port: int, log_dir: Path, *, name: str = "test", transport: str = "udp") -> Iterator[subprocess.Popen[str]]:
    """Listens when it is given out; killed at the end unless it has ended by itself."""
    listens = {"udp": "", "tcp": "", transport: f"127.0.0.1:{port}"}
    command = [sys.executable, "manage.py", "run_gateway", "--udp", listens["udp"], "--tcp", listens["tcp"], "--name", name]
    with (log_dir / f"{name}.log").open("a") as log:
        process = subprocess.Popen(  # noqa: S603
            command, cwd=PROJECT_DIR, env=environment(log_dir), stdout=subprocess.PIPE, stderr=log, text=True, bufsize=1
        )
        timer = threading.Timer(3 * TIMEOUT_S, process.kill)
        timer.start()
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert "listening" in line, (log_dir / f"{name}.log").read_text()
            timer.cancel()
            yield process
        finally:
            timer.cancel()
            process.kill()
            process.wait()
            assert process.stdout is not None
            process.stdout.close()
