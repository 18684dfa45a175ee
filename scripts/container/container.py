"""Become one of the programs, in a container: spanwise NAME [ARGUMENT...]

web live uav-link proxy
gateway estimator simulator · worker-data worker-flight worker-planning worker-proofs worker-simulation beat
migrate · manage ARGUMENT... · healthy
backup [FOLDER] · restore FOLDER [--replace]     (the database and flight logs; the site keeps the key itself)

The image's entry point. All configuration comes from the environment: docs/deployment.md. SIGTERM shuts each of them down gracefully.
"""

import os
import resource
import sys
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from typing import NoReturn

from config.environment import secret
from config.private_servers import state_directory
from operation.json_lines import is_asked_for, write_json_lines
from scripts import commands
from scripts.container import container_health, container_proxy
from scripts.places import PROJECT_DIR
from scripts.proxy.inner_tls import inner_certificate, look_after

WEB_PORT, LIVE_PORT, UAV_LINK_PORT = 8000, 8001, 8002
SERVING = ("web", "live", "uav-link")  # behind the proxy
METRICS = "0.0.0.0:9464"
SECRETS = ("DATABASE_URL", "REDIS_URL", "SPANWISE_SECRET_KEY")
BACKUPS = "/var/lib/spanwise-backups"
BY_HAND = ("manage", "backup", "restore")  # a user reads their output
EXIT_WRONG = 2

# Environment set in addition to the command; existing values are kept.
WORKER_ENVIRONMENT = {"REMAP_SIGTERM": "SIGQUIT"}  # Celery's soft shutdown: running work gets some seconds, then returns to the queue


def _listening(port: int) -> tuple[str, ...]:
    return "--host", os.environ.get("SPANWISE_LISTEN_HOST", "0.0.0.0"), "--port", str(port)  # noqa: S104 - the container's own network


def _worker(queue: str) -> list[str]:
    usual = commands.data_processes() if queue == "data" else 1
    return commands.worker(queue, int(os.environ.get("SPANWISE_WORKER_PROCESSES", usual)))


PROGRAMS: dict[str, Callable[[], list[str]]] = {
    "web": lambda: commands.web(*_listening(int(os.environ.get("SPANWISE_WEB_PORT", WEB_PORT)))),
    "live": lambda: commands.live(*_listening(int(os.environ.get("SPANWISE_LIVE_PORT", LIVE_PORT)))),
    "uav-link": lambda: commands.uav_link(*_listening(int(os.environ.get("SPANWISE_UAV_LINK_PORT", UAV_LINK_PORT)))),
    "gateway": lambda: commands.management("run_gateway"),
    "estimator": lambda: commands.management("run_estimator"),
    "simulator": lambda: commands.management("run_simulator"),
    **{f"worker-{queue}": lambda queue=queue: _worker(queue) for queue in commands.QUEUES},  # type: ignore[misc]
    "beat": commands.beat,
    "migrate": lambda: commands.management("migrate", "--no-input"),
}


def environment(program: str) -> dict[str, str]:
    """Return the environment of a program: the given one, with defaults for every container of it."""
    usual = {"SPANWISE_PROGRAM": program, **commands.MEMORY}
    if program != "migrate":
        usual["SPANWISE_METRICS"] = METRICS
    if program.startswith("worker-"):
        usual |= WORKER_ENVIRONMENT
        usual["PROMETHEUS_MULTIPROC_DIR"] = str(state_directory() / "metrics")  # its processes share metrics
    return usual | os.environ


def _backups(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "scripts.backups", *arguments]


def _with_database() -> dict[str, str]:
    """Return the environment for programs that take only the database's address."""
    return os.environ | {"DATABASE_URL": secret("DATABASE_URL")}


def _become(command: list[str], reported: Mapping[str, str]) -> NoReturn:
    _open_as_many_files_as_allowed()
    os.execvpe(command[0], command, reported)  # noqa: S606 - no shell


def missing_secrets() -> list[str]:
    """Return the required secrets that are not set. A container has no storage, so a generated secret would differ in the next one."""
    return [name for name in SECRETS if not os.environ.get(name) and not os.environ.get(f"{name}_FILE")]


def _open_as_many_files_as_allowed() -> None:
    files, most_files = resource.getrlimit(resource.RLIMIT_NOFILE)
    if files < most_files:  # a thousand open pages need a thousand files
        resource.setrlimit(resource.RLIMIT_NOFILE, (most_files, most_files))


def main(arguments: list[str]) -> int:
    name, *rest = arguments or ["web"]
    if is_asked_for() and name not in BY_HAND:
        os.environ.setdefault("SPANWISE_PROGRAM", name)
        write_json_lines()
    if name == "healthy":
        return container_health.main()
    if name == "proxy":
        _open_as_many_files_as_allowed()
        return container_proxy.main()
    if name not in PROGRAMS and name not in BY_HAND:
        print(f"No program is called {name!r}. {__doc__}", file=sys.stderr)
        return EXIT_WRONG
    if missing := missing_secrets():
        print(f"Not set, neither itself nor with _FILE: {', '.join(missing)}. See docs/deployment.md", file=sys.stderr)
        return EXIT_WRONG
    state_directory().mkdir(parents=True, exist_ok=True)
    if name == "backup":
        place = rest or [f"{BACKUPS}/spanwise-{datetime.now(UTC):%Y-%m-%dT%H-%M-%SZ}"]
        _become(_backups(name, *place, "--without-key"), _with_database())
    if name == "restore":
        _become(_backups(name, *rest), _with_database())
    if name == "manage":
        _become([sys.executable, str(PROJECT_DIR / "manage.py"), *rest], os.environ)
    served = inner_certificate(state_directory() / "inner") if name in SERVING else None
    if served is not None:
        served.copy()
        look_after(served)
    _become([*PROGRAMS[name](), *(served.arguments() if served else []), *rest], environment(name))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
