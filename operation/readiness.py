"""Readiness of this process. It lists what is missing as text: the database, its migrations, Redis, or a check of the program."""

import threading
import time
from collections.abc import Callable
from functools import lru_cache

from django.core.cache import cache
from django.db import Error as DatabaseError
from django.db import connection
from django.db.migrations.loader import MigrationLoader
from django.db.migrations.recorder import MigrationRecorder
from redis.exceptions import RedisError

NO_DATABASE, NO_MIGRATIONS, NO_REDIS = "the database cannot be reached", "migrations are not applied", "Redis cannot be reached"
GOOD_FOR_S = 1.0

Check = Callable[[], list[str]]


def database_faults() -> list[str]:
    """Return faults with one database query. Migrations that this version does not know do not matter."""
    try:
        if _own_migrations() - MigrationRecorder(connection).applied_migrations().keys():
            return [NO_MIGRATIONS]
    except DatabaseError:
        return [NO_DATABASE]
    return []


def redis_faults() -> list[str]:
    try:
        cache.get("ready")
    except (RedisError, OSError):
        return [NO_REDIS]
    return []


class Readiness:
    """The checks of a program. Concurrent calls share one run, and results are reused for a second."""

    def __init__(self, *checks: Check) -> None:
        self._checks = checks or (database_faults, redis_faults)
        self._lock = threading.Lock()
        self._checked_s = -GOOD_FOR_S
        self._faults: list[str] = []

    def faults(self) -> list[str]:
        with self._lock:
            if time.monotonic() - self._checked_s >= GOOD_FOR_S:
                self._faults = [fault for check in self._checks for fault in check()]
                self._checked_s = time.monotonic()
            return self._faults


@lru_cache(maxsize=1)
def _own_migrations() -> frozenset[tuple[str, str]]:
    """Return the last migration of each app, which implies its predecessors."""
    return frozenset(MigrationLoader(None).graph.leaf_nodes())
