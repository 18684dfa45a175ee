"""The supervisor (supervisord): configuration, start, calls, and shutdown with all of its programs."""

import http.client
import os
import shlex
import signal
import socket
import subprocess
import sys
import time
import xmlrpc.client
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from scripts.places import PROJECT_DIR, SERVING_PROGRAMS, CannotStart, Places
from scripts.supervision.processes import end_processes, processes_in
from scripts.supervision.programs import SERVERS, SERVERS_STAGE, Program

START_TIMEOUT_S = 15.0
STOP_TIMEOUT_S = 90.0
CALL_TIMEOUT_S = 10.0
TIMEOUT_WITH_SUPERVISOR_S = 10.0


class _UnixConnection(http.client.HTTPConnection):
    """HTTP over a unix socket."""

    def __init__(self, path: Path) -> None:
        super().__init__("localhost", timeout=CALL_TIMEOUT_S)
        self.path = path

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(self.timeout)
        self.sock.connect(str(self.path))


class _UnixTransport(xmlrpc.client.Transport):
    """XML-RPC over a unix socket with a timeout: the supervisor's own transport has none."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.path = path

    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        return _UnixConnection(self.path)


def configuration(places: Places, sockets: Path, programs: Iterable[Program]) -> str:
    """Return supervisord.conf. A percent sign is doubled for its parser, twice in the name of a log file."""
    lines = [
        "[unix_http_server]",
        f"file={sockets / 'supervisor.sock'}",
        "chmod=0700",
        "[rpcinterface:supervisor]",
        "supervisor.rpcinterface_factory=supervisor.rpcinterface:make_main_rpcinterface",
        "[supervisord]",
        f"logfile={places.logs / 'supervisor.log'}",
        "logfile_maxbytes=5MB",
        "logfile_backups=1",
        f"pidfile={places.generated / 'supervisord.pid'}",
        f"childlogdir={places.logs}",
        "silent=true",
        "umask=077",
    ]
    if os.geteuid() == 0:
        lines.append("user=root")
    for program in programs:
        lines += [
            f"[program:{program.name}]",
            f"command={shlex.join(program.start_command())}",
            f"directory={PROJECT_DIR}",
            f"priority={program.stage}",
            f"autostart={'true' if program.stage == SERVERS_STAGE else 'false'}",
            "autorestart=true",
            "startsecs=1",
            "startretries=1000",
            f"stopsignal={program.stop_signal}",
            f"stopwaitsecs={program.patience_s}",
            "killasgroup=true",
            "redirect_stderr=true",
            *([f"environment={_environment(program.environment)}"] if program.environment else []),
            f"stdout_logfile={places.logs / program.name}.log".replace("%", "%%"),
            "stdout_logfile_maxbytes=10MB",
            "stdout_logfile_backups=3",
        ]
    return "".join(f"{line.replace('%', '%%')}\n" for line in lines)


def _environment(variables: dict[str, str]) -> str:
    for value in variables.values():
        if set(value) & set('"\n'):
            raise CannotStart(f"a program cannot be given {value!r}: it holds a quotation mark")
    return ",".join(f'{name}="{value}"' for name, value in variables.items())


@dataclass(frozen=True)
class ProgramState:
    """State of one program, as the supervisor reports it."""

    name: str
    state: str
    description: str
    started_at_s: int
    pid: int  # 0 while it does not run


def serves(socket_file: Path) -> bool:
    """Whether a program accepts connections there. Granian's sockets do once its worker has loaded the application."""
    with socket.socket(socket.AF_UNIX) as caller:
        caller.settimeout(CALL_TIMEOUT_S)
        return caller.connect_ex(str(socket_file)) == 0


class Supervisor:
    """One installation's supervisor, running or not."""

    def __init__(self, places: Places, sockets: Path) -> None:
        self.places = places
        self.sockets = sockets

    def _call(self) -> Any:
        return xmlrpc.client.ServerProxy("http://localhost", transport=_UnixTransport(self.sockets / "supervisor.sock")).supervisor

    def is_running(self) -> bool:
        try:
            return bool(self._call().getState()["statename"] == "RUNNING")
        except (OSError, http.client.HTTPException, xmlrpc.client.Error):
            return False

    def is_alive(self) -> bool:
        """Whether its process exists, responsive or not."""
        return bool(processes_in([self.places.process("supervisor")]))

    def start(self, programs: list[Program]) -> None:
        """Start the supervisor with the servers; the other programs wait for start_programs. Leftovers of a killed one are ended."""
        self.end_leftovers()
        for program in programs:
            if program.stage != SERVERS_STAGE:
                program.folder.mkdir(parents=True, exist_ok=True)
        path = self.places.generated / "supervisord.conf"
        path.write_text(configuration(self.places, self.sockets, programs))
        folder = self.places.process("supervisor")
        folder.mkdir(parents=True, exist_ok=True)
        environment = {**os.environ, "SPANWISE_VAR": str(self.places.state), "PYTHONPATH": str(PROJECT_DIR)}
        log = self.places.logs / "supervisor.log"
        with log.open("a") as words:
            child = subprocess.Popen(
                [sys.executable, "-m", "scripts.supervision.supervisor_program", "--nodaemon", "--configuration", str(path)],
                cwd=folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=words,
                stderr=words,
                start_new_session=True,
            )
        deadline = time.monotonic() + START_TIMEOUT_S
        while not self.is_running():
            if child.poll() is not None or time.monotonic() > deadline:
                raise CannotStart(f"the supervisor did not start; see {log}")
            time.sleep(0.05)

    def start_programs(self, names: Iterable[str]) -> None:
        for name in names:
            self._call().startProcess(name, False)

    def states(self) -> list[ProgramState]:
        """Return the programs' states; empty when the supervisor does not run."""
        try:
            rows: list[dict[str, Any]] = self._call().getAllProcessInfo()
        except (OSError, http.client.HTTPException, xmlrpc.client.Error):
            return []
        return [ProgramState(row["name"], row["statename"], row["description"], row["start"], row["pid"]) for row in rows]

    def states_as_served(self) -> list[ProgramState]:
        """Return the programs' states, in which one behind the proxy is starting until it serves."""
        return [
            replace(state, state="STARTING", description="does not serve yet")
            if state.state == "RUNNING" and state.name in SERVING_PROGRAMS and not serves(self.sockets / f"{state.name}.sock")
            else state
            for state in self.states()
        ]

    def end_leftovers(self) -> None:
        """End what a killed supervisor left behind. The kernel has signalled its programs; they get their time to stop."""
        end_processes([self.places.process("supervisor")], patience_s=TIMEOUT_WITH_SUPERVISOR_S)
        end_processes([self.places.data], first_signal=signal.SIGINT, patience_s=15.0)  # PostgreSQL's fast shutdown
        others = [entry for entry in (self.places.state / "processes").glob("*") if entry.is_dir()]
        end_processes([*others, self.places.redis], patience_s=15.0)

    def stop(self) -> None:
        """Stop every program, the servers last, and the supervisor itself."""
        deadline = time.monotonic() + STOP_TIMEOUT_S
        names = [state.name for state in self.states()]
        try:
            # A shutdown stops one program after the other; here each group is stopped in parallel.
            for group in ([name for name in names if name not in SERVERS], [name for name in names if name in SERVERS]):
                for name in group:
                    self.stop_program(name)
                while any(state.name in group and state.state == "STOPPING" for state in self.states()) and time.monotonic() < deadline:
                    time.sleep(0.05)
            self._call().shutdown()
        except (OSError, http.client.HTTPException, xmlrpc.client.Error):
            pass  # not there, or already stopping
        else:
            while self.is_alive() and time.monotonic() < deadline:
                time.sleep(0.05)
        self.end_leftovers()

    def stop_program(self, name: str) -> None:
        """Stop a program without waiting; it is not started again."""
        with suppress(xmlrpc.client.Fault):  # it was not running
            self._call().stopProcess(name, False)
