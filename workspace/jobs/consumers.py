"""Websocket of a job's progress."""

import asyncio
from contextlib import suppress
from typing import Any
from uuid import UUID

from channels.db import database_sync_to_async
from channels.layers import get_channel_layer
from django.core.serializers.json import DjangoJSONEncoder
from django.db import Error as DatabaseError
from django.utils import translation
from redis.exceptions import RedisError

from workspace import selectors
from workspace.jobs.serializers import JobSerializer
from workspace.live.changes import job_group
from workspace.live.sockets import CHECK_PERSON_INTERVAL_S, ENDED, KEEPALIVE_INTERVAL_S, NO_MESSAGE, SIGNED_OUT, SignedInSocket
from workspace.live.timed_waits import wait_for_event
from workspace.locale_negotiation import language_of_socket
from workspace.models import Job, User

POLL_INTERVAL_S = 1.0  # of the row, with or without notifications
MESSAGE_INTERVAL_S = 0.1  # notifications within this time cause one poll
REDIS_PAUSE_S = 1.0

_encode = DjangoJSONEncoder(separators=(",", ":")).encode


class JobConsumer(SignedInSocket):
    """`/ws/jobs/{id}`: the job as `GET /api/v1/jobs/{id}` returns it, at once and after every change, until it has ended.

    Messages are `{"type": "job", "job": {…}}` and, now and then, `{"type": "keepalive"}`; clients send nothing. Closed with 4401 soon after
    the user loses access, and at once with 4429 if the user has too many websockets open.
    """

    def kind(self) -> str:
        return "job"

    async def connect(self) -> None:
        self._job_id: UUID = self.scope["url_route"]["kwargs"]["job_id"]
        self._has_message = asyncio.Event()
        user = await self._user()
        if user is None or await self._version(user) is None:
            await self.close()  # before it is accepted: the handshake is refused with 403, whatever the reason
            return
        if await self.is_one_too_many(user):
            return
        await self.accept()
        self._start(self._listen())
        self._start(self._follow(user))

    async def receive(self, text_data: str | None = None, bytes_data: bytes | None = None) -> None:
        self.hang_up(NO_MESSAGE)

    async def _follow(self, user: User) -> None:
        loop = asyncio.get_running_loop()
        seen: Any = None
        answered_s = checked_s = loop.time()
        while True:
            with suppress(DatabaseError):  # unavailable for a moment: the next poll reads it
                if loop.time() - checked_s >= CHECK_PERSON_INTERVAL_S:
                    checked_s = loop.time()
                    now = await self._same_user(user)
                    if now is None:
                        return self.hang_up(SIGNED_OUT)
                    user = now
                version = await self._version(user)
                if version is None:
                    return self.hang_up(ENDED)  # deleted
                if version != seen:
                    try:
                        message, is_open = await self._message(user)
                    except Job.DoesNotExist:
                        return self.hang_up(ENDED)
                    await self.send(message)
                    seen, answered_s = version, loop.time()
                    if not is_open:
                        return self.hang_up(ENDED)
            if loop.time() - answered_s >= KEEPALIVE_INTERVAL_S:
                await self.send('{"type":"keepalive"}')
                answered_s = loop.time()
            if await wait_for_event(self._has_message, POLL_INTERVAL_S):
                await asyncio.sleep(MESSAGE_INTERVAL_S)
            self._has_message.clear()

    async def _listen(self) -> None:
        """Receive notifications from the worker that the row has changed; without Redis there are none, and the row is only polled."""
        while True:
            try:
                layer = get_channel_layer()
                channel = await layer.new_channel()
                await layer.group_add(job_group(self._job_id), channel)
                while True:
                    await layer.receive(channel)
                    self._has_message.set()
            except (RedisError, OSError):
                await asyncio.sleep(REDIS_PAUSE_S)

    @database_sync_to_async
    def _version(self, user: User) -> tuple[Any, ...] | None:
        """Return a value that differs after every change of the row; None for a missing job, or another organisation's."""
        jobs = selectors.jobs_of_organisation(user.organisation).filter(pk=self._job_id)
        return jobs.values_list("state", "attempts", "progress", "message", "lease_expires_at", "cancel_requested_at").first()

    @database_sync_to_async
    def _message(self, user: User) -> tuple[str, bool]:
        job = selectors.jobs_of_organisation(user.organisation).get(pk=self._job_id)
        with translation.override(language_of_socket(user, self.scope)):
            return _encode({"type": "job", "job": JobSerializer(job).data}), job.is_open
