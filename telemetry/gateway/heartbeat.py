"""Messages that a gateway sends to a vehicle by itself: heartbeats, and requests for messages."""

from collections.abc import Mapping

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import AUTOPILOT
from mavlink.autopilot_type import AutopilotType
from mavlink.frames import Message
from mavlink.mission_sync.limits import PARAMETERS
from mavlink.parameters import BY_NAME

INTERVALS_S = {
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 0.2,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: 0.2,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: 0.5,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 1.0,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: 1.0,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 2.0,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 1.0,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 1.0,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
    mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS: 1.0,  # for photos whose message has no attitude of the camera
}
OPTIONAL = frozenset({mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS})  # not every vehicle has it
WIND = {AutopilotType.PX4: mavlink.MAVLINK_MSG_ID_WIND_COV, AutopilotType.ARDUPILOT: mavlink.MAVLINK_MSG_ID_WIND}
WIND_INTERVAL_S = 2.0
ONCE = (mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION, mavlink.MAVLINK_MSG_ID_HOME_POSITION)
STREAM_HZ = 4  # of all data streams, for autopilots without message intervals
FRAME_BYTES = 25  # of a signed frame of MAVLink 2 beside its payload
MAX_STRETCH_FACTOR = 5.0  # brings the position down to 1 Hz


def heartbeat() -> Message:
    return mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, mavlink.MAV_STATE_ACTIVE, 3)


def intervals_s(autopilot_type: AutopilotType, budget_bytes_s: float) -> dict[int, float]:
    """Return the intervals of telemetry messages by id, stretched equally, at most by MAX_STRETCH_FACTOR, to fit a budget (0: none)."""
    wanted = INTERVALS_S | ({WIND[autopilot_type]: WIND_INTERVAL_S} if autopilot_type in WIND else {})
    load_bytes_s = sum((mavlink.mavlink_map[number].unpacker.size + FRAME_BYTES) / every_s for number, every_s in wanted.items())
    stretch = 1.0 if budget_bytes_s <= 0.0 else min(max(load_bytes_s / budget_bytes_s, 1.0), MAX_STRETCH_FACTOR)
    return {number: every_s * stretch for number, every_s in wanted.items()}


def interval_requests(system: int, wanted_s: Mapping[int, float]) -> list[Message]:
    return [_command(system, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, number, every_s * 1e6) for number, every_s in wanted_s.items()]


def streams(system: int, *, is_on: bool) -> Message:
    """Return the request that turns all data streams on or off; on is for autopilots without message intervals."""
    hz = STREAM_HZ if is_on else 0
    return mavlink.MAVLink_request_data_stream_message(system, AUTOPILOT, mavlink.MAV_DATA_STREAM_ALL, hz, int(is_on))


def onboard_info_requests(system: int) -> list[Message]:
    """Return requests for messages that are needed once."""
    return [_command(system, mavlink.MAV_CMD_REQUEST_MESSAGE, number) for number in ONCE]


def position_request(system: int) -> Message:
    """Return a request for the position, which some vehicles only send on request."""
    return _command(system, mavlink.MAV_CMD_REQUEST_MESSAGE, mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT)


def limit_requests(system: int) -> list[Message]:
    """Return requests for the parameters that limit legs."""
    return [mavlink.MAVLink_param_request_read_message(system, AUTOPILOT, name.encode(), BY_NAME) for name in PARAMETERS]


def _command(system: int, command: int, one: float, two: float = 0.0) -> Message:
    return mavlink.MAVLink_command_long_message(system, AUTOPILOT, command, 0, float(one), two, 0, 0, 0, 0, 0)
