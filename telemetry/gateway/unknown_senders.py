"""Vehicles that speak to a gateway and belong to no UAV: what they are, and where."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.autopilot_type import COMMANDED, flavour_of
from mavlink.decoding.report import E7, is_place, is_vehicle
from mavlink.frames import Frame, Message, message_of
from mavlink.signing import FrameWriter
from mavlink.vehicle_class import type_name
from telemetry.gateway.greeting import position_request
from telemetry.gateway.options import OWN_COMPONENT, OWN_SYSTEM
from telemetry.gateway.peers import Peer
from telemetry.services.links.sightings import Sighting

SYSTEMS = range(1, 255)
ASK_AGAIN_S = 5.0
POSITION = mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT


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
        if system in self._positions or is_asked or flavour_of(heartbeat.autopilot) not in COMMANDED:
            return
        self._asked_s[system] = now_s
        peer.send(self._writer.frame_of(position_request(system), time.time()))

    def _note(self, frame: Frame, heartbeat: Message, peer: Peer, now_s: float) -> None:
        position = self._positions.get(frame.system)
        self.note(
            Sighting(
                system=frame.system,
                autopilot=flavour_of(heartbeat.autopilot),
                vehicle_type=type_name(heartbeat.type),
                address=peer.name[:100],
                is_signed=frame.is_signed,
                heard_at=datetime.fromtimestamp(now_s, UTC),
                longitude_deg=None if position is None else position.lon,
                latitude_deg=None if position is None else position.lat,
            )
        )
