"""What each program of Spanwise is started with, by `./run` and in a container alike; where it listens is the caller's."""

import os
import sys

from scripts.places import PROJECT_DIR

BACKLOG = "4096"  # connections that wait for a program: as many as Linux allows unless told (net.core.somaxconn)
QUEUES = ("data", "planning", "simulation")


def web(*where: str) -> list[str]:
    """Pages and API. One process a program: of several on one socket the first to wake takes most of the work."""
    command = [sys.executable, "-m", "granian", "--interface", "wsgi", *where, "--workers", "1"]
    command += ["--no-ws", "--blocking-threads", "4", "--backlog", BACKLOG, "--http", "1", "--workers-kill-timeout", "8"]
    return [*command, "--respawn-failed-workers", "--respawn-interval", "0.5", "--log-level", "warning", "config.wsgi:application"]


def live(*where: str) -> list[str]:
    """Websockets."""
    command = [sys.executable, "-m", "granian", "--interface", "asginl", *where, "--workers", "1"]
    command += ["--backlog", BACKLOG, "--http", "1", "--workers-kill-timeout", "8", "--respawn-failed-workers", "--respawn-interval", "0.5"]
    return [*command, "--log-level", "warning", "config.asgi:application"]


def celery(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "celery", "--app", "config.celery", "--quiet", *arguments]


def worker(queue: str, processes: int) -> list[str]:
    """Of one queue. Workers need not know of each other, and start sooner without it."""
    arguments = ["--loglevel", os.environ.get("SPANWISE_LOG_LEVEL", "WARNING"), "--queues", queue, "--hostname", f"{queue}@%h"]
    arguments += ["--concurrency", str(processes), "--without-gossip", "--without-mingle", "--without-heartbeat"]
    return celery("worker", *arguments)


def beat() -> list[str]:
    """Celery's schedule: one of it everywhere, though two of it would do no harm."""
    return celery("beat", "--loglevel", "WARNING", "--pidfile", "")


def management(*arguments: str) -> list[str]:
    return [sys.executable, str(PROJECT_DIR / "manage.py"), *arguments]
