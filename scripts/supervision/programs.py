"""The programs of one installation: start commands, order, and how they are stopped."""

import os
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

from operation.json_lines import is_asked_for
from scripts import commands
from scripts.installation.postgresql_installations import server_for
from scripts.installation.system_packages import find_program
from scripts.places import DATABASE_USER, PROGRAMS_WITH_METRICS, WEB_PROGRAMS, CannotStart, Places, health_socket


@dataclass(frozen=True)
class Program:
    """One supervised process. Lower stages start first and stop last."""

    name: str
    stage: int
    command: list[str]
    folder: Path
    stop_signal: str = "TERM"
    patience_s: int = 10
    user: str | None = None
    stale_files: list[Path] = field(default_factory=list)
    environment: dict[str, str] = field(default_factory=dict)

    def start_command(self) -> list[str]:
        """Return the supervisor's command, through scripts.supervision.start_program, which cleans up after a killed instance."""
        options = [str(self.folder), "--stop-signal", self.stop_signal]
        if self.user:
            options += ["--user", self.user]
        for path in self.stale_files:
            options += ["--stale", str(path)]
        return [sys.executable, "-m", "scripts.supervision.start_program", *options, "--", *self.command]


SERVERS_STAGE, PROGRAM_STAGE = 1, 2
SERVERS = ("postgresql", "redis")


def database_server(places: Places, sockets: Path, *, is_durable: bool = True) -> Program:
    """Return PostgreSQL on a unix socket. A server for tests does not wait for the disk."""
    data = places.data
    server = server_for(data)
    if server is None:
        raise CannotStart(f"no PostgreSQL with PostGIS on this machine can open {data}")
    settings = {"unix_socket_directories": str(sockets), "listen_addresses": "", "unix_socket_permissions": "0777", "jit": "off"}
    if not is_durable:
        settings |= {"fsync": "off", "synchronous_commit": "off", "full_page_writes": "off"}
    command = [server.program("postgres"), "-D", str(data)]
    for name, value in settings.items():
        command += ["-c", f"{name}={value}"]
    return Program(
        name="postgresql",
        stage=SERVERS_STAGE,
        command=command,
        folder=data,
        stop_signal="INT",  # PostgreSQL's fast shutdown
        patience_s=60,
        user=DATABASE_USER if os.geteuid() == 0 else None,
        stale_files=[data / "postmaster.pid", sockets / ".s.PGSQL.5432.lock"],
    )


def queue_server(places: Places, sockets: Path) -> Program:
    """Return Redis on a unix socket, with its append-only file."""
    settings = {
        "port": "0",
        "unixsocket": str(sockets / "redis.sock"),
        "unixsocketperm": "700",
        "dir": str(places.redis),
        "appendonly": "yes",
        "save": "60 1",
        "daemonize": "no",
        "logfile": "",
    }
    command = [find_program("redis-server") or "redis-server"]
    for name, value in settings.items():
        command += [f"--{name}", value]
    return Program(name="redis", stage=SERVERS_STAGE, command=command, folder=places.redis, patience_s=20)


def _worker(places: Places, queue: str, processes: int) -> Program:
    # QUIT is Celery's soft shutdown: running tasks get CELERY_WORKER_SOFT_SHUTDOWN_TIMEOUT, then return to the queue.
    name = f"worker-{queue}"
    return Program(name, PROGRAM_STAGE, commands.worker(queue, processes), places.process(name), stop_signal="QUIT", patience_s=20)


def _web(places: Places, name: str, socket: Path) -> Program:
    command = (commands.uav_link if name == "uav-link" else commands.web)("--uds", str(socket))
    return Program(name, PROGRAM_STAGE, command, places.process(name), patience_s=20, stale_files=[socket])


def _gateway(places: Places) -> Program:
    """Return the MAVLink gateway. It waits for a port that another installation on the machine uses."""
    return Program("gateway", PROGRAM_STAGE, commands.management("run_gateway"), places.process("gateway"), patience_s=12)


def _estimator(places: Places) -> Program:
    """Return the estimator, which computes UAV positions between reports. A second one takes over when it fails."""
    return Program("estimator", PROGRAM_STAGE, commands.management("run_estimator"), places.process("estimator"), patience_s=12)


def _simulator(places: Places) -> Program:
    """Return the simulator, which flies simulated UAVs in real time."""
    return Program("simulator", PROGRAM_STAGE, commands.management("run_simulator"), places.process("simulator"), patience_s=12)


def _reported(places: Places, sockets: Path, program: Program) -> Program:
    """Return the program with metrics. A worker has several processes, which share a metrics folder."""
    environment = {"SPANWISE_PROGRAM": program.name, "SPANWISE_METRICS": f"unix:{health_socket(sockets, program.name)}"}
    if program.name.startswith("worker-"):
        environment["PROMETHEUS_MULTIPROC_DIR"] = str(places.process(program.name) / "metrics")
        environment["REMAP_SIGTERM"] = "SIGQUIT"  # TERM acts like QUIT on a worker
    memory = {name: os.environ.get(name, usual) for name, usual in commands.MEMORY.items()}
    return replace(program, environment=program.environment | memory | environment)


def web_programs(places: Places, sockets: Path) -> list[Program]:
    """Return every process of Spanwise itself."""
    return [
        _reported(places, sockets, program) if program.name in PROGRAMS_WITH_METRICS else program for program in _programs(places, sockets)
    ]


def _programs(places: Places, sockets: Path) -> list[Program]:
    configuration = places.generated / "nginx.conf"
    nginx = [find_program("nginx") or "nginx", "-e", "stderr", "-p", str(places.process("proxy")), "-c", str(configuration)]
    if is_asked_for():
        nginx = [sys.executable, "-m", "scripts.proxy.proxy_lines", *nginx]
    return [
        *(_web(places, name, sockets / f"{name}.sock") for name in (*WEB_PROGRAMS, "uav-link")),
        Program(
            name="live",
            stage=PROGRAM_STAGE,
            command=commands.live("--uds", str(sockets / "live.sock")),
            folder=places.process("live"),
            patience_s=10,
            stale_files=[sockets / "live.sock"],
        ),
        _worker(places, "data", commands.data_processes()),
        _worker(places, "flight", 1),
        _worker(places, "planning", max(1, min(4, (os.cpu_count() or 2) - 1))),
        _worker(places, "proofs", 1),
        _worker(places, "simulation", 1),
        _gateway(places),
        _estimator(places),
        _simulator(places),
        Program("beat", PROGRAM_STAGE, commands.beat(), places.process("beat"), patience_s=20),
        Program(name="proxy", stage=PROGRAM_STAGE, command=nginx, folder=places.process("proxy")),
    ]
