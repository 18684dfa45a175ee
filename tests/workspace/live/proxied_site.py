"""Spanwise's front door for websockets, with real programs: nginx, granian behind it, and a Redis of its own."""

import os
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote
from uuid import uuid4

import pytest
from django.conf import settings
from django.db import connection
from websocket import WebSocket, create_connection

from scripts.installation.system_packages import find_program
from scripts.places import Places
from scripts.proxy.proxy import configuration
from scripts.supervision.programs import web_programs
from tests.accounts.users import client_of
from workspace.models import User

TIMEOUT_S = 60.0


@dataclass(frozen=True)
class Endpoint:
    """The one port, and the Redis behind it; `live` is the program that speaks."""

    port: int
    redis: Path
    folder: Path
    live: list[str]
    environment: dict[str, str]

    def open(self, path: str, *, user: User | None = None, token: str = "", origin: str | None = "") -> WebSocket:
        """`origin` "" is this host's own, None is none at all."""
        headers = []
        if user is not None:
            headers.append(f"Cookie: {settings.SESSION_COOKIE_NAME}={client_of(user).cookies[settings.SESSION_COOKIE_NAME].value}")
        if token:
            headers.append(f"Authorization: Bearer {token}")
        return create_connection(
            f"ws://127.0.0.1:{self.port}{path}",
            timeout=TIMEOUT_S,
            header=headers,
            origin=f"http://127.0.0.1:{self.port}" if origin == "" else origin,
            suppress_origin=origin is None,
        )

    @property
    def is_open(self) -> bool:
        """Whether the program behind it answers."""
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/ws/jobs/{uuid4()}", timeout=TIMEOUT_S):
                return False
        except urllib.error.HTTPError as error:
            return error.code == 426
        except OSError:
            return False

    def serves_live(self) -> Any:
        """The program, for a `with` statement."""
        return running(self.live, **self.environment)


@contextmanager
def running(command: list[str], **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(command, cwd=settings.BASE_DIR, env=os.environ | environment)  # noqa: S603
    try:
        yield process
    finally:
        process.terminate()
        process.wait()


def redis_at(path: Path) -> list[str]:
    """A Redis that keeps nothing."""
    program = find_program("redis-server") or "redis-server"
    return [program, "--port", "0", "--unixsocket", str(path), "--save", "", "--logfile", "/dev/null"]


def wait_until(is_so: Callable[[], bool], patience_s: float = TIMEOUT_S) -> None:
    end_s = time.monotonic() + patience_s
    while not is_so():
        assert time.monotonic() < end_s, "it never came"
        time.sleep(0.05)


def close_code(live: WebSocket) -> int:
    """After what is still on its way."""
    while True:
        opcode, data = live.recv_data()
        if opcode == 8:
            return int.from_bytes(data[:2], "big")


@contextmanager
def front_endpoint() -> Iterator[Endpoint]:
    """Without its live program and its Redis, which tests start and kill."""
    nginx = find_program("nginx")
    if nginx is None:
        pytest.skip("nginx is not installed; ./run installs it")
    folder = Path(tempfile.mkdtemp(prefix="sw-", dir="/tmp"))  # short enough for sockets
    places = Places(folder)
    places.process("proxy").mkdir(parents=True)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    (folder / "nginx.conf").write_text(configuration(places, folder, port))
    live = next(program for program in web_programs(places, folder) if program.name == "live")
    try:
        with running([nginx, "-e", "stderr", "-c", str(folder / "nginx.conf")]):
            yield Endpoint(port, folder / "redis.sock", folder, live.command, environment_of(folder))
    finally:
        shutil.rmtree(folder)


def environment_of(folder: Path) -> dict[str, str]:
    """What leads a program to the test's database, and to the Redis of the folder."""
    at = connection.settings_dict
    who = quote(at["USER"], safe="") + (f":{quote(at['PASSWORD'], safe='')}" if at["PASSWORD"] else "")
    return {
        "DATABASE_URL": f"postgis://{who}@{quote(at['HOST'], safe='')}{':' + str(at['PORT']) if at['PORT'] else ''}/{at['NAME']}",
        "REDIS_URL": f"unix://{folder / 'redis.sock'}",
        "SPANWISE_VAR": str(folder),
        "SPANWISE_SECRET_KEY": settings.SECRET_KEY,
    }


def through_its_redis(endpoint: Endpoint, settings: Any) -> None:
    """The test's own words go through it as well."""
    layer = settings.CHANNEL_LAYERS["default"]
    hosts = [{"address": f"unix://{endpoint.redis}", "socket_connect_timeout": 1}]
    settings.CHANNEL_LAYERS = {"default": layer | {"CONFIG": layer["CONFIG"] | {"hosts": hosts}}}
    settings.REDIS_URL = f"unix://{endpoint.redis}"
