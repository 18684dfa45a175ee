"""State of a UAV as MAVLink messages."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message
from simulation.flight.states import Landed, MissionItemState, SimulatedState
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot

E7 = 1e7
UNKNOWN_U16 = 65_535
UNKNOWN_I16 = 32_767
UNTOLD_THROTTLE = 0
UNKNOWN_RATE = math.nan
FIRST_GIMBAL = 1  # gimbal_device_id of one that has no component of its own
LEVEL_FLAGS = mavlink.GIMBAL_DEVICE_FLAGS_ROLL_LOCK | mavlink.GIMBAL_DEVICE_FLAGS_PITCH_LOCK
UNTOLD_MAH = -1
METRES_PER_DEGREE = 111_195.0  # of a sphere, for LOCAL_POSITION_NED
J_PER_WH, HECTOJOULE = 3_600.0, 100.0
GPS = mavlink.MAV_SYS_STATUS_SENSOR_GPS
READY = mavlink.MAV_SYS_STATUS_PREARM_CHECK
GEOFENCE = mavlink.MAV_SYS_STATUS_GEOFENCE
SENSORS = (
    mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL | mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG
    | mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE | GPS | mavlink.MAV_SYS_STATUS_SENSOR_ANGULAR_RATE_CONTROL
    | mavlink.MAV_SYS_STATUS_SENSOR_ATTITUDE_STABILIZATION | mavlink.MAV_SYS_STATUS_SENSOR_YAW_POSITION
    | mavlink.MAV_SYS_STATUS_SENSOR_Z_ALTITUDE_CONTROL | mavlink.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
    | mavlink.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS | GEOFENCE | mavlink.MAV_SYS_STATUS_AHRS | mavlink.MAV_SYS_STATUS_SENSOR_BATTERY | READY
)  # fmt: skip
LANDED = {
    Landed.ON_GROUND: mavlink.MAV_LANDED_STATE_ON_GROUND, Landed.TAKING_OFF: mavlink.MAV_LANDED_STATE_TAKEOFF,
    Landed.IN_AIR: mavlink.MAV_LANDED_STATE_IN_AIR, Landed.LANDING: mavlink.MAV_LANDED_STATE_LANDING,
}  # fmt: skip
MISSION_STATES = {
    MissionItemState.NONE: mavlink.MISSION_STATE_NO_MISSION, MissionItemState.NOT_STARTED: mavlink.MISSION_STATE_NOT_STARTED,
    MissionItemState.ACTIVE: mavlink.MISSION_STATE_ACTIVE, MissionItemState.PAUSED: mavlink.MISSION_STATE_PAUSED,
    MissionItemState.COMPLETE: mavlink.MISSION_STATE_COMPLETE,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class SimulatedReport:
    """Input of messages: the UAV's state, and values of the endpoint.

    `current_item` and `item_count` are as the autopilot counts; `unix_s` is the vehicle's time of day.
    """

    state: SimulatedState
    autopilot_type: SimulatedAutopilot
    custom_mode: int
    current_item: int
    item_count: int
    unix_s: float
    is_fence_broken: bool = False

    @property
    def boot_ms(self) -> int:
        return int(self.state.at_s * 1_000) & 0xFFFFFFFF


def heartbeat(report: SimulatedReport) -> Message:
    state = report.state
    mode = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_AUTO_ENABLED | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
    mode |= mavlink.MAV_MODE_FLAG_GUIDED_ENABLED | (mavlink.MAV_MODE_FLAG_SAFETY_ARMED if state.is_armed else 0)
    status = mavlink.MAV_STATE_STANDBY
    if state.is_crashed:
        status = mavlink.MAV_STATE_EMERGENCY
    elif state.is_armed and (state.is_in_air or report.autopilot_type is SimulatedAutopilot.PX4):  # in ArduPilot it shows whether it flies
        status = mavlink.MAV_STATE_ACTIVE
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR, report.autopilot_type.autopilot, mode, report.custom_mode, status, 3
    )


def system_status(report: SimulatedReport) -> Message:
    state = report.state
    health = SENSORS
    if state.gps.fix < mavlink.GPS_FIX_TYPE_3D_FIX:
        health &= ~(GPS | READY)
    if state.is_crashed:
        health &= ~(READY | mavlink.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS)
    if report.is_fence_broken:
        health &= ~GEOFENCE
    voltage_mv, current_ca = _whole(state.battery_v * 1_000, 0, UNKNOWN_U16 - 1), _whole(state.battery_a * 100, 0, UNKNOWN_I16)
    percent = _whole(state.battery_percent, 0, 100)
    return mavlink.MAVLink_sys_status_message(SENSORS, SENSORS, health, 300, voltage_mv, current_ca, percent, 0, 0, 0, 0, 0, 0)


def battery(report: SimulatedReport) -> Message:
    state = report.state
    current_ca = _whole(state.battery_a * 100, 0, UNKNOWN_I16)
    voltages = [_whole(state.battery_v * 1_000, 0, UNKNOWN_U16 - 1), *[UNKNOWN_U16] * 9]
    return mavlink.MAVLink_battery_status_message(
        0, mavlink.MAV_BATTERY_FUNCTION_ALL, mavlink.MAV_BATTERY_TYPE_LIPO, UNKNOWN_I16, voltages, current_ca,
        UNTOLD_MAH, _whole(state.battery_used_wh * J_PER_WH / HECTOJOULE, 0, 2**31 - 1), _whole(state.battery_percent, 0, 100),
    )  # fmt: skip


def position(report: SimulatedReport) -> Message:
    state = report.state
    velocity_cms = (_whole(value * 100, -UNKNOWN_I16, UNKNOWN_I16) for value in state.velocity_ned_mps)
    return mavlink.MAVLink_global_position_int_message(
        report.boot_ms, round(state.position.lat * E7), round(state.position.lon * E7), _millimetres(state.altitude_amsl_m),
        _millimetres(state.altitude_relative_m), *velocity_cms, _whole(state.heading_deg * 100, 0, 36_000) % 36_000,
    )  # fmt: skip


def attitude(report: SimulatedReport) -> Message:
    angles = _attitude_rad(report.state)
    return mavlink.MAVLink_attitude_message(report.boot_ms, *angles, *_rates_rad(report.state))


def quaternion(roll_rad: float, pitch_rad: float, yaw_rad: float) -> list[float]:
    """Return w, x, y, z of angles that are turned in the order yaw, pitch, roll."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle / 2), math.cos(angle / 2)) for angle in (roll_rad, pitch_rad, yaw_rad))
    return [cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy]


def attitude_quaternion(report: SimulatedReport) -> Message:
    return mavlink.MAVLink_attitude_quaternion_message(report.boot_ms, *quaternion(*_attitude_rad(report.state)), *_rates_rad(report.state))


def gimbal_attitude(report: SimulatedReport) -> Message:
    """Return the gimbal's attitude: on PX4 that of a component with its yaw from north, on ArduPilot with its yaw from the nose."""
    state, gimbal = report.state, report.state.gimbal
    is_px4 = report.autopilot_type is SimulatedAutopilot.PX4
    frame = mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_EARTH_FRAME if is_px4 else mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_VEHICLE_FRAME
    locked = mavlink.GIMBAL_DEVICE_FLAGS_YAW_LOCK if gimbal.is_locked else 0
    heading_rad = _attitude_rad(state)[2]
    yaw_rad = math.radians(gimbal.yaw_deg) + (heading_rad if is_px4 else 0.0)
    return mavlink.MAVLink_gimbal_device_attitude_status_message(
        0, 0, report.boot_ms, LEVEL_FLAGS | frame | locked, quaternion(0.0, math.radians(gimbal.pitch_deg), yaw_rad),
        UNKNOWN_RATE, UNKNOWN_RATE, UNKNOWN_RATE, 0, heading_rad if is_px4 else UNKNOWN_RATE, UNKNOWN_RATE, 0 if is_px4 else FIRST_GIMBAL,
    )  # fmt: skip


def local_position(report: SimulatedReport) -> Message:
    """Return the position relative to home, north, east and down."""
    state = report.state
    north_m = (state.position.lat - state.home.lat) * METRES_PER_DEGREE
    east_m = (state.position.lon - state.home.lon) * METRES_PER_DEGREE * math.cos(math.radians(state.home.lat))
    return mavlink.MAVLink_local_position_ned_message(report.boot_ms, north_m, east_m, -state.altitude_relative_m, *state.velocity_ned_mps)


def hud(report: SimulatedReport) -> Message:
    state = report.state
    climb_mps = -state.velocity_ned_mps[2]
    heading_deg = _whole(state.heading_deg, 0, 360) % 360
    return mavlink.MAVLink_vfr_hud_message(
        state.airspeed_mps, state.ground_speed_mps, heading_deg, UNTOLD_THROTTLE, state.altitude_amsl_m, climb_mps
    )


def gps(report: SimulatedReport) -> Message:
    state = report.state
    north_mps, east_mps, _ = state.velocity_ned_mps
    course_cdeg = round(math.degrees(math.atan2(east_mps, north_mps)) * 100) % 36_000
    hdop = _whole(state.gps.hdop * 100, 0, UNKNOWN_U16 - 1) if math.isfinite(state.gps.hdop) else UNKNOWN_U16
    return mavlink.MAVLink_gps_raw_int_message(
        int(state.at_s * 1e6), state.gps.fix, round(state.position.lat * E7), round(state.position.lon * E7),
        _millimetres(state.altitude_amsl_m), hdop, UNKNOWN_U16, _whole(state.ground_speed_mps * 100, 0, UNKNOWN_U16 - 1), course_cdeg,
        min(state.gps.satellites, 254),
    )  # fmt: skip


def landed(report: SimulatedReport) -> Message:
    return mavlink.MAVLink_extended_sys_state_message(mavlink.MAV_VTOL_STATE_UNDEFINED, LANDED[report.state.landed])


def mission_current(report: SimulatedReport) -> Message:
    """Return the present item. The total excludes ArduPilot's home, as its autopilot counts here."""
    return mavlink.MAVLink_mission_current_message(report.current_item, report.item_count, MISSION_STATES[report.state.mission_state])


def system_time(report: SimulatedReport) -> Message:
    return mavlink.MAVLink_system_time_message(max(int(report.unix_s * 1e6), 0), report.boot_ms)


def home(report: SimulatedReport) -> Message:
    state = report.state
    return mavlink.MAVLink_home_position_message(
        round(state.home.lat * E7), round(state.home.lon * E7), _millimetres(state.home_amsl_m), 0, 0, 0, [1, 0, 0, 0], 0, 0, 0
    )


def origin(report: SimulatedReport) -> Message:
    state = report.state
    return mavlink.MAVLink_gps_global_origin_message(
        round(state.home.lat * E7), round(state.home.lon * E7), _millimetres(state.home_amsl_m), int(state.at_s * 1e6)
    )


def wind(report: SimulatedReport) -> Message:
    """Return ArduPilot's wind, which names where it blows from."""
    north_mps, east_mps, down_mps = report.state.wind_ned_mps
    from_deg = math.degrees(math.atan2(-east_mps, -north_mps)) % 360
    return mavlink.MAVLink_wind_message(from_deg, math.hypot(north_mps, east_mps), down_mps)


def wind_estimate(report: SimulatedReport) -> Message:
    """Return PX4's wind, which names where the air moves to."""
    state = report.state
    return mavlink.MAVLink_wind_cov_message(int(state.at_s * 1e6), *state.wind_ned_mps, 0.0, 0.0, state.altitude_amsl_m, 0.5, 0.5)


REPORTS: dict[int, Callable[[SimulatedReport], Message]] = {
    mavlink.MAVLINK_MSG_ID_HEARTBEAT: heartbeat,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: system_status,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: battery,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: position,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: attitude,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: attitude_quaternion,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: local_position,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: hud,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: gps,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: landed,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: mission_current,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: system_time,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: home,
    mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: origin,
    mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS: gimbal_attitude,
    mavlink.MAVLINK_MSG_ID_WIND: wind,
    mavlink.MAVLINK_MSG_ID_WIND_COV: wind_estimate,
}


def _attitude_rad(state: SimulatedState) -> tuple[float, float, float]:
    yaw_deg = (state.heading_deg + 180) % 360 - 180
    return (math.radians(state.roll_deg), math.radians(state.pitch_deg), math.radians(yaw_deg))


def _rates_rad(state: SimulatedState) -> tuple[float, float, float]:
    return (math.radians(state.roll_rate_dps), math.radians(state.pitch_rate_dps), math.radians(state.yaw_rate_dps))


def _whole(value: float, lowest: int, highest: int) -> int:
    return max(lowest, min(highest, round(value)))


def _millimetres(height_m: float) -> int:
    return _whole(height_m * 1_000, -(2**31), 2**31 - 1)
