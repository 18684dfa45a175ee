"""Every way in which Spanwise reaches PostgreSQL and Redis, tried once: prints what came of each as JSON. A process of its own."""

import asyncio
import json
import os
import time
from collections.abc import Callable

import django
from redis.asyncio import Redis
from redis.exceptions import TimeoutError as RedisTimeout

django.setup()

from asgiref.sync import async_to_sync  # noqa: E402
from channels.layers import get_channel_layer  # noqa: E402
from django.conf import settings  # noqa: E402
from django.core.cache import cache  # noqa: E402
from django.db import connection  # noqa: E402

from config.celery import app  # noqa: E402
from scripts.backups import database_at  # noqa: E402

TIMEOUT_S = 60.0


def database() -> str:
    with connection.cursor() as cursor:
        cursor.execute("SELECT version FROM pg_stat_ssl WHERE pid = pg_backend_pid() AND ssl")
        row = cursor.fetchone()
    return str(row[0]) if row else "without TLS"


def dump() -> str:
    """With PostgreSQL's own programs, as a backup is made."""
    source = database_at(os.environ["DATABASE_URL"])
    source.run("pg_dump", "--schema-only", "--file=/dev/null", source.address)
    return "there"


def cached() -> str:
    cache.set("tls", "there", 60)
    return str(cache.get("tls"))


def queue() -> str:
    with app.connection_for_write() as broker:
        broker.ensure_connection(max_retries=1, interval_start=0, timeout=TIMEOUT_S)
        broker.default_channel.client.ping()
    return "there"


def pages() -> str:
    async def there() -> str:
        layer = get_channel_layer()
        channel = await layer.new_channel()
        await layer.send(channel, {"type": "there"})
        async with asyncio.timeout(TIMEOUT_S):
            return str((await layer.receive(channel))["type"])

    end_s = time.monotonic() + TIMEOUT_S
    while True:
        try:
            return async_to_sync(there)()
        except RedisTimeout:  # pages wait a second for Redis; on a busy machine that is not enough
            if time.monotonic() > end_s:
                raise


def hints() -> str:
    async def there() -> str:
        async with Redis.from_url(settings.REDIS_URL) as redis:
            await redis.ping()
        return "there"

    return asyncio.run(there())


def tried(way: Callable[[], str]) -> str:
    try:
        return way()
    except Exception as error:  # whatever it is, it is told
        return f"refused: {error!r}"


if __name__ == "__main__":
    print(json.dumps({way.__name__: tried(way) for way in (database, dump, cached, queue, pages, hints)}))
