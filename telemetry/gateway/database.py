"""The database from inside the loop: one thread, one connection, and errors told apart that another try may mend."""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import ParamSpec, TypeVar

from django.db import close_old_connections, connection

from workspace.errors import DATABASE_AWAY

logger = logging.getLogger(__name__)

P = ParamSpec("P")
Result = TypeVar("Result")


class DatabaseAway(Exception):
    """Worth another try."""


class DatabaseThread:
    def __init__(self, name: str) -> None:
        self._executor = ThreadPoolExecutor(1, thread_name_prefix=name)

    async def run(self, do: Callable[P, Result], /, *args: P.args, **kwargs: P.kwargs) -> Result:
        """Raises DatabaseAway, or what `do` raises."""

        def inside() -> Result:
            close_old_connections()
            try:
                return do(*args, **kwargs)
            except DATABASE_AWAY as error:
                connection.close()
                raise DatabaseAway(str(error)) from error

        return await asyncio.get_running_loop().run_in_executor(self._executor, inside)

    def close(self) -> None:
        self._executor.submit(lambda: connection.close())  # that of the thread
        self._executor.shutdown(wait=True)
