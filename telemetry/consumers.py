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

MAX_MESSAGE_LENGTH = 4_096  # characters of one message of a page
HEARTBEAT_INTERVAL_S = 2.0  # a page without a message for 5 s shows that it has no data (static/js/live/feed.js)
STALLED_S = 60.0  # without an acknowledgement for so long a page counts as closed
GONE, STALLED = 4404, 1013


class LiveConsumer(SignedInSocket):
    """`/ws/live` and `/ws/missions/{id}/live`: a snapshot of everything that the page shows, then its changes.

    `{"type": "snapshot", "sequence": 1, "server_time": …, "live": {"uavs": […], "missions": […], "alerts": […], "commands": […], "offers":
    […]}}`, then `{"type": "changes", "sequence": …, "uavs": [… whole ones …], …, "removed": {"uavs": [… ids …], …}}`, numbered
    consecutively, and `{"type": "keepalive"}` after two seconds of silence. The page acknowledges each numbered message by `{"type": "ack",
    "sequence": n}`, and receives the newest state of each object once it has acknowledged the last message but one. It sends `{"type":
    "resync"}` if it has missed a number.

    Close codes: 4400 after any other message, 4401 soon after the user has lost access, 4404 when the mission is deleted, 4429 at once when
    the user or the network has too many open websockets.
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
            await self.close()  # before accepting: the handshake is refused with 403, whatever the reason
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
    """Handle a message of a page. Raises ValueError if it is none of the protocol."""
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
