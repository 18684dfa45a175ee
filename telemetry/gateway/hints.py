"""PostgreSQL tells at once that a command waits. It is a hint: whoever misses it finds the command by looking."""

import asyncio
import logging
from collections.abc import Callable

import psycopg
from django.db import connection

from missions.services.commands import CHANNEL

logger = logging.getLogger(__name__)

TRY_AGAIN_S = 1.0


async def listen(on_hint: Callable[[], None]) -> None:
    """Until it is cancelled, over outages of the database, too."""
    parameters = {name: value for name, value in connection.get_connection_params().items() if name in PLAIN}
    while True:
        try:
            async with await psycopg.AsyncConnection.connect(**parameters, autocommit=True) as listening:
                await listening.execute(f"LISTEN {CHANNEL}")
                on_hint()
                async for _ in listening.notifies():
                    on_hint()
        except psycopg.Error as error:
            logger.debug("no hints: %s", error)
        await asyncio.sleep(TRY_AGAIN_S)


PLAIN = frozenset(
    {"application_name", "connect_timeout", "dbname", "host", "password", "port", "sslcert", "sslkey", "sslmode", "sslrootcert", "user"}
)
