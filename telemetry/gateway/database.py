"""Database access from the event loop: threads with a connection each, and an error for failures that a retry may fix.

Waits for row locks are short, because later commands, even an abort, would wait behind them.
"""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, ParamSpec, TypeVar

from django.db import close_old_connections, connection, connections

from workspace.api.errors import DATABASE_UNAVAILABLE

logger = logging.getLogger(__name__)

MAX_LOCK_WAIT_S = 1.0

P = ParamSpec("P")
Result = TypeVar("Result")


class DatabaseUnavailable(Exception):
    """The database is unavailable; retry."""


class DatabaseThread:
    """Runs database calls: one thread in order, several threads whenever one is free."""

    def __init__(self, name: str, threads: int = 1) -> None:
        self._executor = ThreadPoolExecutor(threads, thread_name_prefix=name)
        self._connections: list[Any] = []

    async def run(self, do: Callable[P, Result], /, *args: P.args, **kwargs: P.kwargs) -> Result:
        """Return the result of `do`. Raises DatabaseUnavailable, or what `do` raises."""

        def inside() -> Result:
            close_old_connections()
            try:
                if connection.connection is None:
                    self._connect()
                return do(*args, **kwargs)
            except DATABASE_UNAVAILABLE as error:
                connection.close()
                raise DatabaseUnavailable(str(error)) from error

        return await asyncio.get_running_loop().run_in_executor(self._executor, inside)

    def close(self) -> None:
        self._executor.shutdown(wait=True)
        with ThreadPoolExecutor(1) as closing:  # Django allows no access to a connection in the loop
            list(closing.map(lambda one: one.close(), self._connections))

    def _connect(self) -> None:
        own = connections["default"]
        if own not in self._connections:
            own.inc_thread_sharing()  # closed by the thread that ends the others
            self._connections.append(own)
        with own.cursor() as cursor:
            cursor.execute("SELECT set_config('lock_timeout', %s, false)", [f"{MAX_LOCK_WAIT_S:g}s"])
