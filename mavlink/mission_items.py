"""Converts an approved route to the mission items of its flights.

The items use only what both autopilots store. ArduPilot truncates a waypoint's hold to whole seconds, so it is rounded up, and an altitude
to centimetres, so it is sent in centimetres. It discards a waypoint's radius and yaw, so they are left to the autopilot, but for the radius
beside wires, of which ArduPilot is sent none (see supported_items). Items without a position use the frame MISSION, the only one that PX4
accepts for them.

Photos with a view are aimed by a region of interest, before the waypoint so that the UAV turns on its way. None looks straight down (see
planning/views/detail_views.py): the bearing of a place under the UAV is noise, and the nose of one without a panning gimbal follows it.
Where a gimbal pans, but not all around, ArduPilot does not turn the nose for a region of interest: CONDITION_YAW does, which PX4 knows in
no mission and does not need (see supported_items).
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import HOVER, Flight, FrozenRoute, FrozenWaypoint, photo_clearances_m
from mavlink.mission_sync.supported_items import PHOTO_RADIUS_M
from mavlink.vehicle_plan import FlightLoad, MissionItem
from planning.task import Task, TaskKind, View

RELATIVE = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
NO_PLACE = mavlink.MAV_FRAME_MISSION
E7 = 1e7
GROUND_SPEED, NO_THROTTLE = 1.0, -1.0  # of DO_CHANGE_SPEED
NOT_BY_THE_CLOCK = -1.0  # of NAV_DELAY: no hour, minute and second


class CannotBeFlown(ValueError):
    """A plain autopilot cannot fly this route. `code` is the machine-readable reason."""

    def __init__(self, code: str, words: str) -> None:
        super().__init__(words)
        self.code = code


@dataclass(frozen=True)
class ItemRules:
    """How tasks become items. The first photo is taken after hovering for `settle_s`, further ones every `photo_interval_s`.

    A photo with a view is alone; the UAV stays photo_s for it.
    """

    settle_s: float = 2.0
    photo_interval_s: float = 2.0
    photo_s: float = 1.0
    speed_step_mps: float = 0.01  # smaller differences count as the same speed


def flight_loads(
    route: FrozenRoute,
    *,
    fence: tuple[MissionItem, ...] = (),
    rally: tuple[MissionItem, ...] = (),
    rules: ItemRules | None = None,
) -> tuple[FlightLoad, ...]:
    """Return one load for each of `route.flights`, in order. All share the fence and the rally points. Raises CannotBeFlown.

    Rally heights are given above the route's first take-off and sent above that of each flight, as an autopilot measures from its home.

    Each flight consists of the take-off, its waypoints with speeds and tasks, and its end. The RTL path is among the waypoints, so a flight
    that returns lands under the last one: an autopilot's own RTL would climb to its own height and fly straight, over wires and through
    zones. Hovering needs no item: both autopilots hover after the last waypoint.

    A route that begins in the air has no take-off. It may begin at any waypoint up to `begun_by`, so the speed is repeated after each of
    these.
    """
    if route.charging_stops:
        raise CannotBeFlown("charging", "The route charges at towers on its way, which a plain autopilot cannot do.")
    rules = rules or ItemRules()
    return tuple(FlightLoad(tuple(_items(flight, route, rules)), fence=fence, rally=_rally_of(flight, rally)) for flight in route.flights)


def _rally_of(flight: Flight, rally: tuple[MissionItem, ...]) -> tuple[MissionItem, ...]:
    """Return the rally points in whole metres, as ArduPilot stores them, rounded up."""
    heights_m = [float(math.ceil(item.altitude_m - flight.above_first_m)) for item in rally]
    if any(height_m <= 0 for height_m in heights_m):
        raise CannotBeFlown("rally-height", "A rally point is not above the take-off of one of the flights.")
    return tuple(replace(item, altitude_m=height_m) for item, height_m in zip(rally, heights_m, strict=True))


def _items(flight: Flight, route: FrozenRoute, rules: ItemRules) -> Iterator[MissionItem]:
    first, last = flight.waypoints[0], flight.waypoints[-1]
    begun_by = -1 if route.begun_by is None else route.begun_by
    if first.altitude_relative_m <= 0:
        raise CannotBeFlown("take-off-height", "The route's first waypoint is not above its take-off.")
    if route.begun_by is None:
        yield _at(mavlink.MAV_CMD_NAV_TAKEOFF, first, (0.0, 0.0, 0.0, math.nan))
    flown_mps, photos, beside_wires = 0.0, 0, photo_clearances_m(flight.waypoints)
    for place, waypoint in enumerate(flight.waypoints):
        wanted_mps = route.cruise_speed_mps if waypoint.speed_mps is None else waypoint.speed_mps
        if waypoint.sequence <= begun_by + 1 or abs(wanted_mps - flown_mps) > rules.speed_step_mps:
            yield _plain(mavlink.MAV_CMD_DO_CHANGE_SPEED, (GROUND_SPEED, wanted_mps, NO_THROTTLE, 0.0), waypoint)
            flown_mps = wanted_mps
        follows = flight.waypoints[place + 1] if place + 1 < len(flight.waypoints) else None
        if waypoint.task is not None and waypoint.task.view is not None:
            photos += 1
            yield from _aimed_photo(waypoint, waypoint.task, waypoint.task.view, photos, rules)
            if follows is None or not _is_photographed(flight, waypoint.target, place + 1):
                yield _plain(mavlink.MAV_CMD_DO_SET_ROI_NONE, (0.0, 0.0, 0.0, 0.0), waypoint)
            continue
        if waypoint.sequence in beside_wires:
            yield _hold_at(waypoint, 0.0 if waypoint.task is None else waypoint.task.hold_s, PHOTO_RADIUS_M)
            continue
        yield from _waypoint(waypoint, waypoint.task, is_stretch=_same_target(waypoint, follows), rules=rules)
    if flight.end_action != HOVER:
        yield _item(mavlink.MAV_CMD_NAV_LAND, last, (0.0, 0.0, 0.0, math.nan), last.ground_relative_m)


def _waypoint(waypoint: FrozenWaypoint, task: Task | None, *, is_stretch: bool, rules: ItemRules) -> Iterator[MissionItem]:
    if task is None:
        yield _hold_at(waypoint, 0.0)
    elif task.kind is TaskKind.PHOTO:
        settle_s = min(rules.settle_s, task.hold_s)
        rest_s = float(math.ceil(task.hold_s - settle_s))
        photos = max(1, math.floor(rest_s / rules.photo_interval_s))
        yield _hold_at(waypoint, settle_s)
        yield _plain(mavlink.MAV_CMD_IMAGE_START_CAPTURE, (0.0, 0.0 if photos == 1 else rules.photo_interval_s, photos, 0.0), waypoint)
        if rest_s:
            yield _plain(mavlink.MAV_CMD_NAV_DELAY, (rest_s, NOT_BY_THE_CLOCK, NOT_BY_THE_CLOCK, NOT_BY_THE_CLOCK), waypoint)
    elif task.kind is TaskKind.LOOK and not is_stretch:
        yield _item(mavlink.MAV_CMD_DO_SET_ROI_LOCATION, waypoint, (0.0, 0.0, 0.0, 0.0), waypoint.ground_relative_m)
        yield _hold_at(waypoint, task.hold_s)
        yield _plain(mavlink.MAV_CMD_DO_SET_ROI_NONE, (0.0, 0.0, 0.0, 0.0), waypoint)
    else:  # hovering, or a stretch: there the camera points along the flight direction
        yield _hold_at(waypoint, task.hold_s)


def _aimed_photo(waypoint: FrozenWaypoint, task: Task, view: View, number: int, rules: ItemRules) -> Iterator[MissionItem]:
    """One photo; `number` counts those of the flight from 1, so that a repeated item takes no second one."""
    place, height_m = aim_point(waypoint, view)
    yield _item(mavlink.MAV_CMD_DO_SET_ROI_LOCATION, replace(waypoint, position=place), (0.0, 0.0, 0.0, 0.0), height_m)
    stays_s = max(task.hold_s - rules.photo_s, 1.0)  # it stops: photos are bends of the flight
    if view.heading_deg is None:
        yield _hold_at(waypoint, stays_s, PHOTO_RADIUS_M)
    else:
        yield _hold_at(waypoint, 1.0, PHOTO_RADIUS_M)  # stopped: the next item turns the nose, which setting out to a waypoint would undo
        yield _plain(mavlink.MAV_CMD_CONDITION_YAW, (view.heading_deg, 0.0, 0.0, 0.0), waypoint)
        yield _delay(waypoint, stays_s - 1.0)
    yield _plain(mavlink.MAV_CMD_IMAGE_START_CAPTURE, (0.0, 0.0, 1.0, float(number)), waypoint)
    yield _delay(waypoint, rules.photo_s)  # the photo is taken before the UAV sets out


def _delay(waypoint: FrozenWaypoint, seconds: float) -> MissionItem:
    whole_s = max(float(math.ceil(seconds)), 1.0)
    return _plain(mavlink.MAV_CMD_NAV_DELAY, (whole_s, NOT_BY_THE_CLOCK, NOT_BY_THE_CLOCK, NOT_BY_THE_CLOCK), waypoint)


def aim_point(waypoint: FrozenWaypoint, view: View) -> tuple[LonLat, float]:
    """Return where a photo's optical axis meets what it shows, and the height of that above the take-off [m]."""
    yaw, pitch = math.radians(view.yaw_deg), math.radians(view.pitch_deg)
    across_m = view.distance_m * math.cos(pitch)
    frame = LocalFrame.around(*waypoint.position)
    lon, lat = frame.to_degrees(np.array([[across_m * math.sin(yaw), across_m * math.cos(yaw)]]))[0].tolist()
    return LonLat(lon, lat), waypoint.altitude_relative_m + view.distance_m * math.sin(pitch)


def _is_photographed(flight: Flight, target: int | None, begin: int) -> bool:
    """Whether a later waypoint, from this place on, has a photo of the same target."""
    return any(own.target == target and own.task is not None and own.task.view is not None for own in flight.waypoints[begin:])


def _same_target(waypoint: FrozenWaypoint, follows: FrozenWaypoint | None) -> bool:
    return follows is not None and waypoint.target is not None and follows.target == waypoint.target


def _hold_at(waypoint: FrozenWaypoint, hold_s: float, radius_m: float = 0.0) -> MissionItem:
    """radius_m: within which it counts as reached; 0: by the autopilot's setting."""
    return _at(mavlink.MAV_CMD_NAV_WAYPOINT, waypoint, (float(math.ceil(hold_s)), radius_m, 0.0, math.nan))


def _at(command: int, waypoint: FrozenWaypoint, parameters: tuple[float, float, float, float]) -> MissionItem:
    return _item(command, waypoint, parameters, waypoint.altitude_relative_m)


def _item(command: int, waypoint: FrozenWaypoint, parameters: tuple[float, float, float, float], altitude_relative_m: float) -> MissionItem:
    longitude_e7, latitude_e7 = position_e7(waypoint.position)
    altitude_m = round(altitude_relative_m, 2) + 0.0  # turns -0.0 into 0.0
    return MissionItem(command, RELATIVE, parameters, longitude_e7, latitude_e7, altitude_m, waypoint.sequence)


def _plain(command: int, parameters: tuple[float, float, float, float], waypoint: FrozenWaypoint) -> MissionItem:
    return MissionItem(command, NO_PLACE, parameters, waypoint=waypoint.sequence)


def position_e7(position: LonLat) -> tuple[int, int]:
    return round(position.lon * E7), round(position.lat * E7)
