"""Base of websockets of authenticated users: authentication, its recheck, limits, and closing."""

import asyncio
import logging
from collections import Counter
from collections.abc import Coroutine, Mapping
from contextlib import suppress
from importlib import import_module
from typing import Any
from uuid import uuid4
from weakref import WeakKeyDictionary

from channels.auth import get_user
from channels.db import database_sync_to_async
from channels.exceptions import StopConsumer
from channels.generic.websocket import AsyncWebsocketConsumer
from django.conf import settings
from django.db import Error as DatabaseError
from redis.asyncio import Redis
from redis.exceptions import RedisError

from operation.log_context import REQUEST_ID_HEADER, about, sane_request_id
from operation.metrics import WEBSOCKET_MESSAGES, WEBSOCKETS
from workspace.api.authentication import bearer_token, reader_of_token
from workspace.live.graceful_shutdown import shutdown_here
from workspace.models import User
from workspace.sessions.browser_sessions import note_session
from workspace.sessions.preferences import visitor_address
from workspace.sessions.sign_in_attempts import network_of

logger = logging.getLogger(__name__)

RENEW_INTERVAL_S = 5.0
LIFETIME_S = 15
REDIS_TIMEOUT_S = 1.0
REDIS_ERRORS = (RedisError, OSError)  # TimeoutError is an OSError

# KEYS: one sorted set per place. ARGV: the member, its lifetime [s], then the limit of each place. Uses Redis' own clock, so that machine
# clocks need not agree.
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
# KEYS: one place. ARGV: the lifetime [s], then the members. Adds them again after Redis lost them.
_RENEW = """
local until_s = tonumber(redis.call('TIME')[1]) + ARGV[1]
for i = 2, #ARGV do redis.call('ZADD', KEYS[1], until_s, ARGV[i]) end
redis.call('EXPIRE', KEYS[1], ARGV[1])
"""


class SocketPlaces:
    """The places of this process's websockets. All methods run in one event loop."""

    def __init__(self) -> None:
        self._open: Counter[str] = Counter()  # in this process, by place
        self._members: dict[str, tuple[str, ...]] = {}  # the places of each open websocket
        self._renewing: asyncio.Task[None] | None = None
        self._redis = Redis.from_url(settings.REDIS_URL, socket_connect_timeout=REDIS_TIMEOUT_S, socket_timeout=REDIS_TIMEOUT_S)

    async def take(self, limits: Mapping[str, int]) -> str | None:
        """Count one more websocket in each place and return its member; None where a place has as many as its limit. 0: no limit."""
        if any(limit and self._open[place] >= limit for place, limit in limits.items()):
            return None
        member = uuid4().hex
        self._open.update(limits.keys())  # before the query to Redis, for concurrent calls in this process
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

    async def release(self, member: str) -> None:
        places = self._forget(member)
        with suppress(*REDIS_ERRORS):  # the entry expires
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
    """Return the places of the running event loop."""
    loop = asyncio.get_running_loop()
    if loop not in _places:
        _places[loop] = SocketPlaces()
    return _places[loop]


def _key(place: str) -> str:
    return f"spanwise-sockets.{place}"


CHECK_PERSON_INTERVAL_S = 4.0
KEEPALIVE_INTERVAL_S = 20.0  # a proxy in between closes silent connections

RETRY_AFTER = b"2"  # seconds
ENDED, FAILED, SIGNED_OUT, NO_MESSAGE, TOO_MANY = 1000, 1011, 4401, 4400, 4429


class SignedInSocket(AsyncWebsocketConsumer):
    """Authenticates browsers by their session, programs by `Authorization: Bearer`."""

    channel_layer_alias = "none"  # none of Channels': a socket stays open while Redis is unavailable
    _counted_as: str | None = None  # set once it is accepted

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Close only while no task waits for the browser's messages; before that the server sends it nothing."""
        self._tasks: list[asyncio.Task[None]] = []
        self._hung_up: asyncio.Future[int] = asyncio.get_running_loop().create_future()
        self._place: str | None = None  # among the open websockets of its user and its network
        with about(**_facts_of(scope)):  # tasks started here inherit it
            answering = asyncio.ensure_future(super().__call__(scope, receive, send))
        try:
            await asyncio.wait({answering, self._hung_up}, return_when=asyncio.FIRST_COMPLETED)
            if answering.done():
                return await answering
            answering.cancel()
            with suppress(asyncio.CancelledError):
                await answering
            await send({"type": "websocket.close", "code": self._hung_up.result()})
        finally:
            for task in (answering, *self._tasks):
                task.cancel()
            if self._counted_as is not None:
                shutdown_here().forget(self)
                WEBSOCKETS.labels(self._counted_as).dec()
            if self._place is not None:
                await socket_places_here().release(self._place)

    def kind(self) -> str:
        """Return what its page follows, as one of a few words."""
        raise NotImplementedError

    async def websocket_connect(self, message: Any) -> None:
        """Refuse with 503 and Retry-After while the database is unavailable, so that pages retry."""
        try:
            await super().websocket_connect(message)
        except DatabaseError as error:
            logger.warning("a websocket is refused while the database is away: %s", type(error).__name__)
            await self.base_send({"type": "websocket.http.response.start", "status": 503, "headers": [(b"retry-after", RETRY_AFTER)]})
            await self.base_send({"type": "websocket.http.response.body", "body": b""})
            raise StopConsumer from error

    async def accept(self, *arguments: Any, **named: Any) -> None:
        await super().accept(*arguments, **named)
        self._counted_as = self.kind()
        WEBSOCKETS.labels(self._counted_as).inc()
        shutdown_here().expect(self)
        self._messages = WEBSOCKET_MESSAGES.labels(self._counted_as)

    async def is_one_too_many(self, user: User) -> bool:
        """Take a place among the open websockets of this user and this network, or close with a code if none is left."""
        network = network_of(_address_of(self.scope))
        wanted = {f"user {user.pk}": settings.SOCKETS_PER_USER, f"network {network}": settings.SOCKETS_PER_ADDRESS}
        self._place = await socket_places_here().take(wanted)
        if self._place is None:
            await AsyncWebsocketConsumer.accept(self)  # a refused handshake gives a page no reason
            await self.close(TOO_MANY)
        return self._place is None

    async def send(self, *arguments: Any, **named: Any) -> None:
        await super().send(*arguments, **named)
        self._messages.inc()

    def hang_up(self, code: int) -> None:
        """Close once no task waits for the browser's messages. The first code counts."""
        if not self._hung_up.done():
            self._hung_up.set_result(code)

    def _start(self, work: Coroutine[Any, Any, None]) -> None:
        """Run a task as long as the socket. If it fails, the socket is closed, so that no user stays unchecked."""
        task = asyncio.create_task(work)
        self._tasks.append(task)
        task.add_done_callback(self._look_how_it_ended)

    def _look_how_it_ended(self, task: asyncio.Task[None]) -> None:
        if not task.cancelled() and (error := task.exception()) is not None:
            logger.error("a websocket is closed: %r", error, exc_info=error)
            self.hang_up(FAILED)

    async def _user(self) -> User | None:
        """Return the current user, if they still have access."""
        token = bearer_token(self.scope)
        if token is not None:
            return await database_sync_to_async(reader_of_token)(token)
        key = await database_sync_to_async(lambda: self.scope["session"].session_key)()
        if key is None:
            return None
        store = import_module(settings.SESSION_ENGINE).SessionStore
        session = store(session_key=key)  # a new one: the first caches what it has read
        user = await get_user({"session": session})
        if not (isinstance(user, User) and user.is_active):
            return None
        await database_sync_to_async(note_session)(session, user, is_act=False)  # an open page counts as presence
        return user

    async def _same_user(self, before: User) -> User | None:
        """Return the same user as they are now; None once they have lost access, or moved to another organisation."""
        now = await self._user()
        is_same = now is not None and (now.pk, now.organisation_id) == (before.pk, before.organisation_id)
        return now if is_same else None

    async def _watch_person(self, user: User) -> None:
        """Close the socket once the user loses access. A user whose role has changed reconnects."""
        while True:
            await asyncio.sleep(CHECK_PERSON_INTERVAL_S)
            with suppress(DatabaseError):  # unavailable for a moment: the next check reads it
                now = await self._same_user(user)
                if now is None or now.role != user.role:
                    return self.hang_up(SIGNED_OUT)


def _address_of(scope: Any) -> str:
    """Return the client's address."""
    reported = [value.decode("latin-1") for name, value in scope["headers"] if name == b"x-forwarded-for"]
    client = scope.get("client")
    return visitor_address(client[0] if client else "", reported[-1] if reported else "")


def _facts_of(scope: Any) -> dict[str, Any]:
    reported = next((value for name, value in scope["headers"] if name == REQUEST_ID_HEADER.lower().encode()), None)
    named = scope.get("url_route", {}).get("kwargs", {})
    request = sane_request_id(None if reported is None else reported.decode("latin-1"))
    return {"request": request, "mission": named.get("mission_id"), "job": named.get("job_id")}
