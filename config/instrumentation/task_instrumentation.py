"""Instrumentation of Celery's programs: context passed with tasks, durations, and health."""

import logging
import logging.config
import os
from contextlib import AbstractContextManager
from pathlib import Path
from time import perf_counter
from typing import Any

from celery import Task, signals
from celery.app.task import Context
from celery.beat import PersistentScheduler
from celery.bootsteps import StartStopStep
from django.conf import settings
from prometheus_client.multiprocess import mark_process_dead

from operation import loop_heartbeats
from operation.log_context import about, facts
from operation.metrics import PROCESSES_FOLDER, TASK_SECONDS, TASKS
from operation.program import program_begins
from operation.readiness import redis_faults

logger = logging.getLogger(__name__)

HEADER = "spanwise_about"
JOB_ARGUMENT = "job_id"  # the first argument of tasks that do a job
CARRIED = ("request", "mission", "uav")
OUTCOMES = {"SUCCESS": "done", "FAILURE": "failed", "RETRY": "retried", "REJECTED": "rejected", "IGNORED": "ignored", "REVOKED": "revoked"}
HEARTBEAT_INTERVAL_S, BEAT_WITHIN_S = 10.0, 120.0

_under_way: dict[str, tuple[float, AbstractContextManager[None]]] = {}


def watch_tasks() -> None:
    """Connect the signals. Call once, when the Celery application is made."""
    signals.before_task_publish.connect(_send_along)
    signals.task_prerun.connect(_begin)
    signals.task_postrun.connect(_end)
    signals.setup_logging.connect(_set_up_logging)
    signals.worker_init.connect(_before_processes)
    signals.worker_ready.connect(lambda **_: program_begins("worker"), weak=False)
    signals.worker_process_shutdown.connect(_process_has_gone)


class LoopPulse(StartStopStep):
    """Sends heartbeats of the worker's own loop."""

    requires = ("celery.worker.components:Timer",)

    def start(self, worker: Any) -> None:
        _worker_goes_round()
        self._timer = worker.timer.call_repeatedly(HEARTBEAT_INTERVAL_S, _worker_goes_round)

    def stop(self, worker: Any) -> None:
        self._timer.cancel()
        loop_heartbeats.stop("the worker")


class WatchedScheduler(PersistentScheduler):
    """Celery's scheduler with heartbeats."""

    def tick(self, *arguments: Any, **named: Any) -> Any:
        loop_heartbeats.send_heartbeat("the schedule", within_s=BEAT_WITHIN_S, excuse=_is_redis_away)
        return super().tick(*arguments, **named)


def _worker_goes_round() -> None:
    loop_heartbeats.send_heartbeat("the worker", within_s=BEAT_WITHIN_S, excuse=_is_redis_away)


def _is_redis_away() -> bool:
    return bool(redis_faults())


def _send_along(headers: dict[str, Any] | None = None, **_: Any) -> None:
    known = {name: value for name, value in facts().items() if name in CARRIED}
    if headers is not None and known:
        headers[HEADER] = known


def _begin(task_id: str, task: Task, args: tuple[Any, ...] = (), **_: Any) -> None:
    known = _carried(task.request)
    job = {"job": args[0]} if args and JOB_ARGUMENT in getattr(task.run, "__annotations__", {}) else {}
    held = about(**known, **job)
    held.__enter__()
    _under_way[task_id] = perf_counter(), held


def _carried(request: Context) -> dict[str, str]:
    known = getattr(request, HEADER, None)
    return {name: str(known[name])[:64] for name in CARRIED if name in known} if isinstance(known, dict) else {}


def _end(task_id: str, task: Task, state: str | None = None, **_: Any) -> None:
    began_s, held = _under_way.pop(task_id, (None, None))
    if began_s is None or held is None:
        return
    held.__exit__(None, None, None)
    TASK_SECONDS.labels(task.name).observe(perf_counter() - began_s)
    TASKS.labels(task.name, OUTCOMES.get(state or "", "other")).inc()


def _set_up_logging(loglevel: int | str | None = None, **_: Any) -> None:
    """Set up logging in place of Celery, for one format in all programs."""
    logging.config.dictConfig(settings.LOGGING)
    if loglevel is not None:
        logging.getLogger().setLevel(loglevel)


def _before_processes(**_: Any) -> None:
    """Remove the metric files of an earlier worker; a worker's tasks run in processes of their own, which count into files."""
    folder = os.environ.get(PROCESSES_FOLDER)
    if folder is None:
        if os.environ.get("SPANWISE_METRICS"):
            logger.warning("%s is not set: tasks of this worker are not counted", PROCESSES_FOLDER)
        return
    for left in Path(folder).glob("*.db"):
        if not left.stem.endswith(f"_{os.getpid()}"):
            left.unlink()


def _process_has_gone(pid: int, **_: Any) -> None:
    if PROCESSES_FOLDER in os.environ:
        mark_process_dead(pid)
