"""Frames of tlog files, and a tlog file of a simulated flight as the log of a ground station has it."""

import struct
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.decoding import flight_log
from mavlink.frames import frames_of_datagram, message_of
from mavlink.mission_items import flight_loads
from simulation.flight.states import FlightMode
from simulation.flight.uav import SimulatedUav
from simulation.vehicle_protocol.endpoint import Endpoint
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from tests.telemetry.estimation.simulated import simulated_flight

BEGUN_UNIX_S = 1_790_000_000.0
FIX_AT_S, ARMS_AT_S, ENDS_AT_S = 8.0, 12.0, 70.0
LOST_EVERY = 400  # frames of the vehicle of which the radio lost one
STEP_S = 0.04
UNKNOWN_MESSAGE = 229  # no message of the dialect has this id


def frames_of_tlog(path: Path) -> list[tuple[float, bytes]]:
    """Each with its time [s since 1970]; those of messages that nobody knows too."""
    with path.open("rb") as file:
        return list(flight_log.frames_of_tlog(file))


def positions_of(raws: Iterable[bytes]) -> list[Any]:
    found = (frame for raw in raws for frame in frames_of_datagram(raw, Counter()))
    messages = (message_of(frame) for frame in found if frame.message_id == 33)
    return [message for message in messages if message is not None]


def write_tlog_of_flight(path: Path) -> Path:
    """Write 70 s of a simulated flight in MAVLink 1, the same each time; return the path.

    As in a real log, frames of the station and of the radio lie between those of the vehicle (system 1), frames are lost, and the
    vehicle has no GPS fix at first, and reports position 0, 0 until then.
    """
    vehicle, station, radio = mavlink.MAVLink(None, 1, 1), mavlink.MAVLink(None, 255, 0), mavlink.MAVLink(None, 51, 68)
    with path.open("wb") as file:
        for number, (at_s, message) in enumerate(_reports_of_flight()):
            raw = bytes(message.pack(vehicle, force_mavlink1=True))
            frames = [] if number % LOST_EVERY == LOST_EVERY - 1 else [raw]
            vehicle.seq = (vehicle.seq + 1) % 256
            if number % 12 == 0:
                request = mavlink.MAVLink_param_request_read_message(1, 1, b"", number // 12)
                frames.append(bytes(request.pack(station, force_mavlink1=True)))
                station.seq = (station.seq + 1) % 256
            if number % 30 == 0:
                status = mavlink.MAVLink_radio_status_message(217, 219, 100, 49, 55, 0, 0)
                frames += [bytes(status.pack(radio, force_mavlink1=True)), bytes([0xFE, 4, 0, 51, 68, UNKNOWN_MESSAGE, 1, 2, 3, 4, 5, 6])]
            file.writelines(struct.pack(">Q", round((BEGUN_UNIX_S + at_s) * 1e6)) + frame for frame in frames)
    return path


def _reports_of_flight() -> Iterator[tuple[float, Any]]:
    """Yield seconds since the log began, and the messages of a vehicle that stands, is armed, and flies its mission."""
    case = simulated_flight(3)
    uav = SimulatedUav(case.airframe, case.flight.take_off.position, weather=case.weather, seed=3, physics_hz=100)
    endpoint = Endpoint(uav, autopilot_type=SimulatedAutopilot.ARDUPILOT, system=1, unix_at_zero_s=BEGUN_UNIX_S)
    assert uav.load(flight_loads(case.route)[case.flight.number].mission).is_done
    has_fix = False
    for step in range(round(ENDS_AT_S / STEP_S)):
        at_s = step * STEP_S
        if step == round(ARMS_AT_S / STEP_S):
            assert uav.set_mode(FlightMode.MISSION).is_done and uav.arm().is_done
        uav.step()
        for outgoing in endpoint.tick(at_s):
            message = outgoing.message
            if outgoing.component != 1 or message.get_msgId() > 255:  # MAVLink 1 has no such message
                continue
            has_fix = has_fix or (message.get_type() == "GPS_RAW_INT" and at_s >= FIX_AT_S)
            if message.get_type() in {"GPS_RAW_INT", "GLOBAL_POSITION_INT"} and not has_fix:
                message.lat = message.lon = 0
                message.fix_type = mavlink.GPS_FIX_TYPE_NO_FIX  # of GPS_RAW_INT
            yield at_s, message
