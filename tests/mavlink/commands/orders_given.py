"""Orders that are given to scripted vehicles, over a link that may be bad."""

from collections.abc import Mapping
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.commands.actions import Order
from mavlink.commands.command import CommandEnd, CommandOutcome
from mavlink.commands.driver import CommandDriver
from mavlink.timeouts import CommandRules
from mavlink.vehicle_state import VehicleState
from tests.telemetry.vehicles import px4
from tests.telemetry.vehicles.channel import Channel, Link
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES, mission
from tests.telemetry.vehicles.vehicle import Vehicle

RULES = CommandRules()
ARM, SET_MODE, TAKEOFF = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_DO_SET_MODE, mavlink.MAV_CMD_NAV_TAKEOFF
START, SPEED = mavlink.MAV_CMD_MISSION_START, mavlink.MAV_CMD_DO_CHANGE_SPEED
SET_ITEM = mavlink.MAV_CMD_DO_SET_MISSION_CURRENT
FIRST_ITEM = {"px4": 0, "ardupilot": 1}
MODES = {"px4": {"mission": 4, "hold": 3, "return": 5, "land": 6}, "ardupilot": {"mission": 3, "hold": 17, "return": 6, "land": 9}}
PARAMETERS = {"altitude_relative_m": 12.0, "speed_mps": 4.5}


def vehicle_of(autopilot_type: str, *, mode: str = "", in_air: bool = False) -> Vehicle:
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    vehicle.heartbeats = True
    vehicle.lists[0] += mission(7)  # type: ignore[index]
    vehicle.is_armed = vehicle.is_in_air = in_air
    number = MODES[autopilot_type].get(mode, 0)
    vehicle.custom_mode = (4 << 16 | number << 24) if autopilot_type == "px4" and mode else number
    return vehicle


def mode_of(vehicle: Vehicle) -> int:
    return vehicle.custom_mode >> 24 if isinstance(vehicle, px4.Px4) else vehicle.custom_mode


def reported(
    vehicle: Vehicle, order: Order, *, link: Link | None = None, seed: int = 0, parameters: Mapping[str, float] = PARAMETERS, **more: Any
) -> tuple[CommandOutcome, Channel]:
    """With a home that is 20 m above the sea, and one report of the vehicle heard before."""
    state = VehicleState(vehicle.system)
    frames = mavlink.MAVLink(None, srcSystem=vehicle.system, srcComponent=1)
    home = mavlink.MAVLink_home_position_message(554000000, 98000000, 20000, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0)
    for message in [*vehicle.reports(), home]:
        state.receive(mavlink.MAVLink(None).parse_char(message.pack(frames)), 0.0)
    keeper = CommandDriver(order, state, ADDRESSING, RULES, parameters=parameters, **more)
    channel = Channel(keeper, vehicle, link or Link(), seed, listeners=[state])
    return channel.run(), channel


def commands(channel: Channel) -> list[int]:
    return [message.command for message in channel.to_vehicle]


APPLIED = CommandOutcome(CommandEnd.APPLIED)
