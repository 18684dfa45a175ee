"""Which frames are believed to be a UAV's: signed with its key, or, where that is allowed, from the sender that had its system id first."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.autopilot_type import COMMANDED, autopilot_type_of
from mavlink.decoding.report import E7, is_place, is_vehicle
from mavlink.frames import Frame, Message, message_of
from mavlink.signing import FrameWriter, Refusal, SignatureCheck, stream_of, timestamp_at, unix_s_of
from mavlink.vehicle_class import type_name
from telemetry.gateway.addresses import Addresses
from telemetry.gateway.fleet import KnownUav
from telemetry.gateway.heartbeat import position_request
from telemetry.gateway.options import OWN_COMPONENT, OWN_SYSTEM
from telemetry.gateway.peers import Peer
from telemetry.services.links.sightings import Sighting

SYSTEMS = range(1, 255)
ASK_AGAIN_S = 5.0
POSITION = mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT
SENDER_SILENT_S = 5.0  # after which another sender may have the system id, where nothing is signed
SECOND_SENDER = "second-sender"
LATE_BY_S = 1.0  # that a frame may have been under way for longer than others before it
COPIED = "copied"  # taken before, and brought by a second address


@dataclass
class UnknownSenders:
    """`note` is called with each sighting. A vehicle is asked for its position until it has told one."""

    note: Callable[[Sighting], None]
    _positions: dict[int, LonLat] = field(default_factory=dict)
    _asked_s: dict[int, float] = field(default_factory=dict)
    _writer: FrameWriter = field(default_factory=lambda: FrameWriter(OWN_SYSTEM, OWN_COMPONENT), repr=False)

    def receive(self, frame: Frame, peer: Peer, now_s: float) -> None:
        """now_s: seconds since 1970."""
        if frame.message_id not in (mavlink.MAVLINK_MSG_ID_HEARTBEAT, POSITION) or frame.system not in SYSTEMS:
            return
        message = message_of(frame)
        if message is None:
            return
        if frame.message_id == POSITION:
            if is_place(message.lat, message.lon):
                self._positions[frame.system] = LonLat(message.lon / E7, message.lat / E7)
        elif is_vehicle(message):
            self._ask(frame.system, message, peer)
            self._note(frame, message, peer, now_s)

    def forget(self, system: int) -> None:
        """It belongs to a UAV by now; another vehicle may have its number later."""
        self._positions.pop(system, None)
        self._asked_s.pop(system, None)

    def _ask(self, system: int, heartbeat: Message, peer: Peer) -> None:
        """ArduPilot tells where it is only to whoever asks."""
        now_s = time.monotonic()
        is_asked = now_s - self._asked_s.get(system, -ASK_AGAIN_S) < ASK_AGAIN_S
        if system in self._positions or is_asked or autopilot_type_of(heartbeat.autopilot) not in COMMANDED:
            return
        self._asked_s[system] = now_s
        peer.send(self._writer.frame_of(position_request(system), time.time()))

    def _note(self, frame: Frame, heartbeat: Message, peer: Peer, now_s: float) -> None:
        position = self._positions.get(frame.system)
        self.note(
            Sighting(
                system=frame.system,
                autopilot=autopilot_type_of(heartbeat.autopilot),
                vehicle_type=type_name(heartbeat.type),
                address=peer.name[:100],
                is_signed=frame.is_signed,
                last_message_at=datetime.fromtimestamp(now_s, UTC),
                longitude_deg=None if position is None else position.lon,
                latitude_deg=None if position is None else position.lat,
            )
        )


@dataclass
class SenderAuthentication:
    """Times are seconds since 1970. The last frame was believed at `last_message_s`, of `addresses.main` unless it was a second one's.

    `credential_id` is that of the key by which the last one was signed, `used` those since somebody asked last, and `ahead_s` by how much
    the UAV's signing clock was ahead of ours then.
    """

    uav: KnownUav
    addresses: Addresses = field(default_factory=Addresses)
    last_message_s: float = 0.0
    second_sender: tuple[str, float] | None = None  # who, and when last
    credential_id: int | None = None
    used: set[int] = field(default_factory=set)
    ahead_s: float = 0.0
    _checks: dict[int, SignatureCheck] = field(default_factory=dict, repr=False)  # by credential, the newest first

    def __post_init__(self) -> None:
        self._checks = {credential_id: SignatureCheck(key) for credential_id, key in self.uav.keys}

    @property
    def peer(self) -> Peer | None:
        return self.addresses.main

    @property
    def key(self) -> bytes | None:
        """That the UAV signs with, as far as it is known: ours to sign with, too."""
        keys = dict(self.uav.keys)
        return self.uav.key if self.credential_id is None else keys.get(self.credential_id, self.uav.key)

    def refusal(self, frame: Frame, peer: Peer, now_s: float) -> str | None:
        """None: it is believed."""
        refused = self._refusal(frame, peer, now_s)
        if refused is None:
            self.last_message_s = now_s
        return refused

    def could_be(self, frame: Frame, now_s: float) -> bool:
        """Of a frame that waits to be received: whether it is worth keeping."""
        if self._checks and frame.is_signed:
            fresh = (SignatureCheck(check.key) for check in self._checks.values())
            return any(check.refusal(frame, now_s) in (None, Refusal.TOO_OLD) for check in fresh)
        return self.uav.allows_unsigned

    def key_of(self, frame: Frame) -> bytes | None:
        """By which it was signed, if by one of the UAV's."""
        return next((check.key for check in self._checks.values() if check.is_signed_right(frame)), None)

    def change(self, uav: KnownUav) -> None:
        """The UAV's row or key was changed. Who was believed by a key that counts no more is not believed, nor answered, any more."""
        self._checks = {number: self._checks.get(number) or SignatureCheck(key) for number, key in uav.keys}
        is_by_other_key = self.credential_id not in self._checks if self.credential_id is not None else uav.keys != self.uav.keys
        if is_by_other_key or (self.uav.allows_unsigned and not uav.allows_unsigned and self.credential_id is None):
            self.credential_id = None
            self.addresses.forget()
        self.uav = uav

    def take_up(self, signing: dict[str, Any], since_s: float) -> None:
        """What another gateway left of the times of signatures (`to_json`); what was signed before since_s was not sent to this one.

        A clock that was late then may be so still. One that was ahead may have been set since, and is not waited for.
        """
        since = timestamp_at(since_s - LATE_BY_S + min(float(signing.get("ahead_s", 0.0)), 0.0))
        for credential_id, check in self._checks.items():
            if credential_id == signing.get("credential"):
                check.last = dict(signing.get("received", {}))
                self.credential_id = credential_id
            if signing:
                check.since = since

    def to_json(self) -> dict[str, Any]:
        """Empty where there is no key."""
        if not self._checks:
            return {}
        credential_id = self.credential_id if self.credential_id in self._checks else next(iter(self._checks))
        return {"credential": credential_id, "received": dict(self._checks[credential_id].last), "ahead_s": round(self.ahead_s, 3)}

    @property
    def _has_shown_its_key(self) -> bool:
        """To this gateway or one before it: who speaks without it now is somebody else, though unsigned frames be allowed."""
        return any(check.last for check in self._checks.values())

    def _refusal(self, frame: Frame, peer: Peer, now_s: float) -> str | None:
        if self._checks and frame.timestamp is not None:
            return self._signed_refusal(frame, frame.timestamp, peer, now_s)
        if not self.uav.allows_unsigned or self._has_shown_its_key:
            return Refusal.NO_KEY if frame.is_signed else Refusal.UNSIGNED
        if self.peer is None or peer == self.peer or not is_within(self.last_message_s, now_s, SENDER_SILENT_S):
            self.addresses.believe(peer)
            return None
        self.second_sender = (peer.name, now_s)
        return SECOND_SENDER

    def _signed_refusal(self, frame: Frame, timestamp: int, peer: Peer, now_s: float) -> str | None:
        credential_id, refusal = next(self._by_key(frame, now_s), (None, Refusal.WRONG_SIGNATURE))
        if credential_id is None:
            return refusal
        if refusal is Refusal.REPLAYED and self.addresses.copy(stream_of(frame), timestamp, peer, now_s):
            self.second_sender = self.addresses.copied
            return COPIED
        if refusal is None:
            self.credential_id, self.ahead_s = credential_id, unix_s_of(timestamp) - now_s
            self.used.add(credential_id)
            self.addresses.take(stream_of(frame), timestamp, peer, now_s)
        return refusal

    def _by_key(self, frame: Frame, now_s: float) -> Iterator[tuple[int, Refusal | None]]:
        """The key that signed it, and what speaks against it all the same."""
        for credential_id, check in self._checks.items():
            refusal = check.refusal(frame, now_s)
            if refusal is not Refusal.WRONG_SIGNATURE:
                yield credential_id, refusal


def is_within(at_s: float, now_s: float, span_s: float) -> bool:
    """Also where our clock of the day was set back since: what seems to lie ahead is no reason to wait for it."""
    return abs(now_s - at_s) < span_s
