"""Session of one vehicle: authenticates its frames, decodes them, and sends messages to it."""

import logging
import math
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import AUTOPILOT
from mavlink.autopilot_type import MISSION_MODES, AutopilotType
from mavlink.commands.message_requests import MissingPhotos
from mavlink.decoding.boots import Stamp, VehicleTime
from mavlink.decoding.cameras import CameraReader, ReportedCamera
from mavlink.decoding.captures import CaptureDecoder
from mavlink.decoding.measurement import LinkQuality
from mavlink.decoding.report import FlownState, MeasurementDecoder, StatusText, TextCollector, is_place, is_vehicle
from mavlink.frames import Frame, Message, message_of
from mavlink.mission_sync.flown_items import FlightWatch, FlownMissionItem
from mavlink.mission_sync.limits import PARAMETERS
from mavlink.signing import FrameRefusal, FrameWriter
from mavlink.vehicle_state import VehicleState
from missions.models import LinkKind
from telemetry.gateway import heartbeat
from telemetry.gateway.addresses import MAX_ADDRESSES
from telemetry.gateway.fleet import KnownUav
from telemetry.gateway.message_requests import MessageRequests
from telemetry.gateway.options import OWN_COMPONENT, OWN_SYSTEM
from telemetry.gateway.peers import Peer
from telemetry.gateway.sender_authentication import SENDER_SILENT_S, SenderAuthentication, is_within
from telemetry.services.captures import NewCapture
from telemetry.services.ingest import NewRecord
from telemetry.services.links.links import Lease, LinkState
from telemetry.services.links.onboard_lists import Doubt

WINDOW_S = 10.0
TO_WHO_SENDS_A_LIST = frozenset({"MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"})  # sent only to a station that writes a list
QUIET_S = 10.0  # after one of our transfers, its answers may still arrive
logger = logging.getLogger(__name__)
MAX_WAITING = 5_000  # frames of a vehicle that waits for a lease
RECEIVED_WITHIN_S = 5.0  # otherwise non-urgent commands wait for it, or for another gateway
HEARTBEAT_AGAIN_S = 1.0
LATE = frozenset({FrameRefusal.TOO_OLD, FrameRefusal.BEFORE_START})
POSITIONS_MISSING_S = 3.0
RADIO = frozenset({mavlink.MAVLINK_MSG_ID_RADIO_STATUS, mavlink.MAVLINK_MSG_ID_RADIO})
SEND_TIME = frozenset({"GLOBAL_POSITION_INT", "ATTITUDE", "SYSTEM_TIME"})
ADDRESS_GOOD_S = 3_600.0  # longer than any flight: after this silence an address may belong to another host
Listener = Callable[[Message, float], None]


@dataclass(frozen=True, slots=True)
class Rate:
    """Receive rate; None before a whole window."""

    bytes_s: float | None = None
    messages_s: float | None = None


@dataclass
class LinkRate:
    """Rate of the last whole window. Times are Unix seconds."""

    _begin_s: float | None = None
    _bytes: int = 0
    _messages: int = 0
    _last: Rate = Rate()

    def count(self, size_bytes: int, now_s: float) -> None:
        self.at(now_s)
        self._bytes += size_bytes
        self._messages += 1

    def at(self, now_s: float) -> Rate:
        if self._begin_s is None or now_s < self._begin_s:
            self._begin_s, self._bytes, self._messages = now_s, 0, 0
        passed_s = now_s - self._begin_s
        if passed_s >= WINDOW_S:
            self._last = Rate(self._bytes / passed_s, self._messages / passed_s)
            self._begin_s, self._bytes, self._messages = now_s, 0, 0
        return self._last


@dataclass
class ListWatch:
    """Detects changes of one vehicle's lists by others. Times are monotonic seconds; the reporter takes the entries of `found`."""

    found: list[tuple[Doubt, float]] = field(default_factory=list)
    _transferred_s: float = -math.inf
    _total: int | None = None
    _boot: str | None = None

    def note_sent(self, message: Message, now_s: float) -> None:
        """Record a message sent by this gateway."""
        if message.get_type().startswith("MISSION_"):
            self._transferred_s = now_s

    def check(self, message: Message, state: VehicleState, now_s: float) -> None:
        """Check a message after the vehicle's state has received it."""
        is_ours = now_s - self._transferred_s <= QUIET_S
        if message.get_type() in TO_WHO_SENDS_A_LIST and not (is_ours and _is_to_us(message)):
            self._doubt(Doubt.OTHER_STATION, now_s)
        if state.mission_total is not None and state.mission_total != self._total:
            if self._total is not None and not is_ours:
                self._doubt(Doubt.OTHER_LENGTH, now_s)
            self._total = state.mission_total

    def check_boot(self, boot: str, now_s: float) -> None:
        """Check for a reboot. boot: key of the present run of the vehicle's clock."""
        if self._boot not in (None, boot):
            self._doubt(Doubt.REBOOTED, now_s)
        self._boot = boot

    def _doubt(self, doubt: Doubt, now_s: float) -> None:
        self.found = [*(one for one in self.found if one[0] is not doubt), (doubt, now_s)]


def _is_to_us(message: Message) -> bool:
    return message.target_system in (0, OWN_SYSTEM) and message.target_component in (0, OWN_COMPONENT)


@dataclass
class Session:
    """The session, which serves the vehicle once it has a lease.

    `records`, `captures`, `texts` and `flown` are to be stored, and removed by the code that stores them.
    """

    uav: KnownUav
    records: deque[NewRecord]
    link_id: int
    lease: Lease | None = None
    held_until_s: float = 0.0  # monotonic; after it another gateway may serve the vehicle, and nothing is sent
    losses: Counter[str] = field(default_factory=Counter)  # including those counted by earlier gateways
    lost_here: Counter[str] = field(default_factory=Counter)  # of all sessions of this gateway
    texts: list[StatusText] = field(default_factory=list)
    flown: list[FlownMissionItem] = field(default_factory=list)
    captures: deque[NewCapture] = field(default_factory=deque)
    authentication: SenderAuthentication = field(init=False)
    state: VehicleState = field(init=False)
    time: VehicleTime = field(default_factory=VehicleTime)
    listeners: list[Listener] = field(default_factory=list)  # receive every message of the autopilot
    log: Callable[[bytes, int, float], None] | None = None
    is_unsaved: bool = False
    message_requests: MessageRequests = field(default_factory=MessageRequests)
    cameras: CameraReader = field(default_factory=CameraReader)
    lists: ListWatch = field(default_factory=ListWatch)
    rate: LinkRate = field(default_factory=LinkRate)
    commanded_s: float | None = None  # monotonic time of the last command
    waiting: deque[tuple[Frame, Peer, float]] = field(default_factory=lambda: deque(maxlen=MAX_WAITING))
    _writer: FrameWriter = field(init=False, repr=False)
    _reporter: MeasurementDecoder = field(default_factory=MeasurementDecoder)
    _collector: TextCollector = field(default_factory=TextCollector)
    _quality: LinkQuality = field(default_factory=LinkQuality)
    _photos: CaptureDecoder = field(default_factory=CaptureDecoder)
    _missing_photos: MissingPhotos = field(default_factory=MissingPhotos)
    _flight: FlightWatch = field(default_factory=FlightWatch)
    _position_s: float = 0.0
    _greeted: dict[str, float] = field(default_factory=dict)  # time of the last heartbeat to each address

    def __post_init__(self) -> None:
        self.state = VehicleState(self.uav.system)
        self.authentication = SenderAuthentication(self.uav)
        self._writer = FrameWriter(OWN_SYSTEM, OWN_COMPONENT, self.link_id, self.uav.key)

    # Receiving

    def receive(self, frame: Frame, peer: Peer, now_s: float) -> None:
        """Take a frame. now_s: Unix seconds, as all times here but those of the vehicle's state and the listeners, which are monotonic."""
        if self.lease is None:
            if self.authentication.could_be(frame, now_s):
                self.waiting.append((frame, peer, now_s))
            return
        refusal = self.authentication.refusal(frame, peer, now_s)
        if refusal is not None:
            self._count_loss(refusal)
            if refusal in LATE:
                self._answer_late_clock(frame, peer, now_s)
            return
        self.is_unsaved = True
        self._quality.count(frame.component, frame.sequence)
        self.rate.count(len(frame.raw), now_s)
        if self.log is not None:
            self.log(frame.raw, frame.message_id, now_s)
        message = message_of(frame)
        if message is None:
            self._count_loss("unreadable")
        elif message.get_type() == "STATUSTEXT":
            self.texts += self._collector.receive(message, now_s)
        if message is not None and frame.component == AUTOPILOT:
            self._take(message, now_s)
        if message is not None:
            self.cameras.receive(message, time.monotonic())
            self._note_photo(message, now_s)

    def _count_loss(self, cause: str) -> None:
        self.losses[cause] += 1
        self.lost_here[cause] += 1

    def note_station(self, peer: Peer) -> None:
        """Record a message of another ground station from this address."""
        if peer == self.peer:
            self.message_requests.note_station(time.monotonic())

    def receive_radio(self, frame: Frame, now_s: float) -> None:
        """Take a frame of the vehicle's radio, which cannot sign."""
        message = message_of(frame)
        if message is not None:
            self._quality.receive_radio(message, now_s)

    def serve(self, lease: Lease, held_until_s: float) -> deque[tuple[Frame, Peer, float]]:
        """Begin to serve with the previous gateway's state. Returns the frames that waited, for the caller to receive again."""
        waiting, self.waiting = self.waiting, deque(maxlen=self.waiting.maxlen)
        self.lease, self.held_until_s = lease, held_until_s
        self.cameras = CameraReader([ReportedCamera.from_json(camera) for camera in lease.cameras], time.monotonic())
        self.losses = Counter(lease.losses)
        self._flight.take_up(was_in_mission=lease.mode_in_air in MISSION_MODES, mission_item=lease.mission_item)
        if not self.time.boots:
            self.time = VehicleTime.from_json(lease.boots)
        self.authentication.take_up(lease.signing, waiting[0][2] if waiting else time.time())
        self._writer.last_timestamp = max(self._writer.last_timestamp, lease.signing.get("sent", 0))
        return waiting

    def change(self, uav: KnownUav) -> None:
        """Take a changed row or key of the UAV."""
        self.authentication.change(uav)
        self.uav = uav

    def lose(self) -> None:
        self.lease = None
        self.waiting.clear()

    @property
    def peer(self) -> Peer | None:
        return self.authentication.peer

    @property
    def last_message_s(self) -> float:
        return self.authentication.last_message_s

    @property
    def is_held(self) -> bool:
        return self.lease is not None and time.monotonic() < self.held_until_s

    def is_served(self, now_s: float, within_s: float) -> bool:
        """Return whether this gateway serves it and its state is current: after an outage it may be armed, or be another vehicle."""
        is_here = is_within(self.last_message_s, now_s, within_s) and self.state.is_fresh(time.monotonic(), within_s)
        return self.is_held and is_here and self.state.autopilot_type is not None

    def may_receive(self, now_s: float) -> bool:
        """Return whether it can be sent to, even if nothing is received: it was recently accepted from a known address."""
        return self.is_held and self._has_address(now_s) and self.state.can_be_stopped

    def _has_address(self, now_s: float) -> bool:
        return self.peer is not None and is_within(self.last_message_s, now_s, ADDRESS_GOOD_S)

    def unsettled_until_s(self, settling_s: float) -> float | None:
        """Return until when an earlier message may still arrive, monotonic; None without one."""
        return None if self.commanded_s is None else self.commanded_s + settling_s

    # Sending

    def send(self, messages: list[Message], now_s: float | None = None) -> None:
        """Send messages; nothing unless the lease is surely held."""
        if self.is_held:
            self._send(messages, time.time() if now_s is None else now_s)

    def _send(self, messages: list[Message], now_s: float) -> None:
        peers = self.authentication.addresses.answered(now_s)
        if not peers:
            return
        self._writer.key = self.authentication.key
        for message in messages:
            raw = self._writer.frame_of(message, now_s)
            if self.log is not None:
                self.log(raw, message.get_msgId(), now_s)
            for peer in peers:
                peer.send(raw)
            self.lists.note_sent(message, time.monotonic())
        self.is_unsaved |= bool(messages)

    def tick(self, now_s: float, *, is_manned: bool = True) -> None:
        """Send the heartbeat and due requests, once a second.

        Without `is_manned` no heartbeat is sent, so that the vehicle detects the loss of its ground station.
        """
        self.texts += self._collector.tick(now_s)
        if self.lease is None or not self._has_address(now_s):
            return
        if is_manned:
            self._send([heartbeat.heartbeat()], now_s)
        if is_within(self.last_message_s, now_s, SENDER_SILENT_S):
            has_position = is_within(self._position_s, now_s, POSITIONS_MISSING_S)
            due = self.message_requests.due(self.state, time.monotonic(), has_position=has_position)
            system, monotonic_s = self.uav.system, time.monotonic()
            self.send([*due, *self.cameras.requests(system, monotonic_s), *self._missing_photos.requests(system, monotonic_s)], now_s)

    # State

    @property
    def limits(self) -> dict[str, float]:
        """Return those of mavlink.mission_sync.limits.PARAMETERS that the vehicle has reported, in metres."""
        return {name: self.state.parameters[name] for name in PARAMETERS if name in self.state.parameters}

    def link_state(self) -> LinkState:
        state, clock = self.state, self.time.clock
        home, rate = state.home, self.rate.at(time.time())
        return LinkState(
            uav_id=self.uav.uav_id,
            last_message_ago_s=max(time.time() - self.last_message_s, 0.0),
            address=self.peer.name[:100] if self.peer else "",
            autopilot=state.autopilot_type or "",
            firmware=".".join(map(str, state.firmware)) if state.firmware else "",
            vehicle_type=state.vehicle_type,
            mode=state.mode[:30],
            is_armed=state.is_armed,
            is_in_air=state.is_in_air,
            home_longitude_deg=home.lon if home else None,
            home_latitude_deg=home.lat if home else None,
            home_amsl_m=state.home_amsl_m if home else None,
            mission_item=state.mission_item,
            clock_offset_s=clock.offset_s if clock else None,
            clock_rate=clock.rate if clock else None,
            boots=self.time.to_json(),
            signing=self._signing(),
            losses=dict(self.losses),
            limits=(self.lease.limits if self.lease else {}) | self.limits,
            cameras=self._cameras(),
            battery_state=state.battery_state,
            received_bytes_s=rate.bytes_s,
            received_messages_s=rate.messages_s,
        )

    def _cameras(self) -> list[dict[str, Any]]:
        return [camera.to_json() for camera in self.cameras.cameras(time.monotonic())]

    def _signing(self) -> dict[str, Any]:
        signing = self.authentication.to_json()
        return signing and signing | {"sent": self._writer.last_timestamp}

    def _answer_late_clock(self, frame: Frame, peer: Peer, now_s: float) -> None:
        """Answer a vehicle that has the key but not the time by a signed heartbeat, which sets its clock, regardless of other senders."""
        self._greeted = {name: at_s for name, at_s in self._greeted.items() if is_within(at_s, now_s, HEARTBEAT_AGAIN_S)}
        if peer.name not in self._greeted and len(self._greeted) < MAX_ADDRESSES:
            self._greeted[peer.name] = now_s
            self._writer.key = self.authentication.key_of(frame)
            peer.send(self._writer.frame_of(heartbeat.heartbeat(), now_s))

    def _take(self, message: Message, now_s: float) -> None:
        kind = message.get_type()
        if kind == "HEARTBEAT" and not is_vehicle(message):
            return
        stamp = self._stamp(message, now_s) if kind in SEND_TIME else None
        self._reporter.receive(message, now_s)
        monotonic_s = time.monotonic()
        self.message_requests.receive(message, monotonic_s)
        if not _reports_no_place(message):
            self.state.receive(message, monotonic_s)
            self._note_flown(self._flight.check(self.state, kind))
            self.lists.check(message, self.state, monotonic_s)
        if kind == "GLOBAL_POSITION_INT" and stamp is not None:
            self._position_s = now_s
            self._record(message, stamp, now_s)
        for listener in list(self.listeners):
            listener(message, monotonic_s)

    def _note_photo(self, message: Message, now_s: float) -> None:
        """Queue the report of a photo from any component of the vehicle, such as its camera."""
        self._missing_photos.receive(message, time.monotonic())
        report = self._photos.receive(message, self.time, self.state.autopilot_type, now_s)
        if report is not None:
            self.captures.append(
                NewCapture(
                    uav_id=self.uav.uav_id,
                    link=LinkKind.MAVLINK,
                    stream=self.time.stream,
                    received_at=datetime.fromtimestamp(now_s, UTC),
                    report=report,
                    mission_item=self.state.mission_item,
                )
            )

    def forget_flown(self) -> None:
        """Reset the progress after an upload: items reached before belong to another list."""
        self._flight.forget()
        self.flown.clear()

    def _note_flown(self, flown: list[FlownMissionItem]) -> None:
        """Queue reached items. Only the last waiting one is needed; the first may be in transmission."""
        for item in flown:
            if len(self.flown) > 1 and not (self.flown[-1].is_down or item.is_down):
                self.flown.pop()
            self.flown.append(item)

    def _stamp(self, message: Message, now_s: float) -> Stamp:
        unix_s = message.time_unix_usec / 1e6 if message.get_type() == "SYSTEM_TIME" else None
        if self.time.boots:
            self.lists.check_boot(self.time.stream, time.monotonic())
        boot = self.time.stream if self.time.boots else None
        stamp = self.time.receive(message.time_boot_ms, now_s, unix_s=unix_s)
        self.lists.check_boot(self.time.stream, time.monotonic())
        if boot not in (None, self.time.stream):
            self.cameras = CameraReader()
        return stamp

    def _record(self, message: Message, stamp: Stamp, now_s: float) -> None:
        state = self.state
        flown = FlownState(state.mode, state.is_armed, state.is_in_air, state.mission_item, self._quality.percent(now_s))
        self.records.append(
            NewRecord(
                uav_id=self.uav.uav_id,
                link=LinkKind.MAVLINK,
                stream=stamp.stream,
                sequence=stamp.sequence,
                measured_at=datetime.fromtimestamp(stamp.measured_s, UTC),
                received_at=datetime.fromtimestamp(now_s, UTC),
                measurement=self._reporter.measurement(message, flown, now_s),
            )
        )

    @property
    def autopilot_type(self) -> AutopilotType | None:
        return self.state.autopilot_type


def _reports_no_place(message: Message) -> bool:
    """Return whether a position or home message has no position; such a message is ignored."""
    if message.get_type() == "GLOBAL_POSITION_INT":
        return not is_place(message.lat, message.lon)
    if message.get_type() == "HOME_POSITION":
        return not is_place(message.latitude, message.longitude)
    return False
