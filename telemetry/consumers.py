"""Websockets of live pages."""

from typing import Any
from uuid import UUID

import orjson
from channels.db import database_sync_to_async

from missions.models import Mission
from telemetry.live.feed import Feed
from telemetry.live.hub import hub_here
from telemetry.live.messages import message
from telemetry.live.reader import Reader, SaysNonsense
from workspace.live.sockets import NO_MESSAGE, SignedInSocket
from workspace.locale_negotiation import language_of_socket
from workspace.models import User

MAX_MESSAGE_LENGTH = 4_096  # characters that a page may say at once
HEARTBEAT_INTERVAL_S = 2.0  # a page that hears nothing for 5 s says that it has no data (static/js/live/feed.js)
STALLED_S = 60.0  # a page that confirms nothing for so long is not there any more
GONE, STALLED = 4404, 1013


class LiveConsumer(SignedInSocket):
    """`/ws/live` and `/ws/missions/{id}/live`: everything that such a page shows, then what changes.

    `{"type": "snapshot", "sequence": 1, "server_time": …, "live": {"uavs": […], "missions": […], "alerts": […], "commands": […],
    "offers": […]}}`, then `{"type": "changes", "sequence": …, "uavs": [… whole ones …], …, "removed": {"uavs": [… ids …], …}}`, numbered
    one by one, and `{"type": "keepalive"}` after two seconds of silence. The page says `{"type": "ack", "sequence": n}` of each that has a
    number of its own, and is told the latest of each object once it has the one before the last; or `{"type": "resync"}` where it has lost
    count. Closed with 4400 after anything else, with 4401 soon after whoever listens may not any more, with 4404 where the mission is
    deleted, and at once with 4429 where the user or the network has as many websockets open as are allowed.
    """

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        self._reader: Reader | None = None
        try:
            await super().__call__(scope, receive, send)
        finally:
            if self._reader is not None:
                self._hub.leave(self._reader)

    def kind(self) -> str:
        return "organisation" if self.scope["url_route"]["kwargs"].get("mission_id") is None else "mission"

    async def connect(self) -> None:
        mission: UUID | None = self.scope["url_route"]["kwargs"].get("mission_id")
        user = await self._user()
        if user is None or not (mission is None or await _has_mission(user, mission)):
            await self.close()  # before it is accepted: the handshake is refused with 403, whatever the reason
            return
        if await self.is_one_too_many(user):
            return
        await self.accept()
        self._hub = hub_here()
        reader = self._reader = Reader(user.organisation_id, mission, language_of_socket(user, self.scope))
        self._start(self._speak(reader, self._hub.join(reader)))
        self._start(self._watch_person(user))

    async def receive(self, text_data: str | None = None, bytes_data: bytes | None = None) -> None:
        try:
            if self._reader is not None:
                _heed(self._reader, text_data)
        except ValueError:
            self.hang_up(NO_MESSAGE)

    async def _speak(self, reader: Reader, feed: Feed) -> None:
        full_s = 0.0
        while True:
            if await reader.due(HEARTBEAT_INTERVAL_S):
                if reader.is_ended:
                    return self.hang_up(GONE)
                full_s = 0.0
                await self.send(feed.next_message(reader))
            elif not reader.is_full:
                await self.send(message("keepalive", reader.sequence))
            elif (full_s := full_s + HEARTBEAT_INTERVAL_S) >= STALLED_S:
                return self.hang_up(STALLED)


def _heed(reader: Reader, stated: str | None) -> None:
    """Raises ValueError where it is nothing that a page says."""
    if stated is None or len(stated) > MAX_MESSAGE_LENGTH:
        raise ValueError
    match orjson.loads(stated):
        case {"type": "ack", "sequence": int(sequence), **rest} if not rest:
            reader.confirm(sequence)
        case {"type": "resync", **rest} if not rest:
            reader.again()
        case _:
            raise SaysNonsense


@database_sync_to_async
def _has_mission(user: User, mission: UUID) -> bool:
    return Mission.objects.filter(pk=mission, organisation=user.organisation_id, deleted_at=None).exists()
