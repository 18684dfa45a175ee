"""Mission items as orders that can be flown, parsed when a list is loaded."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from pymavlink.dialects.v20 import common as mavlink

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem

E7 = 1e7
MAX_ITEMS = 10_000
MAX_HEIGHT_M, MAX_SPEED_MPS, MAX_DURATION_S = 10_000.0, 100.0, 86_400.0
USUAL_CIRCLE_M = 10.0  # ArduCopter, CIRCLE_RADIUS
MAX_CIRCLE_M, MAX_TURNS = 5_000.0, 100.0
_AMSL = {mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT}
_RELATIVE = {mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT}
_TERRAIN = {mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT, mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT}


class Above(StrEnum):
    """Reference of a height."""

    SEA = "sea"
    HOME = "home"
    GROUND = "ground"


@dataclass(frozen=True, slots=True)
class OrderPlace:
    """A place. `position` None: the UAV's position; `height_m` None: its height."""

    position: LonLat | None
    height_m: float | None
    above: Above


@dataclass(frozen=True, slots=True)
class TakeOffOrder:
    place: OrderPlace


@dataclass(frozen=True, slots=True)
class FlyTo:
    """`hold_s` is the hold there, inf: for good; `radius_m` 0: by the settings; `heading_deg` None: along the course."""

    place: OrderPlace
    hold_s: float
    radius_m: float = 0.0
    heading_deg: float | None = None


@dataclass(frozen=True, slots=True)
class FlyAround:
    """Turns around a place; a negative radius is counter-clockwise."""

    place: OrderPlace
    turns: float
    radius_m: float


@dataclass(frozen=True, slots=True)
class LandAt:
    place: OrderPlace


@dataclass(frozen=True, slots=True)
class ReturnHome:
    pass


@dataclass(frozen=True, slots=True)
class Wait:
    seconds: float


@dataclass(frozen=True, slots=True)
class SetSpeed:
    speed_mps: float


@dataclass(frozen=True, slots=True)
class LookAt:
    """Look at a place; None: along the course again."""

    place: OrderPlace | None


@dataclass(frozen=True, slots=True)
class PointCamera:
    """Turn the gimbal; None: keep the angle. `is_from_north`: the yaw is from true north, else from the nose.

    `turns_uav`: where the gimbal has no yaw, the UAV turns to this heading, as ArduCopter does for DO_MOUNT_CONTROL.
    """

    pitch_deg: float | None
    yaw_deg: float | None
    is_from_north: bool = False
    turns_uav: bool = False


@dataclass(frozen=True, slots=True)
class Turn:
    """Turn to a heading, or by an angle."""

    angle_deg: float
    is_relative: bool


@dataclass(frozen=True, slots=True)
class TakePhotos:
    """`count` 0: until stopped; by time if `interval_s` is positive, by distance if `distance_m` is. `sequence` numbers a single photo."""

    count: int
    interval_s: float = 0.0
    distance_m: float = 0.0
    sequence: int | None = None


@dataclass(frozen=True, slots=True)
class StopPhotos:
    pass


@dataclass(frozen=True, slots=True)
class Jump:
    """Jump to the item with this index, `times` times; -1: for ever."""

    index: int
    times: int


@dataclass(frozen=True, slots=True)
class Nothing:
    """An item that is accepted without effect: servos, markers."""


Order = (
    TakeOffOrder
    | FlyTo
    | FlyAround
    | LandAt
    | ReturnHome
    | Wait
    | SetSpeed
    | LookAt
    | PointCamera
    | Turn
    | TakePhotos
    | StopPhotos
    | Jump
    | Nothing
)
NOTHING = Nothing()
CENTRE = PointCamera(0.0, 0.0)


class CannotFly(ValueError):
    """An item that cannot be flown. `index` is its place in the list, `parameter` its field from 1 to 7; 0: its command."""

    def __init__(self, index: int, code: str, words: str, parameter: int = 0) -> None:
        super().__init__(f"Item {index}: {words}")
        self.index, self.code, self.parameter = index, code, parameter


_IGNORED = frozenset(
    {
        mavlink.MAV_CMD_DO_SET_HOME,
        mavlink.MAV_CMD_DO_SET_SERVO,
        mavlink.MAV_CMD_DO_SET_RELAY,
        mavlink.MAV_CMD_DO_REPEAT_SERVO,
        mavlink.MAV_CMD_DO_LAND_START,
        mavlink.MAV_CMD_DO_GRIPPER,
        mavlink.MAV_CMD_DO_MOUNT_CONFIGURE,
        mavlink.MAV_CMD_DO_DIGICAM_CONFIGURE,
        mavlink.MAV_CMD_DO_FENCE_ENABLE,
        mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE,
        mavlink.MAV_CMD_SET_CAMERA_MODE,
        mavlink.MAV_CMD_SET_CAMERA_ZOOM,
        mavlink.MAV_CMD_SET_CAMERA_FOCUS,
        mavlink.MAV_CMD_VIDEO_START_CAPTURE,
        mavlink.MAV_CMD_VIDEO_STOP_CAPTURE,
        mavlink.MAV_CMD_CONDITION_DELAY,
        mavlink.MAV_CMD_CONDITION_DISTANCE,
        mavlink.MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL,
        mavlink.MAV_CMD_DO_AUTOTUNE_ENABLE,
        mavlink.MAV_CMD_DO_ENGINE_CONTROL,
    }
)


def orders(items: Sequence[MissionItem], *, is_home_first: bool) -> tuple[Order, ...]:
    """Return one order for each item. `is_home_first`: item 0 is home and not flown, as on ArduPilot. Raises CannotFly."""
    if len(items) > MAX_ITEMS:
        raise CannotFly(MAX_ITEMS, "too-many", f"{len(items)} items; at most {MAX_ITEMS} are kept.")
    read = tuple(NOTHING if is_home_first and index == 0 else _order(index, item) for index, item in enumerate(items))
    for index, order in enumerate(read):
        if isinstance(order, Jump) and not 0 <= order.index < len(read):
            raise CannotFly(index, "invalid", f"jumps to item {order.index}, which there is not.", 1)
    return read


def _order(index: int, item: MissionItem) -> Order:
    command = item.command
    one, two, three, four = item.parameters
    if command == mavlink.MAV_CMD_NAV_TAKEOFF:
        return TakeOffOrder(_place(index, item))
    if command in (mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT):
        return FlyTo(_place(index, item), _seconds(index, one, 1), _positive(index, two, 2), _heading(index, four))
    if command == mavlink.MAV_CMD_NAV_LOITER_TIME:
        return FlyTo(_place(index, item), _seconds(index, one, 1))
    if command == mavlink.MAV_CMD_NAV_LOITER_TURNS:
        turns, radius_m = 1.0 if math.isnan(one) else one, USUAL_CIRCLE_M if math.isnan(three) or three == 0.0 else three
        return FlyAround(
            _place(index, item), _within(index, turns, 0.0, MAX_TURNS, 1), _within(index, radius_m, -MAX_CIRCLE_M, MAX_CIRCLE_M, 3)
        )
    if command in (mavlink.MAV_CMD_NAV_LOITER_UNLIM, mavlink.MAV_CMD_NAV_LOITER_TO_ALT):
        return FlyTo(_place(index, item), math.inf if command == mavlink.MAV_CMD_NAV_LOITER_UNLIM else 0.0)
    if command == mavlink.MAV_CMD_NAV_LAND:
        return LandAt(_place(index, item))
    if command == mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH:
        return ReturnHome()
    if command == mavlink.MAV_CMD_NAV_DELAY:
        return Wait(_seconds(index, one, 1))
    if command == mavlink.MAV_CMD_DO_CHANGE_SPEED:
        return NOTHING if math.isnan(two) or two < 0.0 else SetSpeed(_within(index, two, 0.1, MAX_SPEED_MPS, 2))
    if command in (mavlink.MAV_CMD_DO_SET_ROI_LOCATION, mavlink.MAV_CMD_DO_SET_ROI):
        is_end = command == mavlink.MAV_CMD_DO_SET_ROI and not (item.longitude_e7 or item.latitude_e7 or item.altitude_m)
        return LookAt(None if is_end else _place(index, item))
    if command == mavlink.MAV_CMD_DO_SET_ROI_NONE:
        return LookAt(None)
    if command == mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW:
        return _gimbal_angles(index, item)
    if command == mavlink.MAV_CMD_DO_MOUNT_CONTROL:
        return _mount(index, item)
    if command == mavlink.MAV_CMD_CONDITION_YAW:
        angle_deg = _within(index, one, -360.0, 360.0, 1)
        return Turn(angle_deg * (-1.0 if four > 0.0 and three < 0.0 else 1.0), is_relative=four > 0.0)
    if command == mavlink.MAV_CMD_IMAGE_START_CAPTURE:
        count = 1 if math.isnan(three) else int(_within(index, three, 0.0, 1e6, 3))
        is_numbered = count == 1 and four >= 1.0  # false for NaN, too
        return TakePhotos(
            count, interval_s=_seconds(index, two, 2), sequence=int(_within(index, four, 1.0, 2**31, 4)) if is_numbered else None
        )
    if command == mavlink.MAV_CMD_IMAGE_STOP_CAPTURE:
        return StopPhotos()
    if command == mavlink.MAV_CMD_DO_DIGICAM_CONTROL:
        return TakePhotos(1)
    if command == mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST:
        distance_m = _positive(index, one, 1)
        return TakePhotos(0, distance_m=distance_m) if distance_m > 0.0 else StopPhotos()
    if command == mavlink.MAV_CMD_DO_JUMP:
        return Jump(int(_within(index, one, 0.0, 65_535.0, 1)), int(_within(index, two, -1.0, 65_535.0, 2)))
    if command in _IGNORED:
        return NOTHING
    raise CannotFly(index, "unsupported", f"command {command} is not known to this UAV.")


def _gimbal_angles(index: int, item: MissionItem) -> Order:
    """Return the order of DO_GIMBAL_MANAGER_PITCHYAW; parameter 5, in place of a latitude, holds its flags."""
    pitch_deg, yaw_deg, flags = item.parameters[0], item.parameters[1], item.latitude_e7
    if flags & (mavlink.GIMBAL_MANAGER_FLAGS_NEUTRAL | mavlink.GIMBAL_MANAGER_FLAGS_RETRACT):
        return CENTRE
    named = flags & (mavlink.GIMBAL_MANAGER_FLAGS_YAW_IN_EARTH_FRAME | mavlink.GIMBAL_MANAGER_FLAGS_YAW_IN_VEHICLE_FRAME)
    from_north = mavlink.GIMBAL_MANAGER_FLAGS_YAW_IN_EARTH_FRAME if named else mavlink.GIMBAL_MANAGER_FLAGS_YAW_LOCK
    return PointCamera(_angle(index, pitch_deg, 180.0, 1), _angle(index, yaw_deg, 720.0, 2), is_from_north=bool(flags & from_north))


def _mount(index: int, item: MissionItem) -> Order:
    """Return the order of DO_MOUNT_CONTROL: its mode is parameter 7. As a mission item ArduPilot keeps the angles alone."""
    pitch_deg, _, yaw_deg, height_m = item.parameters
    mode = 0 if math.isnan(item.altitude_m) else int(item.altitude_m)
    if mode == mavlink.MAV_MOUNT_MODE_GPS_POINT:
        target = MissionItem(
            mavlink.MAV_CMD_DO_SET_ROI_LOCATION, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, (0.0, 0.0, 0.0, 0.0),
            item.longitude_e7, item.latitude_e7, height_m,
        )  # fmt: skip
        return LookAt(_place(index, target))
    if mode == mavlink.MAV_MOUNT_MODE_NEUTRAL or not (pitch_deg or yaw_deg or mode == mavlink.MAV_MOUNT_MODE_MAVLINK_TARGETING):
        return CENTRE
    return PointCamera(_angle(index, pitch_deg, 90.0, 1), _angle(index, yaw_deg, 360.0, 3), turns_uav=True)


def _angle(index: int, value: float, most_deg: float, parameter: int) -> float | None:
    return None if math.isnan(value) else _within(index, value, -most_deg, most_deg, parameter)


def _place(index: int, item: MissionItem) -> OrderPlace:
    lon, lat, height_m = item.longitude_e7 / E7, item.latitude_e7 / E7, item.altitude_m
    if item.frame not in _AMSL | _RELATIVE | _TERRAIN:
        raise CannotFly(index, "frame", f"a place in frame {item.frame} is not known to this UAV.")
    if not abs(lat) <= 90.0:
        raise CannotFly(index, "invalid", f"latitude {lat:g} is beyond the pole.", 5)
    if not abs(lon) <= 180.0:
        raise CannotFly(index, "invalid", f"longitude {lon:g} is beyond 180 degrees.", 6)
    if math.isinf(height_m) or abs(height_m) > MAX_HEIGHT_M:
        raise CannotFly(index, "invalid", f"a height of {height_m:g} m is beyond what is flown.", 7)
    above = Above.SEA if item.frame in _AMSL else Above.HOME if item.frame in _RELATIVE else Above.GROUND
    is_here = item.longitude_e7 == 0 and item.latitude_e7 == 0
    return OrderPlace(None if is_here else LonLat(lon, lat), None if math.isnan(height_m) else height_m, above)


def _seconds(index: int, value: float, parameter: int) -> float:
    return 0.0 if math.isnan(value) else max(_within(index, value, -1.0, MAX_DURATION_S, parameter), 0.0)


def _positive(index: int, value: float, parameter: int) -> float:
    return 0.0 if math.isnan(value) or value < 0.0 else _within(index, value, 0.0, 1e6, parameter)


def _heading(index: int, value: float) -> float | None:
    return None if math.isnan(value) else _within(index, value, -720.0, 720.0, 4) % 360.0


def _within(index: int, value: float, least: float, most: float, parameter: int) -> float:
    if not least <= value <= most:
        raise CannotFly(index, "invalid", f"parameter {parameter} is {value:g}, which is not within {least:g} to {most:g}.", parameter)
    return value
