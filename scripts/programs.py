"""The programs of one installation: what each is started with, in which order, and how it is stopped."""

import os
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

from scripts.places import DATABASE_USER, PROJECT_DIR, TELLING_PROGRAMS, WEB_PROGRAMS, CannotStart, Places, telling_socket
from scripts.postgresql_installations import server_for
from scripts.system_packages import find_program


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
        """The command as the supervisor runs it: through scripts.start_program, which clears up after a killed instance."""
        options = [str(self.folder), "--stop-signal", self.stop_signal]
        if self.user:
            options += ["--user", self.user]
        for path in self.stale_files:
            options += ["--stale", str(path)]
        return [sys.executable, "-m", "scripts.start_program", *options, "--", *self.command]


BACKLOG = "4096"  # connections that wait for a program: as many as Linux allows unless told (net.core.somaxconn)
SERVERS_STAGE, PROGRAM_STAGE = 1, 2
SERVERS = ("postgresql", "redis")


def database_server(places: Places, sockets: Path, *, is_durable: bool = True) -> Program:
    """PostgreSQL on a unix socket. A server for tests alone need not wait for the disk."""
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
    """Redis on a unix socket, with its append-only file."""
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


def _celery(places: Places, name: str, *arguments: str) -> Program:
    return Program(
        name=name,
        stage=PROGRAM_STAGE,
        command=[sys.executable, "-m", "celery", "--app", "config.celery", "--quiet", *arguments],
        folder=places.process(name),
        # QUIT is Celery's soft shutdown: running tasks get CELERY_WORKER_SOFT_SHUTDOWN_TIMEOUT, then go back to the queue.
        stop_signal="TERM" if name == "beat" else "QUIT",
        patience_s=20,
    )


def _worker(places: Places, queue: str, processes: int) -> Program:
    arguments = [
        "--loglevel",
        os.environ.get("SPANWISE_LOG_LEVEL", "WARNING"),
        "--queues",
        queue,
        "--hostname",
        f"{queue}@%h",
        "--concurrency",
        str(processes),
    ]
    quick_start = ["--without-gossip", "--without-mingle", "--without-heartbeat"]  # workers need not know of each other
    return _celery(places, f"worker-{queue}", "worker", *arguments, *quick_start)


def _web(places: Places, name: str, socket: Path) -> Program:
    """Pages and API. One process a program: of several on one socket the first to wake takes most of the work."""
    granian = [sys.executable, "-m", "granian", "--interface", "wsgi", "--uds", str(socket), "--workers", "1"]
    granian += ["--no-ws", "--blocking-threads", "4", "--backlog", BACKLOG, "--http", "1", "--workers-kill-timeout", "10"]
    granian += ["--respawn-failed-workers", "--respawn-interval", "0.5", "--log-level", "warning", "config.wsgi:application"]
    return Program(name=name, stage=PROGRAM_STAGE, command=granian, folder=places.process(name), patience_s=20, stale_files=[socket])


def _gateway(places: Places) -> Program:
    """Where vehicles connect. It waits for a port that another installation on the machine holds."""
    command = [sys.executable, str(PROJECT_DIR / "manage.py"), "run_gateway"]
    return Program(name="gateway", stage=PROGRAM_STAGE, command=command, folder=places.process("gateway"), patience_s=12)


def _estimator(places: Places) -> Program:
    """Where UAVs are between their reports. Another one beside it takes over when it is gone."""
    command = [sys.executable, str(PROJECT_DIR / "manage.py"), "run_estimator"]
    return Program(name="estimator", stage=PROGRAM_STAGE, command=command, folder=places.process("estimator"), patience_s=12)


def _simulator(places: Places) -> Program:
    """Where simulated UAVs fly in real time."""
    command = [sys.executable, str(PROJECT_DIR / "manage.py"), "run_simulator"]
    return Program(name="simulator", stage=PROGRAM_STAGE, command=command, folder=places.process("simulator"), patience_s=12)


def _told(places: Places, sockets: Path, program: Program) -> Program:
    """The same program, which tells how it does. Workers have several processes, which count together in a folder."""
    environment = {"SPANWISE_PROGRAM": program.name, "SPANWISE_METRICS": f"unix:{telling_socket(sockets, program.name)}"}
    if program.name.startswith("worker-"):
        environment["PROMETHEUS_MULTIPROC_DIR"] = str(places.process(program.name) / "metrics")
        environment["REMAP_SIGTERM"] = "SIGQUIT"  # to a worker TERM says the same as QUIT
    return replace(program, environment=program.environment | environment)


def web_programs(places: Places, sockets: Path) -> list[Program]:
    """Every process of Spanwise itself."""
    return [_told(places, sockets, program) if program.name in TELLING_PROGRAMS else program for program in _programs(places, sockets)]


def _programs(places: Places, sockets: Path) -> list[Program]:
    live = [sys.executable, "-m", "granian", "--interface", "asginl", "--uds", str(sockets / "live.sock"), "--workers", "1"]
    live += ["--backlog", BACKLOG, "--http", "1", "--workers-kill-timeout", "5", "--respawn-failed-workers", "--respawn-interval", "0.5"]
    live += ["--log-level", "warning", "config.asgi:application"]
    configuration = places.generated / "nginx.conf"
    nginx = [find_program("nginx") or "nginx", "-e", "stderr", "-p", str(places.process("proxy")), "-c", str(configuration)]
    return [
        *(_web(places, name, sockets / f"{name}.sock") for name in WEB_PROGRAMS),
        Program(
            name="live",
            stage=PROGRAM_STAGE,
            command=live,
            folder=places.process("live"),
            patience_s=10,
            stale_files=[sockets / "live.sock"],
        ),
        _worker(places, "data", 1),
        _worker(places, "planning", max(1, min(4, (os.cpu_count() or 2) - 1))),
        _worker(places, "simulation", 1),
        _gateway(places),
        _estimator(places),
        _simulator(places),
        _celery(places, "beat", "beat", "--loglevel", "WARNING", "--pidfile", ""),
        Program(name="proxy", stage=PROGRAM_STAGE, command=nginx, folder=places.process("proxy")),
    ]
