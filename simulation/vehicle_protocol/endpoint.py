"""MAVLink endpoint of a simulated UAV: answers messages, and sends what is due.

Streams use the UAV's clock, which may run faster than real time; heartbeats and protocol retries use real time.
"""

import math
from collections.abc import Callable
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message
from mavlink.mission_items import position_e7
from mavlink.vehicle_plan import MissionItem, MissionType
from simulation.flight import events
from simulation.flight.airframe import Settings
from simulation.flight.states import OrderRefused, Severity, SimulatedState
from simulation.vehicle_protocol import requests
from simulation.vehicle_protocol.camera_endpoint import CameraEndpoint
from simulation.vehicle_protocol.command_endpoint import NotFinite, acknowledgement, command_of
from simulation.vehicle_protocol.fence import MODES, FenceAction, FenceWatch, fence_of, rally_points_of
from simulation.vehicle_protocol.mission_server import MissionServer
from simulation.vehicle_protocol.mode_numbers import AUTO, SimulatedAutopilot
from simulation.vehicle_protocol.parameters import parameters_of, settings_at_start
from simulation.vehicle_protocol.pilot import ACCEPTED, CAMERA_COMMANDS, DENIED, FAILED, UNSUPPORTED, Pilot
from simulation.vehicle_protocol.reports import REPORTS, SimulatedReport, heartbeat, mission_current
from simulation.vehicle_protocol.requests import Requests
from simulation.vehicle_protocol.streams import AUTOPILOT, CAMERA, GIMBAL, Outgoing, Station, Streams, is_for
from simulation.vehicle_protocol.vehicle import Vehicle

PIECE = 50  # bytes of one STATUSTEXT
MAX_PIECES = 5
HEARTBEAT_S = 1.0
MAX_NUMBER = 65_535
SEVERITIES = {
    Severity.INFO: mavlink.MAV_SEVERITY_INFO, Severity.WARNING: mavlink.MAV_SEVERITY_WARNING,
    Severity.CRITICAL: mavlink.MAV_SEVERITY_CRITICAL,
}  # fmt: skip


def text_messages(text: str, severity: int, number: int) -> list[Message]:
    """Return the text in pieces if it is long, truncated to MAX_PIECES; `number` (1 to 65535) identifies the pieces of one text."""
    words = text.encode("ascii", "replace")[: PIECE * MAX_PIECES]
    pieces = [words[start : start + PIECE] for start in range(0, len(words), PIECE)] or [b""]
    identity = number if len(pieces) > 1 else 0
    if identity and len(pieces[-1]) == PIECE and len(pieces) < MAX_PIECES:
        pieces.append(b"")  # a full last piece would not show that it is the last
    return [mavlink.MAVLink_statustext_message(severity, piece, identity, place) for place, piece in enumerate(pieces)]


class Endpoint:
    """The endpoint. Times are monotonic seconds of real time; `unix_at_zero_s` is the vehicle's time of day when they were 0."""

    def __init__(self, vehicle: Vehicle, *, autopilot_type: SimulatedAutopilot, system: int, unix_at_zero_s: float) -> None:
        self.vehicle = vehicle
        self.autopilot_type = autopilot_type
        self.system = system
        self.unix_at_zero_s = unix_at_zero_s
        settings = settings_at_start(vehicle.settings, autopilot_type)
        vehicle.settings = settings
        self.pilot = Pilot(vehicle, autopilot_type)
        self.parameters = parameters_of(autopilot_type, system, settings, self._configure)
        self.streams = Streams(autopilot_type, phase=float(system))
        self.missions = MissionServer(autopilot_type, self._replace, self._home_item, self._current_item)
        self._fence = FenceWatch(autopilot_type, self.parameters)
        self.camera = CameraEndpoint(vehicle.camera, autopilot_type)
        self._requests = Requests(autopilot_type, system, self.streams, self._report, self.camera)
        self._now_s = 0.0
        self._heartbeat_due_s = self._camera_heartbeat_due_s = -math.inf
        self._reported: tuple[int, bool] | None = None  # mode and arming of the last heartbeat
        self._texts = 0

    def receive(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        """Return the answers to a message. Never raises, whatever the message contains."""
        if station.system == self.system:
            return []
        if getattr(message, "target_component", 0) == CAMERA and is_for(message, self.system, CAMERA):
            return self._camera_command(message, station, now_s) if message.get_type().startswith("COMMAND_") else []
        if not is_for(message, self.system):
            return []
        handler = _HANDLERS.get(message.get_type())
        if handler is None:
            return []
        self._now_s = now_s
        answers = handler(self, message, station, now_s)
        return [*answers, *self._refusal(), *self._changed_heartbeat(now_s)]

    def tick(self, now_s: float) -> list[Outgoing]:
        """Return what is due; call it after each step of the flight, or more often."""
        self._now_s = now_s
        messages: list[Message] = []
        photos: list[Outgoing] = []
        for event in self.vehicle.take_events():
            reported = _REPORTED.get(type(event))
            if reported is not None:
                messages += reported(self, event)
            elif isinstance(event, events.PhotoTaken):
                photos += [Outgoing(message, None, component) for component, message in self.camera.photo(event, self._report())]
        state = self.vehicle.state
        messages += self._mind_fence(state)
        report = self._report()
        streamed = [Outgoing(REPORTS[number](report), None, self._sender(number)) for number in self.streams.due(state.at_s)]
        heartbeats = [*self._heartbeat(report, now_s), *self._camera_heartbeat(now_s)]
        return [*map(Outgoing, messages), *photos, *streamed, *heartbeats, *self.missions.tick(now_s)]

    # Receiving

    def _command(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        """Return one acknowledgement in any case."""
        wanted: list[Message] = []
        try:
            command = command_of(message)
            answer = self._requests.answer(command)
            if answer is not None:
                result, wanted = answer
            elif command.number == mavlink.MAV_CMD_DO_FENCE_ENABLE:
                result = self._fence.switch(command.whole(1))
            else:
                result = self.pilot.carry_out(command)
        except NotFinite:
            result = DENIED
        except (ValueError, ArithmeticError):  # unexpected values
            result = FAILED
        return [acknowledgement(message.command, result, station), *(Outgoing(one, station) for one in wanted)]

    def _camera_command(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        """Return the camera's acknowledgement of a command to it, and the requested message."""
        self._now_s = now_s
        asked: Message | None = None
        try:
            command = command_of(message)
            asked = self.camera.answer(command, self._report())
            is_accepted = asked is not None or command.number == mavlink.MAV_CMD_SET_CAMERA_MODE
            result = ACCEPTED if is_accepted else self.pilot.operate(command) if command.number in CAMERA_COMMANDS else UNSUPPORTED
        except NotFinite:
            result = DENIED
        except (ValueError, ArithmeticError):  # unexpected values
            result = FAILED
        self.pilot.refusal = ""  # a camera sends no status texts
        answers = [acknowledgement(message.command, result, station), *([] if asked is None else [Outgoing(asked, station)])]
        return [Outgoing(answer.message, answer.to, CAMERA) for answer in answers]

    def _sender(self, message: int) -> int:
        is_gimbal = message == mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS and self.autopilot_type is SimulatedAutopilot.PX4
        return GIMBAL if is_gimbal else AUTOPILOT

    def _set_mode(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        is_own = message.base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        result = self.pilot.set_mode_number(message.custom_mode) if is_own else UNSUPPORTED
        return [acknowledgement(mavlink.MAVLINK_MSG_ID_SET_MODE, result, station)]

    def _set_current(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        self.pilot.set_current(message.seq)
        return [Outgoing(mission_current(self._report()))]

    def _mission(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        return self.missions.receive(message, station, now_s)

    def _parameter(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        return self.parameters.receive(message, station)

    def _file(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        return requests.refused(message, station)

    def _timesync(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        return requests.timesync_answer(message, station, now_s)

    def _ping(self, message: Any, station: Station, now_s: float) -> list[Outgoing]:
        return requests.ping_answer(message, station)

    # State changes

    def _configure(self, settings: Settings) -> None:
        self.vehicle.settings = settings

    def _replace(self, kind: MissionType, items: tuple[MissionItem, ...]) -> int:
        if kind is MissionType.FENCE:
            self._fence.fence = fence_of(items)
        if kind is MissionType.RALLY:
            self.vehicle.rally_points = rally_points_of(items, self.vehicle.state.home_amsl_m)
        if kind is not MissionType.MISSION:
            self.parameters.show(f"{kind.name}_TOTAL", float(len(items)))
            return int(mavlink.MAV_MISSION_ACCEPTED)
        is_flown = self.vehicle.state.is_armed and self.pilot.custom_mode == AUTO
        if self.autopilot_type is SimulatedAutopilot.ARDUPILOT and not items and is_flown:
            return int(mavlink.MAV_MISSION_ERROR)
        outcome = self.vehicle.load(items)
        self.streams.send_now(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT)
        if isinstance(outcome, OrderRefused):
            self.pilot.refusal = str(outcome.words)
            return int(mavlink.MAV_MISSION_DENIED)
        return int(mavlink.MAV_MISSION_ACCEPTED)

    def _mind_fence(self, state: SimulatedState) -> list[Message]:
        action = self._fence.check(state.position, state.at_s, is_in_air=state.is_in_air)
        if action is FenceAction.NONE:
            return []
        if action in MODES:
            self.pilot.set_mode(MODES[action])
        return self._text(f"Fence broken: {action.value}", mavlink.MAV_SEVERITY_CRITICAL)

    # Reports

    def _report(self) -> SimulatedReport:
        return SimulatedReport(
            state=self.vehicle.state,
            autopilot_type=self.autopilot_type,
            custom_mode=self.pilot.custom_mode,
            current_item=self._current_item(),
            item_count=len(self.vehicle.items),
            unix_s=self.unix_at_zero_s + self._now_s,
            is_fence_broken=self._fence.is_broken,
        )

    def _current_item(self) -> int:
        """Return the present item; the last for a completed list."""
        count = len(self.vehicle.items)
        return min(self.vehicle.state.current_item, count - 1) + self.autopilot_type.first_item if count else 0

    def _home_item(self) -> MissionItem:
        state = self.vehicle.state
        longitude_e7, latitude_e7 = position_e7(state.home)
        nothing = (0.0, 0.0, 0.0, 0.0)
        return MissionItem(mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_FRAME_GLOBAL, nothing, longitude_e7, latitude_e7, state.home_amsl_m)

    def _heartbeat(self, report: SimulatedReport, now_s: float) -> list[Outgoing]:
        """Return a heartbeat every second, and at each change of mode or arming."""
        shows = (report.custom_mode, report.state.is_armed)
        if now_s < self._heartbeat_due_s and shows == self._reported:
            return []
        self._heartbeat_due_s, self._reported = now_s + HEARTBEAT_S, shows
        return [Outgoing(heartbeat(report))]

    def _camera_heartbeat(self, now_s: float) -> list[Outgoing]:
        if now_s < self._camera_heartbeat_due_s:
            return []
        self._camera_heartbeat_due_s = now_s + HEARTBEAT_S
        return [Outgoing(self.camera.heartbeat(), None, CAMERA)]

    def _changed_heartbeat(self, now_s: float) -> list[Outgoing]:
        if self._reported == (self.pilot.custom_mode, self.vehicle.state.is_armed):
            return []
        return self._heartbeat(self._report(), now_s)

    def _refusal(self) -> list[Outgoing]:
        words, self.pilot.refusal = self.pilot.refusal, ""
        return [Outgoing(one) for one in self._text(words, mavlink.MAV_SEVERITY_WARNING)] if words else []

    def _text(self, words: str, severity: int) -> list[Message]:
        self._texts = self._texts % MAX_NUMBER + 1
        return text_messages(words, severity, self._texts)

    def _reached(self, event: events.ItemReached) -> list[Message]:
        """Report the item before the heartbeat of a landing, so that the flight does not appear interrupted."""
        reached = mavlink.MAVLink_mission_item_reached_message(event.index + self.autopilot_type.first_item)
        return [reached, mission_current(self._report())]

    def _ended(self, event: events.MissionEnded) -> list[Message]:
        return [mission_current(self._report())]

    def _stated(self, event: events.StatusTextSent) -> list[Message]:
        return self._text(str(event.text), SEVERITIES[event.severity])

    def _landed(self, event: events.Event) -> list[Message]:
        return [REPORTS[mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE](self._report())]

    def _crashed(self, event: events.Crashed) -> list[Message]:
        self._heartbeat_due_s = -math.inf
        return [*self._text(f"Crashed: {event.reason}", mavlink.MAV_SEVERITY_EMERGENCY), *self._landed(event)]


_HANDLERS: dict[str, Callable[[Endpoint, Any, Station, float], list[Outgoing]]] = {
    "COMMAND_LONG": Endpoint._command,
    "COMMAND_INT": Endpoint._command,
    "SET_MODE": Endpoint._set_mode,
    "MISSION_SET_CURRENT": Endpoint._set_current,
    "MISSION_COUNT": Endpoint._mission,
    "MISSION_ITEM": Endpoint._mission,
    "MISSION_ITEM_INT": Endpoint._mission,
    "MISSION_REQUEST": Endpoint._mission,
    "MISSION_REQUEST_INT": Endpoint._mission,
    "MISSION_REQUEST_LIST": Endpoint._mission,
    "MISSION_REQUEST_PARTIAL_LIST": Endpoint._mission,
    "MISSION_WRITE_PARTIAL_LIST": Endpoint._mission,
    "MISSION_CLEAR_ALL": Endpoint._mission,
    "MISSION_ACK": Endpoint._mission,
    "PARAM_REQUEST_LIST": Endpoint._parameter,
    "PARAM_REQUEST_READ": Endpoint._parameter,
    "PARAM_SET": Endpoint._parameter,
    "FILE_TRANSFER_PROTOCOL": Endpoint._file,
    "TIMESYNC": Endpoint._timesync,
    "PING": Endpoint._ping,
}
_REPORTED: dict[type, Callable[[Endpoint, Any], list[Message]]] = {
    events.ItemReached: Endpoint._reached,
    events.MissionEnded: Endpoint._ended,
    events.StatusTextSent: Endpoint._stated,
    events.TookOff: Endpoint._landed,
    events.LandedAt: Endpoint._landed,
    events.Crashed: Endpoint._crashed,
}
