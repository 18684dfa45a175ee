"""Word of changes out of Redis, for the rows of which organisation. Whoever misses it finds the change by looking."""

import asyncio
import logging
from collections.abc import Callable

from django.conf import settings
from redis.asyncio import Redis
from redis.exceptions import RedisError

from workspace.live import live_channel

logger = logging.getLogger(__name__)

TRY_AGAIN_S = 1.0
CONNECT_S = 1.0
HEALTH_EVERY_S = 10.0


async def listen(on_hint: Callable[[int], None]) -> None:
    """Until it is cancelled, over outages of Redis, too. on_hint is given the organisation's key."""
    every = live_channel("*")
    prefix = every.removesuffix("*")
    while True:
        try:
            redis = Redis.from_url(settings.REDIS_URL, socket_connect_timeout=CONNECT_S, health_check_interval=HEALTH_EVERY_S)
            async with redis, redis.pubsub(ignore_subscribe_messages=True) as channels:
                await channels.psubscribe(every)
                async for word in channels.listen():
                    on_hint(int(word["channel"].decode().removeprefix(prefix)))
        except (RedisError, OSError, ValueError) as error:
            logger.debug("no hints: %r", error)
        await asyncio.sleep(TRY_AGAIN_S)
