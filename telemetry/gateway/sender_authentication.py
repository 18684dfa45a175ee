"""Sender authentication: accepts frames signed with a UAV's key, or, if unsigned links are allowed, from its first sender."""

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
from mavlink.signing import FrameRefusal, FrameWriter, SignatureCheck, stream_of, timestamp_at, unix_s_of
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
SENDER_SILENT_S = 5.0  # after this silence another sender may take the system id on an unsigned link
SECOND_SENDER = "second-sender"
LATE_BY_S = 1.0  # maximum difference of transmission times between frames
COPIED = "copied"  # accepted before, and delivered again by a second address


@dataclass
class UnknownSenders:
    """Vehicles that are no UAV's. `note` is called with each sighting. A vehicle is asked for its position until it reports one."""

    note: Callable[[Sighting], None]
    _positions: dict[int, LonLat] = field(default_factory=dict)
    _asked_s: dict[int, float] = field(default_factory=dict)
    _writer: FrameWriter = field(default_factory=lambda: FrameWriter(OWN_SYSTEM, OWN_COMPONENT), repr=False)

    def receive(self, frame: Frame, peer: Peer, now_s: float) -> None:
        """Take a frame. now_s: Unix seconds."""
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
        """Forget a system id that now belongs to a UAV; another vehicle may have it later."""
        self._positions.pop(system, None)
        self._asked_s.pop(system, None)

    def _ask(self, system: int, heartbeat: Message, peer: Peer) -> None:
        """Request the position, which ArduPilot only sends on request."""
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
    """Sender authentication of one UAV. Times are Unix seconds.

    The last frame was accepted at `last_message_s`, from `addresses.main` unless from a second address. `credential_id` is the key that
    signed the last one, `used` are the keys used since the last report. `ahead_s` is by how much the UAV's signing clock was ahead of the
    server's.
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
        """Return the key that the UAV signs with, as far as known; frames to it are signed with it, too."""
        keys = dict(self.uav.keys)
        return self.uav.key if self.credential_id is None else keys.get(self.credential_id, self.uav.key)

    def refusal(self, frame: Frame, peer: Peer, now_s: float) -> str | None:
        """Return why a frame is refused; None: accepted."""
        refused = self._refusal(frame, peer, now_s)
        if refused is None:
            self.last_message_s = now_s
        return refused

    def could_be(self, frame: Frame, now_s: float) -> bool:
        """Return whether a frame that waits for a lease is worth keeping."""
        if self._checks and frame.is_signed:
            fresh = (SignatureCheck(check.key) for check in self._checks.values())
            return any(check.refusal(frame, now_s) in (None, FrameRefusal.TOO_OLD) for check in fresh)
        return self.uav.allows_unsigned

    def key_of(self, frame: Frame) -> bytes | None:
        """Return the key of the UAV that signed the frame, else None."""
        return next((check.key for check in self._checks.values() if check.is_signed_right(frame)), None)

    def change(self, uav: KnownUav) -> None:
        """Take a changed row or key. A sender accepted by a key that is no longer valid is neither accepted nor answered."""
        self._checks = {number: self._checks.get(number) or SignatureCheck(key) for number, key in uav.keys}
        is_by_other_key = self.credential_id not in self._checks if self.credential_id is not None else uav.keys != self.uav.keys
        if is_by_other_key or (self.uav.allows_unsigned and not uav.allows_unsigned and self.credential_id is None):
            self.credential_id = None
            self.addresses.forget()
        self.uav = uav

    def take_up(self, signing: dict[str, Any], since_s: float) -> None:
        """Adopt the signature timestamps of the previous gateway (`to_json`). Frames signed before since_s were not sent to this gateway.

        A clock that was late may still be late. One that was ahead may have been corrected, and is not waited for.
        """
        since = timestamp_at(since_s - LATE_BY_S + min(float(signing.get("ahead_s", 0.0)), 0.0))
        for credential_id, check in self._checks.items():
            if credential_id == signing.get("credential"):
                check.last = dict(signing.get("received", {}))
                self.credential_id = credential_id
            if signing:
                check.since = since

    def to_json(self) -> dict[str, Any]:
        """Return the signature timestamps for the next gateway; empty without a key."""
        if not self._checks:
            return {}
        credential_id = self.credential_id if self.credential_id in self._checks else next(iter(self._checks))
        return {"credential": credential_id, "received": dict(self._checks[credential_id].last), "ahead_s": round(self.ahead_s, 3)}

    @property
    def _has_shown_its_key(self) -> bool:
        """Return whether the UAV has signed to this gateway or an earlier one: unsigned frames are then refused even where allowed."""
        return any(check.last for check in self._checks.values())

    def _refusal(self, frame: Frame, peer: Peer, now_s: float) -> str | None:
        if self._checks and frame.timestamp is not None:
            return self._signed_refusal(frame, frame.timestamp, peer, now_s)
        if not self.uav.allows_unsigned or self._has_shown_its_key:
            return FrameRefusal.NO_KEY if frame.is_signed else FrameRefusal.UNSIGNED
        if self.peer is None or peer == self.peer or not is_within(self.last_message_s, now_s, SENDER_SILENT_S):
            self.addresses.believe(peer)
            return None
        self.second_sender = (peer.name, now_s)
        return SECOND_SENDER

    def _signed_refusal(self, frame: Frame, timestamp: int, peer: Peer, now_s: float) -> str | None:
        credential_id, refusal = next(self._by_key(frame, now_s), (None, FrameRefusal.WRONG_SIGNATURE))
        if credential_id is None:
            return refusal
        if refusal is FrameRefusal.REPLAYED and self.addresses.copy(stream_of(frame), timestamp, peer, now_s):
            self.second_sender = self.addresses.copied
            return COPIED
        if refusal is None:
            self.credential_id, self.ahead_s = credential_id, unix_s_of(timestamp) - now_s
            self.used.add(credential_id)
            self.addresses.take(stream_of(frame), timestamp, peer, now_s)
        return refusal

    def _by_key(self, frame: Frame, now_s: float) -> Iterator[tuple[int, FrameRefusal | None]]:
        """Yield the key that signed the frame, and why it is refused nevertheless."""
        for credential_id, check in self._checks.items():
            refusal = check.refusal(frame, now_s)
            if refusal is not FrameRefusal.WRONG_SIGNATURE:
                yield credential_id, refusal


def is_within(at_s: float, now_s: float, span_s: float) -> bool:
    """Return whether two times are within a span, in either order, so that a clock that was set back causes no long wait."""
    return abs(now_s - at_s) < span_s
