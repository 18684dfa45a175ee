"""The shipped configuration on this machine, with TLS, in a folder of its own: for load tests, chaos and the local scaler.

    with Installation(folder, {"web": 2, "live": 2}) as installation:
        installation.manage("loaddata", ...)         # manage.py in this installation; standard output comes back
        installation.address                         # https://localhost:PORT; clients trust installation.authority (a file)
        installation.kill("web-1")                   # kill -9 of all its processes: the supervisor starts it again, as with ./run
        installation.stop("web-2"), .start("web-2")  # TERM, drained and waited for; the proxy goes on serving
        installation.usage()["web-1"].resident_bytes

Programs, supervisor, PostgreSQL and Redis (durable, on unix sockets) are those of ./run; the proxy is that of the image, which speaks TLS
(HTTP is redirected, HSTS, nothing below 1.2) and takes a new certificate without a restart. Everything listens on the loopback, on ports
that are free. Given a database or a Redis, it uses those. What an earlier, killed run of the same folder left behind is ended first.
"""

import json
import os
import signal
import socket
import ssl
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

from config.private_servers import private_database_url, private_redis_url
from deploy.load.certificates import make_authority, make_certificate
from deploy.load.scaling.name_server import NameServer
from deploy.load.scaling.replicas import KINDS, at_address, free_port, kind_of, name_of, ports_of_simulations, replicas
from deploy.load.usage import Usage, usage
from scripts.installation import database_cluster
from scripts.places import PROJECT_DIR, prepare_sockets, prepare_state, remove_sockets
from scripts.supervision.processes import is_alive
from scripts.supervision.programs import PROGRAM_STAGE, SERVERS, Program, database_server, queue_server
from scripts.supervision.supervision import ProgramState, Supervisor

TIMEOUT_S = 600.0  # the first start of a checkout that has not been set up compiles the core
ANSWERS_WITHIN_S = 10.0
SITE = "load.test"  # RFC 6761: no name of the outside
HOSTS = {"web": "127.77.0", "live": "127.78.0", "uav-link": "127.79.0"}  # every address of 127/8 is this machine
AS_RUN_STARTS = dict.fromkeys(KINDS, 1) | {"web": 2}


class NotReady(Exception):
    """The programs did not answer in time; the message says where their logs are."""


class Installation:
    """One state folder with its servers and programs. Replicas are named as in ./run: web-1, web-2; live, live-2; proxy, redis."""

    def __init__(
        self,
        folder: Path,
        counts: Mapping[str, int] | None = None,
        *,
        spare: Mapping[str, int] | None = None,
        settings: Mapping[str, str] | None = None,
        database_url: str = "",
        redis_url: str = "",
        by_name: bool = False,
    ) -> None:
        """`counts` of replicas by kind, over those of ./run (0: none); `spare` ones wait for `start`. `settings` are environment variables
        of every program.

        `by_name` puts the proxy in front of web and live as Kubernetes has it: they listen on addresses of their own, and the proxy asks a
        name server for those that `let_in` has named. Without it they are on unix sockets, all of them known to the proxy, as in ./run.
        """
        self.places = prepare_state(folder.resolve())
        self.sockets = prepare_sockets(self.places.state)
        self.supervisor = Supervisor(self.places, self.sockets)
        self.counts = AS_RUN_STARTS | dict(counts or {})
        self.plain_port, self.port = free_port(), free_port()
        self.plain_address, self.address = f"http://localhost:{self.plain_port}", f"https://localhost:{self.port}"
        self._certificates = self.places.state / "certificates"
        self.authority = make_authority(self._certificates)
        self._is_own_database, self._is_own_redis = not database_url, not redis_url
        self.settings = {
            "SPANWISE_VAR": str(self.places.state),
            "PYTHONPATH": str(PROJECT_DIR),
            "DATABASE_URL": database_url or private_database_url(self.places.state),
            "REDIS_URL": redis_url or private_redis_url(self.places.state),
            "SPANWISE_HTTPS": "1",
            "SPANWISE_ALLOWED_HOSTS": "localhost,127.0.0.1",
            "SPANWISE_TRUSTED_ORIGINS": self.address,
            "SPANWISE_SIMULATOR_PORTS": ports_of_simulations(),
            "SPANWISE_OPERATORS_PER_ADDRESS": "0",  # everybody comes from this machine
            **(settings or {}),
        }
        self.name_server = NameServer() if by_name else None
        self._let_in: set[str] = set()
        self._ports = {kind: free_port() for kind in HOSTS}
        spare = spare or {}
        most = {kind: self.counts[kind] + spare.get(kind, 0) for kind in KINDS}
        self._started = {program.name for program in replicas(self.places, self.sockets, self.counts)} | {"proxy"}
        self._programs = {program.name: program for program in [*self._replicas(most), self._proxy(most)]}
        self._give_settings()

    # --- the whole -------------------------------------------------------------------------------------------------------------------

    def __enter__(self) -> Self:
        try:
            self._start()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """End every program, the servers last. The data stay in the folder."""
        self.supervisor.stop()
        remove_sockets(self.places.state)
        if self.name_server:
            self.name_server.close()

    def wait_until_ready(self, patience_s: float = TIMEOUT_S) -> float:
        """Seconds until the pages answer that they are ready, through the proxy. Raises NotReady."""
        began_s = time.monotonic()
        while (reason := self._reason_not_ready()) and time.monotonic() - began_s < patience_s:
            time.sleep(0.05)
        if reason:
            raise NotReady(f"{reason} after {patience_s:.0f} s; the logs are in {self.places.logs}")
        return time.monotonic() - began_s

    def trust(self) -> ssl.SSLContext:
        """For clients in Python."""
        return ssl.create_default_context(cafile=str(self.authority))

    def renew_certificate(self) -> None:
        """A new one of the same authority; the proxy sees it within five seconds."""
        make_certificate(self._certificates)

    def environment(self) -> dict[str, str]:
        """For a process of the caller's that works on this installation."""
        return os.environ | self.settings

    def manage(self, *arguments: str) -> str:
        """manage.py in this installation. Raises subprocess.CalledProcessError; what it says on standard error is shown."""
        command = [sys.executable, str(PROJECT_DIR / "manage.py"), *arguments]
        return subprocess.run(command, env=self.environment(), cwd=PROJECT_DIR, stdout=subprocess.PIPE, text=True, check=True).stdout

    # --- replicas --------------------------------------------------------------------------------------------------------------------

    def names(self, kind: str = "") -> list[str]:
        """Names of replicas that are to run, of one kind or of all."""
        return sorted(name for name in self._started if not kind or kind_of(name) == kind)

    def spare_names(self, kind: str) -> list[str]:
        """Names of replicas that could be started."""
        return sorted((name for name in self._programs if name not in self._started and kind_of(name) == kind), key=_number)

    def start(self, name: str) -> None:
        """Start it and return at once."""
        self._started.add(name)
        self.supervisor.start_programs([name])

    def stop(self, name: str, patience_s: float = 60.0) -> float:
        """End it softly, and return when it has ended: seconds that it took. It is not started again. After its patience it is killed."""
        began_s = time.monotonic()
        self._started.discard(name)
        self.supervisor.stop_program(name)
        while self.state(name).state == "STOPPING" and time.monotonic() - began_s < patience_s:
            time.sleep(0.02)
        return time.monotonic() - began_s

    def restart(self, name: str) -> None:
        """Soft end and new start."""
        self.stop(name)
        self.start(name)

    def kill(self, name: str, number: signal.Signals = signal.SIGKILL, *, alone: bool = False) -> int:
        """Send a signal to every process of a replica, or to its first one alone; the supervisor starts again what has ended.

        Returns the process id of the first. Servers can be named, too: postgresql, redis.
        """
        pid = self.pid(name)
        if pid == 0:
            raise ProcessLookupError(f"{name} does not run")
        if alone or name in SERVERS:
            os.kill(pid, number)
        else:
            os.killpg(pid, number)  # the supervisor gives each program a group of its own
        return pid

    def wait_for_another(self, name: str, pid: int, patience_s: float = TIMEOUT_S) -> float:
        """Seconds until the replica runs as another process than `pid`, which is gone."""
        began_s = time.monotonic()
        while is_alive(pid) or self.pid(name) in {0, pid}:
            if time.monotonic() - began_s > patience_s:
                raise NotReady(f"{name} was not started again in {patience_s:.0f} s; see {self.log(name)}")
            time.sleep(0.02)
        return time.monotonic() - began_s

    def let_in(self, *names: str) -> None:
        """From now on the proxy finds these replicas of web and live (by_name)."""
        self._publish_names(self._let_in | set(names))

    def keep_out(self, *names: str) -> None:
        """The proxy forgets these within its two seconds, and sends them nothing more; what they have they go on answering (by_name)."""
        self._publish_names(self._let_in - set(names))

    def is_ready(self, name: str) -> bool:
        """Whether this replica of web answers that it is ready: itself, not the proxy for it."""
        try:
            with self._connection(name) as connection:
                connection.sendall(b"GET /readyz HTTP/1.0\r\nHost: localhost\r\nX-Forwarded-Proto: https\r\n\r\n")
                return connection.recv(100).split()[1:2] == [b"200"]
        except OSError:
            return False

    def state(self, name: str) -> ProgramState:
        """What the supervisor says of it."""
        return next(state for state in self.supervisor.states() if state.name == name)

    def pid(self, name: str) -> int:
        """Process id of its first process; 0 while it does not run."""
        return self.state(name).pid

    def log(self, name: str) -> Path:
        return self.places.logs / f"{name}.log"

    def address_for_uavs(self, name: str = "gateway", link: str = "UDP") -> tuple[str, int]:
        """Where a gateway takes MAVLink: by UDP or TCP."""
        host, _, port = self._programs[name].environment[f"SPANWISE_GATEWAY_{link}"].rpartition(":")
        return host, int(port)

    def usage(self) -> dict[str, Usage]:
        """By name, of everything that runs, the servers and the supervisor itself included."""
        roots = {state.name: [state.pid] for state in self.supervisor.states() if state.pid}
        found = usage(roots)
        return {name: taken for name, taken in found.items() if taken.processes}

    # --- inside ----------------------------------------------------------------------------------------------------------------------

    def _proxy(self, most: Mapping[str, int]) -> Program:
        """The proxy of the image, in front of unix sockets as in ./run."""
        certificate, key = make_certificate(self._certificates)
        environment = {
            "SPANWISE_PROXY_WEB": self._addresses("web", most),
            "SPANWISE_PROXY_LIVE": self._addresses("live", most),
            "SPANWISE_PROXY_UAV_LINK": self._addresses("uav-link", most),
            "SPANWISE_PROXY_PORT": f"127.0.0.1:{self.plain_port}",
            "SPANWISE_PROXY_TLS_PORT": f"127.0.0.1:{self.port}",
            "SPANWISE_TLS_CERTIFICATE": str(certificate),
            "SPANWISE_TLS_KEY": str(key),
        }
        if self.name_server:
            environment |= {"SPANWISE_PROXY_RESOLVES": "1", "SPANWISE_PROXY_NAME_SERVER": self.name_server.address}
        command = [sys.executable, "-m", "scripts.container.container", "proxy"]
        return Program("proxy", PROGRAM_STAGE, command, self.places.process("proxy"), patience_s=20, environment=environment)

    def _addresses(self, kind: str, most: Mapping[str, int]) -> str:
        if self.name_server:
            return f"{kind}.{SITE}:{self._ports[kind]}"
        names = [name_of(kind, number) for number in range(1, max(1, most[kind]) + 1)]
        return ",".join(f"unix:{self.sockets / name}.sock" for name in names)

    def _replicas(self, most: Mapping[str, int]) -> list[Program]:
        programs = replicas(self.places, self.sockets, most)
        if not self.name_server:
            return programs
        return [
            at_address(program, self._host(program.name), self._ports[kind_of(program.name)]) if kind_of(program.name) in HOSTS else program
            for program in programs
        ]

    def _host(self, name: str) -> str:
        return f"{HOSTS[kind_of(name)]}.{_number(name)}"

    def _connection(self, name: str) -> socket.socket:
        if self.name_server:
            return socket.create_connection((self._host(name), self._ports[kind_of(name)]), ANSWERS_WITHIN_S)
        connection = socket.socket(socket.AF_UNIX)
        connection.settimeout(ANSWERS_WITHIN_S)
        connection.connect(str(self.sockets / f"{name}.sock"))
        return connection

    def _publish_names(self, let_in: set[str]) -> None:
        if self.name_server is None:
            raise RuntimeError("this installation's proxy does not ask for names")
        self._let_in = let_in
        for kind in HOSTS:
            self.name_server.notify(f"{kind}.{SITE}", sorted(self._host(name) for name in let_in if kind_of(name) == kind))

    def _give_settings(self) -> None:
        shared = dict(self.settings)
        if "gateway" in self._programs:
            shared["SPANWISE_SIMULATOR_GATEWAY"] = self._programs["gateway"].environment["SPANWISE_GATEWAY_UDP"]
        self._programs = {name: replace(program, environment=shared | program.environment) for name, program in self._programs.items()}

    def _start(self) -> None:
        servers = []
        self.supervisor.end_leftovers()
        if self._is_own_database:
            database_cluster.prepare_cluster(self.places)
            servers.append(database_server(self.places, self.sockets))
        if self._is_own_redis:
            servers.append(queue_server(self.places, self.sockets))
        self.supervisor.start([*servers, *self._programs.values()])
        if self._is_own_database:
            database_cluster.wait_for_database(self.sockets)
            if not database_cluster.database_exists(self.sockets):
                database_cluster.create_database(self.sockets)
        if self._is_own_redis:
            database_cluster.wait_for_queue(self.sockets)
        # As ./run's set-up does: else each program compiles the planners' core for itself, and keeps 570 MiB of the compiler's.
        subprocess.run([sys.executable, "-m", "scripts.compile_core"], env=self.environment(), cwd=PROJECT_DIR, check=True)
        self.manage("migrate", "--verbosity", "0")
        if (PROJECT_DIR / "node_modules").exists():  # else the checkout has not been set up; static files then keep their plain names
            self.manage("collectstatic", "--no-input", "--verbosity", "0")
        self.manage("make_api_document")
        if self.name_server:
            self.let_in(*self.names("web"), *self.names("live"))
        first = [*self.names("web"), "proxy"]  # the others once those answer, since all of them at once hold each other up
        self.supervisor.start_programs(first)
        self.wait_until_ready()
        self.supervisor.start_programs(name for name in self.names() if name not in first)

    def _reason_not_ready(self) -> str:
        try:
            with urllib.request.urlopen(f"{self.address}/readyz", timeout=10, context=self.trust()) as answer:  # noqa: S310 - our own address
                return "" if answer.status == 200 else f"/readyz answers {answer.status}"
        except urllib.error.HTTPError as error:
            with error:
                return f"/readyz answers {error.code}: {json.loads(error.read() or b'{}')}"
        except OSError as error:
            return f"no answer: {error}"


def _number(name: str) -> int:
    number = name.rpartition("-")[2]
    return int(number) if number.isdigit() else 1
