"""Start commands of the programs of Spanwise, for `./run` and containers alike; the caller adds where they listen."""

import os
import sys

from operation.json_lines import is_asked_for
from scripts.places import PROJECT_DIR

GRANIAN_LOG = PROJECT_DIR / "operation" / "granian_log.json"
BACKLOG = "4096"  # pending connections of a program: the default limit of Linux (net.core.somaxconn)
QUEUES = ("data", "flight", "planning", "proofs", "simulation")

PROOF_MEMORY_KB = 500_000  # a process that holds more after a task is replaced

# The C library gives each thread a pool of its own, up to eight per core, and returns little memory of a pool. Python's threads run in
# turn, so two pools suffice.
MEMORY = {"MALLOC_ARENA_MAX": "2"}


def _python(program: str, *arguments: str) -> list[str]:
    """Return the command for a module, or a file that ends in .py. With JSON logs, all of its output is JSON."""
    if is_asked_for():
        return [sys.executable, "-m", "operation.json_lines", program, *arguments]
    return [sys.executable, *([] if program.endswith(".py") else ["-m"]), program, *arguments]


def _granian(*arguments: str) -> list[str]:
    log = ["--log-level", "warning", *(["--log-config", str(GRANIAN_LOG)] if is_asked_for() else [])]
    return _python("granian", *log, *arguments)


def web(*where: str) -> list[str]:
    """Return the command for pages and API. One process per program: of several on one socket the first to wake takes most of the work."""
    return _wsgi("config.wsgi:application", *where)


def uav_link(*where: str) -> list[str]:
    """Return the command for the HTTP link of UAVs, which is independent of the load from pages."""
    return _wsgi("config.uav_link:application", *where)


def _wsgi(application: str, *where: str) -> list[str]:
    command = ["--interface", "wsgi", *where, "--workers", "1"]
    command += ["--no-ws", "--blocking-threads", "4", "--backlog", BACKLOG, "--http", "1", "--workers-kill-timeout", "8"]
    return _granian(*command, "--respawn-failed-workers", "--respawn-interval", "0.5", application)


def live(*where: str) -> list[str]:
    """Return the command for websockets."""
    command = ["--interface", "asginl", *where, "--workers", "1"]
    command += ["--backlog", BACKLOG, "--http", "1", "--workers-kill-timeout", "8", "--respawn-failed-workers", "--respawn-interval", "0.5"]
    return _granian(*command, "config.asgi:application")


def celery(*arguments: str) -> list[str]:
    return _python("celery", "--app", "config.celery", "--quiet", *arguments)


def data_processes() -> int:
    """Return the number of processes, by default two: imports of one organisation leave one free (config/settings.py has the same)."""
    return int(os.environ.get("SPANWISE_DATA_WORKERS", "2"))


def worker(queue: str, processes: int) -> list[str]:
    """Return the command for the worker of a queue. Workers do not need each other's events, and start sooner without them."""
    arguments = ["--loglevel", os.environ.get("SPANWISE_LOG_LEVEL", "WARNING"), "--queues", queue, "--hostname", f"{queue}@%h"]
    arguments += ["--concurrency", str(processes), "--without-gossip", "--without-mingle", "--without-heartbeat"]
    if queue == "proofs":  # alone loads OR-tools, and returns its memory after a large proof
        arguments += ["--include", "missions.proof_tasks", "--max-memory-per-child", str(PROOF_MEMORY_KB)]
    return celery("worker", *arguments)


def beat() -> list[str]:
    """Return the command for Celery's schedule: one process everywhere, though two would do no harm."""
    return celery("beat", "--loglevel", "WARNING", "--pidfile", "")


def management(*arguments: str) -> list[str]:
    return _python(str(PROJECT_DIR / "manage.py"), *arguments)
