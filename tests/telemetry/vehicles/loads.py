"""Loads for transfers, and vehicle states to begin from."""

import math
from collections.abc import Sequence

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing
from mavlink.vehicle_plan import FlightLoad, MissionItem
from mavlink.vehicle_state import VehicleState
from tests.telemetry.vehicles.ardupilot import ArduPilot
from tests.telemetry.vehicles.px4 import Px4
from tests.telemetry.vehicles.vehicle import Vehicle

RELATIVE, PLACELESS = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, mavlink.MAV_FRAME_MISSION
AUTOPILOT_TYPES = {"px4": Px4, "ardupilot": ArduPilot}
ADDRESSING = Addressing(7)


def waypoint(number: int, *, altitude_m: float = 60.0, hold_s: float = 0.0, east: int = 0) -> MissionItem:
    return MissionItem(
        mavlink.MAV_CMD_NAV_WAYPOINT,
        RELATIVE,
        (hold_s, 0.0, 0.0, math.nan),
        98_000_000 + 1_000 * number + east,
        554_000_000 + 777 * number,
        altitude_m,
    )


def mission(items: int, *, east: int = 0) -> tuple[MissionItem, ...]:
    """A take-off, waypoints with a speed and a photo among them, and a return: so many items in all."""
    first = waypoint(0, east=east)
    take_off = MissionItem(mavlink.MAV_CMD_NAV_TAKEOFF, RELATIVE, (0.0, 0.0, 0.0, math.nan), first.longitude_e7, first.latitude_e7, 60.0)
    home = MissionItem(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH, PLACELESS, (0.0, 0.0, 0.0, 0.0))
    between = []
    for number in range(1, items - 1):
        if number % 10 == 5:
            between.append(MissionItem(mavlink.MAV_CMD_DO_CHANGE_SPEED, PLACELESS, (1.0, 5.3 + number / 100, -1.0, 0.0)))
        elif number % 10 == 7:
            between.append(MissionItem(mavlink.MAV_CMD_IMAGE_START_CAPTURE, PLACELESS, (0.0, 2.0, 4.0, 0.0)))
        else:
            between.append(waypoint(number, altitude_m=60.0 + 0.37 * number, hold_s=float(number % 4), east=east))
    return (take_off, *between, home)


def polygon(east: int, vertices: int = 4) -> tuple[MissionItem, ...]:
    return tuple(
        MissionItem(
            mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION,
            mavlink.MAV_FRAME_GLOBAL,
            (float(vertices), 0.0, 0.0, 0.0),
            98_100_000 + east + 1_000 * number,
            554_100_000 + 500 * number**2,
        )
        for number in range(vertices)
    )


def rally(count: int = 2) -> tuple[MissionItem, ...]:
    return tuple(
        MissionItem(mavlink.MAV_CMD_NAV_RALLY_POINT, RELATIVE, (0.0, 0.0, 0.0, 0.0), 98_000_000 + number, 554_000_000, 40.0)
        for number in range(count)
    )


def load(items: int = 7, *, east: int = 0, fence: Sequence[MissionItem] = (), rally: Sequence[MissionItem] = ()) -> FlightLoad:
    return FlightLoad(mission(items, east=east), tuple(fence), tuple(rally))


def known(vehicle: Vehicle, at_s: float = 0.0) -> VehicleState:
    """What a ground station knows of a vehicle from one report."""
    state = VehicleState(vehicle.system)
    frames = mavlink.MAVLink(None, srcSystem=vehicle.system, srcComponent=1)
    for message in vehicle.reports():
        state.receive(mavlink.MAVLink(None).parse_char(message.pack(frames)), at_s)
    return state
