"""Vehicle side of MAVLink's mission protocol. One transfer at a time; a list is replaced completely or not at all.

Rules beyond the MAVLink guide avoid time-outs: a repeated count restarts, a repeated item is answered again, an item out of order causes a
request for the right one, and a silent station is notified that its upload has ended.
"""

import math
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message
from mavlink.vehicle_plan import MissionItem, MissionType
from simulation.vehicle_protocol.item_rules import MAX_ITEMS, refusal_of, refusal_of_list
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.streams import Outgoing, Station

E7 = 1e7
_MAX_E7 = 2**31 - 1
WITH_PLACE = frozenset(
    {16, 17, 18, 19, 21, 22, 31, 82, 195, 201}
)  # of a mission: waypoints, loiter, land, take-off, splines, regions of interest
# Number of parameters that ArduCopter stores, as integers (read in its AP_Mission.cpp); the others become 0.
KEPT_BY_ARDUPILOT = {
    mavlink.MAV_CMD_NAV_WAYPOINT: 1, mavlink.MAV_CMD_NAV_TAKEOFF: 1, mavlink.MAV_CMD_NAV_LAND: 1, mavlink.MAV_CMD_NAV_LOITER_TIME: 1,
    mavlink.MAV_CMD_DO_SET_ROI_LOCATION: 1, mavlink.MAV_CMD_DO_SET_ROI_NONE: 1, mavlink.MAV_CMD_DO_SET_ROI: 1,
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: 0,
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION: 1, mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION: 1,
    mavlink.MAV_CMD_NAV_RALLY_POINT: 0,
}  # fmt: skip
REQUEST_INTERVAL_S = 0.25
MAX_REQUESTS = 20  # of one item
ALL_LISTS = mavlink.MAV_MISSION_TYPE_ALL
ACCEPTED, DENIED = int(mavlink.MAV_MISSION_ACCEPTED), int(mavlink.MAV_MISSION_DENIED)
Replace = Callable[[MissionType, tuple[MissionItem, ...]], int]  # returns a MAV_MISSION_RESULT; unchanged unless ACCEPTED


def item_of(message: Any) -> MissionItem:
    """Return the item of a MISSION_ITEM_INT, or of a MISSION_ITEM with positions in float degrees. Never raises; NaN is kept."""
    parameters = (message.param1, message.param2, message.param3, message.param4)
    if message.get_type() == "MISSION_ITEM_INT":
        return MissionItem(message.command, message.frame, parameters, message.y, message.x, message.z)
    return MissionItem(message.command, message.frame, parameters, _e7(message.y), _e7(message.x), message.z)


def item_message(item: MissionItem, number: int, kind: MissionType, to: Station, *, is_current: bool) -> Message:
    return mavlink.MAVLink_mission_item_int_message(
        *to.target, number, item.frame, item.command, int(is_current), 1, *item.parameters,
        item.latitude_e7, item.longitude_e7, item.altitude_m, int(kind),
    )  # fmt: skip


def float_item_message(item: MissionItem, number: int, kind: MissionType, to: Station, *, is_current: bool) -> Message:
    """Return the answer to MISSION_REQUEST, the older protocol with float positions."""
    return mavlink.MAVLink_mission_item_message(
        *to.target, number, item.frame, item.command, int(is_current), 1, *item.parameters,
        item.latitude_e7 / E7, item.longitude_e7 / E7, item.altitude_m, int(kind),
    )  # fmt: skip


def as_kept(item: MissionItem, kind: MissionType, autopilot_type: SimulatedAutopilot) -> MissionItem:
    """Return the item as stored. PX4 keeps all; ArduPilot truncates altitudes to centimetres and discards parameters."""
    if autopilot_type is SimulatedAutopilot.PX4:
        return item
    parameters = [0.0 if math.isnan(value) else value for value in item.parameters]
    if kind is MissionType.MISSION and item.command == mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW:  # whole degrees, flags and device id
        pitch, yaw, pitch_rate, yaw_rate = (float(math.trunc(value)) for value in parameters)
        device = 0.0 if math.isnan(item.altitude_m) else float(math.trunc(item.altitude_m))
        whole = (pitch, yaw, pitch_rate, yaw_rate)
        return MissionItem(item.command, mavlink.MAV_FRAME_GLOBAL, whole, 0, item.latitude_e7, device)
    kept = KEPT_BY_ARDUPILOT.get(item.command)
    if kept is not None:
        parameters = [float(math.trunc(value)) if place < kept else 0.0 for place, value in enumerate(parameters)]
    one, two, three, four = parameters
    if kind is MissionType.MISSION and item.command not in WITH_PLACE:
        return MissionItem(item.command, mavlink.MAV_FRAME_GLOBAL, (one, two, three, four))
    frame = {mavlink.MAV_FRAME_GLOBAL_INT: mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT: 3}.get(
        item.frame, item.frame
    )
    altitude_m = 0.0 if math.isnan(item.altitude_m) else math.trunc(_float32(_float32(item.altitude_m) * 100.0)) / 100.0
    return MissionItem(item.command, frame, (one, two, three, four), item.longitude_e7, item.latitude_e7, altitude_m)


def _e7(degrees: float) -> int:
    """Return scaled degrees; out of range for NaN, so that the position is refused."""
    return max(-_MAX_E7, min(_MAX_E7, round(degrees * E7))) if math.isfinite(degrees) else _MAX_E7


def _float32(value: float) -> float:
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


@dataclass
class _Upload:
    station: Station
    kind: MissionType
    count: int
    asked_s: float
    items: list[MissionItem] = field(default_factory=list)
    requests: int = 1


@dataclass
class MissionServer:
    """The lists of a vehicle. `held` are the lists without home; `replace` is called with each new list first, and may refuse it.

    `home` is item 0 in ArduPilot's readback, `current` the number of the present item, as the autopilot counts.
    """

    autopilot_type: SimulatedAutopilot
    replace: Replace
    home: Callable[[], MissionItem]
    current: Callable[[], int]
    held: dict[MissionType, tuple[MissionItem, ...]] = field(default_factory=lambda: dict.fromkeys(MissionType, ()))
    _upload: _Upload | None = None
    _done: tuple[Station, MissionType, int] | None = None  # of the completed upload: station, list, and number of its last item

    def receive(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        """Return the answers to messages of the mission protocol."""
        name = message.get_type()
        if name == "MISSION_CLEAR_ALL":
            return self._clear(message.mission_type, station)
        if name not in _HANDLERS:
            return []
        kind = _kind_of(message)
        if kind is None:
            return [] if name == "MISSION_ACK" else [_ack(mavlink.MAV_MISSION_UNSUPPORTED, message.mission_type, station)]
        return _HANDLERS[name](self, message, kind, station, now_s)

    def tick(self, now_s: float) -> list[Outgoing]:
        upload = self._upload
        if upload is None or now_s < upload.asked_s + REQUEST_INTERVAL_S:
            return []
        if upload.requests >= MAX_REQUESTS:
            self._upload = None
            return [_ack(mavlink.MAV_MISSION_OPERATION_CANCELLED, upload.kind, upload.station)]
        upload.requests += 1
        return self._ask(upload, now_s)

    @property
    def is_uploading(self) -> bool:
        return self._upload is not None

    # Upload

    def _announced(self, message: Any, kind: MissionType, station: Station, now_s: float) -> list[Outgoing]:
        if self._upload is not None and self._upload.station != station:
            return [_ack(DENIED, kind, station)]
        self._upload = self._done = None
        flown = max(message.count - self._first(kind), 0)
        if flown > MAX_ITEMS[self.autopilot_type][kind]:
            return [_ack(mavlink.MAV_MISSION_NO_SPACE, kind, station)]
        if message.count == 0:
            return [_ack(self.put(kind, ()), kind, station)]
        self._upload = _Upload(station, kind, message.count, now_s)
        return self._ask(self._upload, now_s)

    def _item(self, message: Any, kind: MissionType, station: Station, now_s: float) -> list[Outgoing]:
        upload = self._upload
        if upload is None or (upload.station, upload.kind) != (station, kind):
            if upload is None and self._done == (station, kind, message.seq):
                return [_ack(ACCEPTED, kind, station)]  # the acknowledgement was lost
            result = mavlink.MAV_MISSION_INVALID_SEQUENCE if upload is None or upload.station == station else DENIED
            return [_ack(result, kind, station)]
        if message.seq != len(upload.items):
            return [] if message.seq < len(upload.items) else self._ask(upload, now_s)
        item = item_of(message)
        is_flown = message.seq >= self._first(kind)
        refusal = refusal_of(item, kind) if is_flown else None
        if refusal is not None:
            self._upload = None
            return [_ack(refusal, kind, station)]
        upload.items.append(as_kept(item, kind, self.autopilot_type) if is_flown else item)
        upload.requests = 1
        return self._ask(upload, now_s) if len(upload.items) < upload.count else self._complete(upload)

    def _complete(self, upload: _Upload) -> list[Outgoing]:
        self._upload = None
        items = tuple(upload.items[self._first(upload.kind) :])
        result = refusal_of_list(items, upload.kind)
        result = self.put(upload.kind, items) if result is None else result
        if result == ACCEPTED:
            self._done = (upload.station, upload.kind, upload.count - 1)
        return [_ack(result, upload.kind, upload.station)]

    def put(self, kind: MissionType, items: tuple[MissionItem, ...]) -> int:
        """Replace the list; unchanged unless the result is ACCEPTED."""
        result = self.replace(kind, items)
        if result == ACCEPTED:
            self.held[kind] = items
        return result

    def _ask(self, upload: _Upload, now_s: float) -> list[Outgoing]:
        """Request the next item. ArduPilot uses the older message, and accepts the newer items as answers."""
        upload.asked_s = now_s
        message: type[Message] = mavlink.MAVLink_mission_request_int_message
        if self.autopilot_type is SimulatedAutopilot.ARDUPILOT:
            message = mavlink.MAVLink_mission_request_message
        return [Outgoing(message(*upload.station.target, len(upload.items), int(upload.kind)), upload.station)]

    def _acknowledged(self, message: Any, kind: MissionType, station: Station, now_s: float) -> list[Outgoing]:
        upload = self._upload
        if upload is not None and (upload.station, upload.kind) == (station, kind) and message.type != ACCEPTED:
            self._upload = None
        return []

    def _clear(self, mission_type: int, station: Station) -> list[Outgoing]:
        kinds = list(MissionType) if mission_type == ALL_LISTS else [kind for kind in MissionType if kind == mission_type]
        if not kinds:
            return [_ack(mavlink.MAV_MISSION_UNSUPPORTED, mission_type, station)]
        if self._upload is not None:
            return [_ack(mavlink.MAV_MISSION_ERROR, mission_type, station)]
        results = [self.put(kind, ()) for kind in kinds]
        return [_ack(next((result for result in results if result != ACCEPTED), ACCEPTED), mission_type, station)]

    # Download

    def _listed(self, message: Any, kind: MissionType, station: Station, now_s: float) -> list[Outgoing]:
        return [Outgoing(mavlink.MAVLink_mission_count_message(*station.target, len(self._reported(kind)), int(kind)), station)]

    def _requested(self, message: Any, kind: MissionType, station: Station, now_s: float) -> list[Outgoing]:
        reported = self._reported(kind)
        if message.seq >= len(reported):
            return [_ack(mavlink.MAV_MISSION_INVALID_SEQUENCE, kind, station)]
        is_current = kind is MissionType.MISSION and message.seq == self.current()
        write = item_message if message.get_type() == "MISSION_REQUEST_INT" else float_item_message
        return [Outgoing(write(reported[message.seq], message.seq, kind, station, is_current=is_current), station)]

    def _reported(self, kind: MissionType) -> Sequence[MissionItem]:
        return self.held[kind] if self._first(kind) == 0 else (self.home(), *self.held[kind])

    def _partial(self, message: Any, kind: MissionType, station: Station, now_s: float) -> list[Outgoing]:
        """Refuse partial changes of a list."""
        return [_ack(mavlink.MAV_MISSION_UNSUPPORTED, kind, station)]

    def _first(self, kind: MissionType) -> int:
        return self.autopilot_type.first_item if kind is MissionType.MISSION else 0


_HANDLERS = {
    "MISSION_COUNT": MissionServer._announced,
    "MISSION_ITEM_INT": MissionServer._item,
    "MISSION_ITEM": MissionServer._item,
    "MISSION_ACK": MissionServer._acknowledged,
    "MISSION_REQUEST_LIST": MissionServer._listed,
    "MISSION_REQUEST_INT": MissionServer._requested,
    "MISSION_REQUEST": MissionServer._requested,
    "MISSION_WRITE_PARTIAL_LIST": MissionServer._partial,
    "MISSION_REQUEST_PARTIAL_LIST": MissionServer._partial,
}


def _kind_of(message: Any) -> MissionType | None:
    return next((kind for kind in MissionType if kind == message.mission_type), None)


def _ack(result: int, kind: int, to: Station) -> Outgoing:
    return Outgoing(mavlink.MAVLink_mission_ack_message(*to.target, int(result), int(kind)), to)
