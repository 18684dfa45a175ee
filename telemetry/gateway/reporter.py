"""Reports what is not stored with the records: flown items, RTL parameters, doubts, key use and second senders."""

import logging
import math
import time
from collections.abc import Callable, Coroutine
from dataclasses import dataclass, field
from typing import Any

from missions.services.commands.rtl_check import note_rtl_behaviour
from missions.services.fleet.credentials import note_mavlink_key_use
from telemetry.gateway.database import DatabaseThread, DatabaseUnavailable
from telemetry.gateway.session import Session
from telemetry.services.alerts.alerts import raise_second_sender
from telemetry.services.flown import note_flown
from telemetry.services.links.onboard_lists import doubt_loaded

logger = logging.getLogger(__name__)

SECOND_SENDER_GONE_S = 60.0
FLOWN_INTERVAL_S = 0.2
KEYS_INTERVAL_S = 1.0
KEY_AGAIN_S = 30.0
SENDERS_INTERVAL_S = 2.0


@dataclass
class Reporter:
    """Periodic reports. `database` is a separate thread: it may wait for locks on missions, which must not delay leases."""

    sessions: Callable[[], list[Session]]
    database: DatabaseThread = field(default_factory=lambda: DatabaseThread("gateway-tells"))
    _keys_noted_s: dict[int, float] = field(default_factory=dict)  # by credential, monotonic

    def loops(self) -> dict[str, tuple[float, Callable[[], Coroutine[Any, Any, None]]]]:
        """Return interval [s] and function by name."""
        return {
            "senders": (SENDERS_INTERVAL_S, self.second_senders),
            "flown": (FLOWN_INTERVAL_S, self.flown),
            "returns": (FLOWN_INTERVAL_S, self.rtl_readings),
            "doubts": (FLOWN_INTERVAL_S, self.doubts),
            "keys": (KEYS_INTERVAL_S, self.keys),
        }

    async def second_senders(self) -> None:
        """Raise or end alerts for two senders with one system id, or with the same signed frames: either may be the UAV."""
        now_s = time.time()
        for session in self.sessions():
            if session.authentication.second_sender is None or session.peer is None:
                continue
            other, last_s = session.authentication.second_sender
            if now_s - last_s < SECOND_SENDER_GONE_S:
                is_signed = session.authentication.addresses.copied is not None
                await self.database.run(
                    raise_second_sender, uav_id=session.uav.uav_id, believed=session.peer.name, other=other, is_signed=is_signed
                )
            else:
                session.authentication.second_sender = None
                await self.database.run(raise_second_sender, uav_id=session.uav.uav_id)

    async def flown(self) -> None:
        """Report flown items in order, each until it succeeds."""
        for session in self.sessions():
            while session.flown:
                flown = session.flown[0]
                await self._notify(session, f"what it has flown ({flown})", note_flown, flown=flown)
                session.flown.pop(0)

    async def rtl_readings(self) -> None:
        for session in self.sessions():
            reported = session.message_requests.rtl_reading.news(session.state)
            if reported is not None:
                await self._notify(
                    session, "its own return", note_rtl_behaviour, autopilot=reported.autopilot, parameters=reported.parameters
                )
                session.message_requests.rtl_reading.note(reported)

    async def doubts(self) -> None:
        for session in self.sessions():
            while session.lists.found:
                doubt, at_s = session.lists.found[0]
                await self._notify(
                    session, f"what speaks for another list ({doubt})", doubt_loaded, doubt=doubt, ago_s=time.monotonic() - at_s
                )
                if session.lists.found[:1] == [(doubt, at_s)]:
                    session.lists.found.pop(0)

    async def keys(self) -> None:
        """Report a key's first use at once, as it ends earlier keys; later uses from time to time."""
        now_s, used = time.monotonic(), set()
        for session in self.sessions():
            used |= {key for key in session.authentication.used if now_s - self._keys_noted_s.get(key, -math.inf) >= KEY_AGAIN_S}
            session.authentication.used = set()
        if used:
            await self.database.run(note_mavlink_key_use, credential_ids=used)
            self._keys_noted_s |= dict.fromkeys(used, now_s)

    async def _notify(self, session: Session, what: str, note: Callable[..., Any], **values: Any) -> None:
        """Write a report; a failure for one UAV does not delay the others."""
        try:
            await self.database.run(note, uav_id=session.uav.uav_id, **values)
        except DatabaseUnavailable:
            raise
        except Exception:
            logger.exception("of %s it could not be told: %s", session.uav.name, what, extra={"uav": session.uav.uav_id})
