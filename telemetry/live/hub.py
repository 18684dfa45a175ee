"""The hub of a process: one feed per organisation, while a page of it is open."""

import asyncio
import logging
from collections.abc import Callable, Collection
from concurrent.futures import ThreadPoolExecutor
from uuid import UUID
from weakref import WeakKeyDictionary

from channels.db import DatabaseSyncToAsync
from django.conf import settings
from redis.asyncio import Redis
from redis.exceptions import RedisError

from telemetry.live.feed import Feed
from telemetry.live.reader import Reader
from telemetry.live.snapshot import LiveSnapshot, read_snapshot
from workspace.live.changes import live_channel

logger = logging.getLogger(__name__)

RETRY_DELAY_S = 1.0
CONNECT_S = 1.0
HEALTH_INTERVAL_S = 10.0


async def listen(on_message: Callable[[int], None]) -> None:
    """Call `on_message` with the organisation's key for each notification until cancelled; reconnects after Redis outages."""
    every = live_channel("*")
    prefix = every.removesuffix("*")
    while True:
        try:
            redis = Redis.from_url(settings.REDIS_URL, socket_connect_timeout=CONNECT_S, health_check_interval=HEALTH_INTERVAL_S)
            async with redis, redis.pubsub(ignore_subscribe_messages=True) as channels:
                await channels.psubscribe(every)
                async for message in channels.listen():
                    on_message(int(message["channel"].decode().removeprefix(prefix)))
        except (RedisError, OSError, ValueError) as error:
            logger.debug("no hints: %r", error)
        await asyncio.sleep(RETRY_DELAY_S)


class Hub:
    """The hub of one event loop. It reads in its own thread, so that it does not wait for permission checks of pages."""

    def __init__(self) -> None:
        self._feeds: dict[int, tuple[Feed, asyncio.Task[None]]] = {}
        self._listening: asyncio.Task[None] | None = None
        self._read_snapshot = DatabaseSyncToAsync(
            read_snapshot, thread_sensitive=False, executor=ThreadPoolExecutor(1, thread_name_prefix="live")
        )

    def join(self, reader: Reader) -> Feed:
        if reader.organisation_id not in self._feeds:
            feed = Feed(reader.organisation_id, self._read)
            self._feeds[reader.organisation_id] = (feed, asyncio.create_task(feed.run()))
        if self._listening is None:
            self._listening = asyncio.create_task(listen(self._wake))
        feed, _ = self._feeds[reader.organisation_id]
        feed.join(reader)
        return feed

    def leave(self, reader: Reader) -> None:
        feed, run = self._feeds[reader.organisation_id]
        feed.leave(reader)
        if not feed.readers:
            run.cancel()
            del self._feeds[reader.organisation_id]
        if not self._feeds and self._listening is not None:
            self._listening.cancel()
            self._listening = None

    def _wake(self, organisation_id: int) -> None:
        if organisation_id in self._feeds:
            self._feeds[organisation_id][0].wake()

    async def _read(
        self, organisation_id: int, missions: Collection[UUID], languages: Collection[str], before: LiveSnapshot
    ) -> LiveSnapshot:
        return await self._read_snapshot(organisation_id, missions, languages, before)


_hubs: WeakKeyDictionary[asyncio.AbstractEventLoop, Hub] = WeakKeyDictionary()


def hub_here() -> Hub:
    """Return the hub of the running event loop: one per process in operation."""
    loop = asyncio.get_running_loop()
    if loop not in _hubs:
        _hubs[loop] = Hub()
    return _hubs[loop]
