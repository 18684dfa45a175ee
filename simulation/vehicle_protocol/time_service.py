"""Answers to who measures the way to the vehicle, or its clock."""

from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from simulation.vehicle_protocol.stations import Outgoing, Station

_LARGEST_NS = 2**63 - 1


def timesync_answer(message: Any, station: Station, now_s: float) -> list[Outgoing]:
    """now_s: by one clock that never goes back. A message that bears a time of ours already is itself an answer."""
    if message.tc1 != 0:
        return []
    now_ns = min(int(now_s * 1e9), _LARGEST_NS)
    return [Outgoing(mavlink.MAVLink_timesync_message(now_ns, message.ts1), station)]


def ping_answer(message: Any, station: Station) -> list[Outgoing]:
    """A ping to everybody is answered to who sent it; one that names somebody is the answer to a ping."""
    if (message.target_system, message.target_component) != (0, 0):
        return []
    return [Outgoing(mavlink.MAVLink_ping_message(message.time_usec, message.seq, *station.ends), station)]
