"""Limits on open websockets, counted in Redis over all `live` processes.

Each open websocket is a member of one sorted set per place (a user, a network); its score is when it counts no more. A process renews
its own every few seconds, so those of a killed process end by themselves. While Redis is away each process counts for itself.
"""

import asyncio
import logging
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from uuid import uuid4
from weakref import WeakKeyDictionary

from django.conf import settings
from redis.asyncio import Redis
from redis.exceptions import RedisError

logger = logging.getLogger(__name__)

RENEW_INTERVAL_S = 5.0
LIFETIME_S = 15
REDIS_TIMEOUT_S = 1.0
REDIS_ERRORS = (RedisError, OSError)  # TimeoutError is an OSError

# KEYS: one sorted set per place. ARGV: the member, its lifetime [s], then the limit of each place. Redis' own clock, so that those of
# the machines need not agree.
_TAKE = """
local now = tonumber(redis.call('TIME')[1])
for i, key in ipairs(KEYS) do
    redis.call('ZREMRANGEBYSCORE', key, '-inf', now)
    local limit = tonumber(ARGV[2 + i])
    if limit > 0 and redis.call('ZCARD', key) >= limit then return 0 end
end
for _, key in ipairs(KEYS) do
    redis.call('ZADD', key, now + ARGV[2], ARGV[1])
    redis.call('EXPIRE', key, ARGV[2])
end
return 1
"""
# KEYS: one place. ARGV: the lifetime [s], then the members. Adds them again after Redis has lost them.
_RENEW = """
local until_s = tonumber(redis.call('TIME')[1]) + ARGV[1]
for i = 2, #ARGV do redis.call('ZADD', KEYS[1], until_s, ARGV[i]) end
redis.call('EXPIRE', KEYS[1], ARGV[1])
"""


class SocketPlaces:
    """The places of this process's websockets. All methods run in one event loop."""

    def __init__(self) -> None:
        self._open: Counter[str] = Counter()  # of this process, by place
        self._members: dict[str, tuple[str, ...]] = {}  # the places of each open websocket
        self._renewing: asyncio.Task[None] | None = None
        self._redis = Redis.from_url(settings.REDIS_URL, socket_connect_timeout=REDIS_TIMEOUT_S, socket_timeout=REDIS_TIMEOUT_S)

    async def take(self, limits: Mapping[str, int]) -> str | None:
        """Count one more websocket in each place and return its member; None where a place has as many as its limit. 0: no limit."""
        if any(limit and self._open[place] >= limit for place, limit in limits.items()):
            return None
        member = uuid4().hex
        self._open.update(limits.keys())  # before the question to Redis: others of this process ask meanwhile
        self._members[member] = tuple(limits)
        is_taken = 1
        try:
            is_taken = await self._redis.eval(_TAKE, len(limits), *map(_key, limits), member, LIFETIME_S, *limits.values())
        except REDIS_ERRORS as error:
            logger.warning("websockets are counted by this process alone: Redis is away: %r", error)
        except BaseException:
            self._forget(member)
            raise
        if not is_taken:
            self._forget(member)
            return None
        if self._renewing is None or self._renewing.done():
            self._renewing = asyncio.create_task(self._renew())
        return member

    async def give_back(self, member: str) -> None:
        places = self._forget(member)
        with suppress(*REDIS_ERRORS):  # it ends by itself
            pipeline = self._redis.pipeline(transaction=False)
            for place in places:
                pipeline.zrem(_key(place), member)
            await pipeline.execute()

    def _forget(self, member: str) -> tuple[str, ...]:
        places = self._members.pop(member, ())
        self._open.subtract(places)
        for place in places:
            if not self._open[place]:
                del self._open[place]
        return places

    async def _renew(self) -> None:
        task = asyncio.current_task()
        while self._members and not (task and task.cancelling()):  # redis-py may swallow it
            await asyncio.sleep(RENEW_INTERVAL_S)
            by_place: dict[str, list[str]] = {}
            for member, places in self._members.items():
                for place in places:
                    by_place.setdefault(place, []).append(member)
            with suppress(*REDIS_ERRORS):
                pipeline = self._redis.pipeline(transaction=False)
                for place, members in by_place.items():
                    pipeline.eval(_RENEW, 1, _key(place), LIFETIME_S, *members)
                await pipeline.execute()


_places: WeakKeyDictionary[asyncio.AbstractEventLoop, SocketPlaces] = WeakKeyDictionary()


def socket_places_here() -> SocketPlaces:
    """Return those of the running event loop."""
    loop = asyncio.get_running_loop()
    if loop not in _places:
        _places[loop] = SocketPlaces()
    return _places[loop]


def _key(place: str) -> str:
    return f"spanwise-sockets.{place}"
