"""Metrics of the whole installation from the database and Redis: queues, jobs, commands to UAVs, the graph, alerts.

Every process would report the same, so only the schedule (beat), of which there is one, does.
"""

import logging
import threading
import time
from collections import defaultdict
from collections.abc import Mapping
from datetime import datetime
from typing import Any

from celery import Celery
from django.db import DatabaseError, connections
from django.db.models import Count, Min
from django.utils import timezone
from kombu.exceptions import OperationalError
from redis.exceptions import RedisError

from inspection.models import GraphSnapshot, Ground
from missions.models import OPEN_COMMANDS, CommandState, UavCommand
from operation.snapshots import Described, SnapshotCollector, Values
from telemetry.models import Alert, AlertLevel
from workspace.models import OPEN_STATES, Job

logger = logging.getLogger(__name__)

GOOD_FOR_S = 5.0
DATABASE, REDIS = "spanwise_database_up", "spanwise_redis_up"
QUEUE, JOBS, JOB_AGE = "spanwise_queue_length", "spanwise_jobs", "spanwise_job_age_seconds"
OUTBOX, OUTBOX_AGE = "spanwise_outbox_commands", "spanwise_outbox_age_seconds"
GRAPH_AGE, GRAPH_BEHIND = "spanwise_graph_age_seconds", "spanwise_graph_behind_seconds"
ALERTS = "spanwise_alerts_open"
DESCRIBED = (
    Described(DATABASE, "1 while the database answers"),
    Described(REDIS, "1 while Redis answers"),
    Described(QUEUE, "Messages that wait in a queue of Celery", ["queue"]),
    Described(JOBS, "Jobs that are not done", ["queue", "state"]),
    Described(JOB_AGE, "Since the oldest of these was asked for", ["queue", "state"]),
    Described(OUTBOX, "Commands to UAVs that have not ended", ["state"]),
    Described(OUTBOX_AGE, "Since the oldest of these was given", ["state"]),
    Described(GRAPH_AGE, "Since the newest graph was built"),
    Described(GRAPH_BEHIND, "Since the ground was changed that the newest graph does not show; 0 where it shows all"),
    Described(ALERTS, "Alerts that are open and not acknowledged", ["level"]),
)


class InstallationState:
    """Reads at most every 5 s, however often it is asked. Values that cannot be read are omitted and reported as unavailable."""

    def __init__(self, celery: Celery) -> None:
        self._celery = celery
        self._lock = threading.Lock()
        self._checked_s = -GOOD_FOR_S
        self._values: dict[str, Values] = {}

    def snapshot(self) -> SnapshotCollector:
        return SnapshotCollector(DESCRIBED, self.read)

    def read(self) -> Mapping[str, Values]:
        with self._lock:
            if time.monotonic() - self._checked_s >= GOOD_FOR_S:
                self._values = {**self._of_database(), **self._of_redis()}
                self._checked_s = time.monotonic()
            return self._values

    def _of_database(self) -> dict[str, Values]:
        try:
            now = timezone.now()
            return {DATABASE: {(): 1.0}, **self._jobs(now), **_outbox(now), **_graph(now), **_alerts()}
        except DatabaseError as error:
            logger.debug("the state cannot be read: %s", error)
            return {DATABASE: {(): 0.0}}
        finally:
            connections.close_all()  # only this thread's

    def _jobs(self, now: datetime) -> dict[str, Values]:
        counts: defaultdict[tuple[str, ...], float] = defaultdict(int)
        ages_s: defaultdict[tuple[str, ...], float] = defaultdict(float)
        for queue in self._queues():
            for state in OPEN_STATES:
                counts[queue, str(state)] = 0
                ages_s[queue, str(state)] = 0.0
        rows = Job.objects.filter(state__in=OPEN_STATES).values_list("task", "state").annotate(Count("pk"), Min("created_at"))
        for task, state, number, oldest in rows.order_by():
            place = (self._queue_of(task), state)
            counts[place] += number
            ages_s[place] = max(ages_s[place], (now - oldest).total_seconds())
        return {JOBS: counts, JOB_AGE: ages_s}

    def _of_redis(self) -> dict[str, Values]:
        try:
            with self._celery.connection_for_read() as connection:
                channel: Any = connection.default_channel
                lengths: dict[tuple[str, ...], float] = {(queue,): float(channel.client.llen(queue)) for queue in self._queues()}
        except (RedisError, OperationalError, OSError):
            return {REDIS: {(): 0.0}}
        return {REDIS: {(): 1.0}, QUEUE: lengths}

    def _queues(self) -> list[str]:
        routed = {str(route["queue"]) for route in self._celery.conf.task_routes.values()}
        return sorted({str(self._celery.conf.task_default_queue), *routed})

    def _queue_of(self, task: str) -> str:
        found = self._celery.amqp.router.route({}, task)["queue"]
        return str(getattr(found, "name", found))


def _outbox(now: datetime) -> dict[str, Values]:
    counts: dict[tuple[str, ...], float] = {(str(CommandState(state)),): 0.0 for state in OPEN_COMMANDS}
    ages_s = dict(counts)
    rows = UavCommand.objects.filter(state__in=OPEN_COMMANDS).values_list("state").annotate(Count("pk"), Min("created_at"))
    for state, number, oldest in rows.order_by():
        counts[state,] = number
        ages_s[state,] = (now - oldest).total_seconds()
    return {OUTBOX: counts, OUTBOX_AGE: ages_s}


def _graph(now: datetime) -> dict[str, Values]:
    newest = GraphSnapshot.objects.order_by("-version").values_list("ground_revision", "built_at").first()
    if newest is None:
        return {}
    revision, built_at = newest
    ground = Ground.objects.filter(revision__gt=revision).values_list("changed_at", flat=True).first()
    behind_s = 0.0 if ground is None else (now - ground).total_seconds()
    return {GRAPH_AGE: {(): (now - built_at).total_seconds()}, GRAPH_BEHIND: {(): behind_s}}


def _alerts() -> dict[str, Values]:
    counts: dict[tuple[str, ...], float] = {(str(level),): 0.0 for level in AlertLevel.values}
    rows = Alert.objects.filter(closed_at=None, acknowledged_at=None).values_list("level").annotate(Count("pk"))
    for level, number in rows.order_by():
        counts[str(level),] = number
    return {ALERTS: counts}
