"""A whole installation but for its workers: real programs behind one port, each started again when it has been killed."""

import os
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from django.conf import settings

from scripts.places import WEB_PROGRAMS, Places
from scripts.proxy.proxy import configuration
from scripts.supervision.programs import Program, web_programs
from tests.telemetry.gateway.program import free_port
from tests.workspace.live.proxied_site import environment_of, redis_at

STARTED_AGAIN_AFTER_S = 0.3
NAMES = (*WEB_PROGRAMS, "uav-link", "live", "gateway", "estimator", "proxy")


@dataclass
class Kept:
    """One program and the thread that starts it again; `kill` is SIGKILL to all of it."""

    name: str
    command: list[str]
    environment: dict[str, str]
    log: Path
    starts: int = 0
    _process: subprocess.Popen[bytes] | None = None
    _ends: threading.Event = field(default_factory=threading.Event)

    def start(self) -> None:
        self._thread = threading.Thread(target=self._keep, name=f"keeper of {self.name}")
        self._thread.start()

    def kill(self) -> None:
        if self._process is not None and self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)

    def end(self) -> None:
        self._ends.set()
        self.kill()
        self._thread.join(10)

    def _keep(self) -> None:
        while not self._ends.is_set():
            with self.log.open("ab") as words:
                self._process = subprocess.Popen(  # noqa: S603
                    self.command,
                    cwd=settings.BASE_DIR,
                    env=os.environ | self.environment,
                    stdout=words,
                    stderr=words,
                    start_new_session=True,
                )
            self.starts += 1
            self._process.wait()
            self._ends.wait(STARTED_AGAIN_AFTER_S)


@dataclass
class Installation:
    port: int
    udp_port: int
    programs: dict[str, Kept]
    sockets: Path

    def serves(self, name: str) -> bool:
        """Whether a program that listens on a socket of its own accepts."""
        with socket.socket(socket.AF_UNIX) as caller:
            return caller.connect_ex(str(self.sockets / f"{name}.sock")) == 0


def _command(program: Program) -> list[str]:
    """As the supervisor runs it, but that the thread which starts it may end before it does."""
    clear = " ".join(f"'{path}'" for path in program.stale_files)
    return ["sh", "-c", f'rm -f {clear}; exec "$@"', program.name, *program.command]


@contextmanager
def installation(folder: Path) -> Iterator[Installation]:
    """The folder's path is short enough for sockets. Redis keeps nothing: each start is an empty one."""
    places = Places(folder)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    udp_port = free_port()
    environment = environment_of(folder) | {
        "SPANWISE_GATEWAY_UDP": f"127.0.0.1:{udp_port}",
        "SPANWISE_GATEWAY_TCP": "",
        "SPANWISE_GATEWAY_NAME": "killed",
        "SPANWISE_ESTIMATOR_NAME": "killed",
        "SPANWISE_LOG_DIR": str(folder / "flight-logs"),
    }
    places.generated.mkdir(parents=True, exist_ok=True)
    (places.generated / "nginx.conf").write_text(configuration(places, folder, port))
    programs = {program.name: program for program in web_programs(places, folder) if program.name in NAMES}
    commands = {"redis": ["sh", "-c", 'rm -f "$0"; exec "$@"', str(folder / "redis.sock"), *redis_at(folder / "redis.sock")]}
    for name, program in programs.items():
        program.folder.mkdir(parents=True, exist_ok=True)
        commands[name] = _command(program)
    kept = {name: Kept(name, command, environment, folder / f"{name}.log") for name, command in commands.items()}
    try:
        for program in kept.values():
            program.start()
        time.sleep(1.0)
        yield Installation(port, udp_port, kept, folder)
    finally:
        for program in kept.values():
            program.end()
