"""Planes, VTOLs and rovers are shown by their own modes, and take no mission; only what is known of their modes is asked of them."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import Mode
from mavlink.commands.actions import STOPS, Order
from mavlink.commands.command import CommandEnd
from mavlink.mission_sync.outcome import SyncState
from mavlink.mission_sync.sync import MissionSync
from mavlink.timeouts import TransferRules
from mavlink.vehicle_class import VehicleClass, class_of
from operation.reasons import english
from tests.mavlink.commands.orders_given import reported
from tests.telemetry.vehicles.ardupilot import ArduPilot
from tests.telemetry.vehicles.channel import Channel
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES, known, load
from tests.telemetry.vehicles.px4 import Px4

PLANE, QUADPLANE = mavlink.MAV_TYPE_FIXED_WING, mavlink.MAV_TYPE_VTOL_QUADROTOR
ROVER, BOAT, SUBMARINE = mavlink.MAV_TYPE_GROUND_ROVER, mavlink.MAV_TYPE_SURFACE_BOAT, mavlink.MAV_TYPE_SUBMARINE
OTHERS = {PLANE: "plane", QUADPLANE: "VTOL", ROVER: "rover", BOAT: "boat", SUBMARINE: "submarine", 0: "vehicle of another kind"}


@pytest.mark.parametrize(
    ("vehicle_type", "number", "name"),
    [
        (mavlink.MAV_TYPE_HEXAROTOR, 6, "RTL"),
        (mavlink.MAV_TYPE_HELICOPTER, 17, "BRAKE"),
        (PLANE, 5, "FLY_BY_WIRE_A"),
        (PLANE, 6, "FLY_BY_WIRE_B"),
        (PLANE, 10, "AUTO"),
        (PLANE, 11, "RTL"),
        (PLANE, 15, "GUIDED"),
        (QUADPLANE, 17, "QSTABILIZE"),
        (QUADPLANE, 19, "QLOITER"),
        (QUADPLANE, 20, "QLAND"),
        (QUADPLANE, 21, "QRTL"),
        (ROVER, 4, "HOLD"),
        (BOAT, 11, "RTL"),
        (SUBMARINE, 9, "MODE 9"),
    ],
)
def test_a_mode_is_named_as_the_firmware_of_its_kind_names_it(vehicle_type, number, name):
    assert known(ArduPilot(vehicle_type=vehicle_type, custom_mode=number)).mode == name


def test_every_vtol_of_the_standard_is_one():
    names = {number: entry.name for number, entry in mavlink.enums["MAV_TYPE"].items()}
    assert {number for number in names if class_of(number) is VehicleClass.VTOL} == {
        number for number, name in names.items() if name.startswith("MAV_TYPE_VTOL")
    }


@pytest.mark.parametrize("vehicle_type", [PLANE, ROVER])
def test_its_own_auto_is_the_mission(vehicle_type):
    assert known(ArduPilot(vehicle_type=vehicle_type, custom_mode=10)).is_in(Mode.MISSION)
    assert not known(ArduPilot(vehicle_type=vehicle_type, custom_mode=3)).is_in(Mode.MISSION)


@pytest.mark.parametrize("order", Order)
@pytest.mark.parametrize(("vehicle_type", "kind"), OTHERS.items())
def test_ardupilot_of_another_kind_is_commanded_nothing_and_told_why(vehicle_type, kind, order):
    vehicle = ArduPilot(vehicle_type=vehicle_type, heartbeats=True, is_armed=True, is_in_air=True, custom_mode=10)
    outcome, channel = reported(vehicle, order)
    assert (outcome.state, outcome.code, channel.to_vehicle) == (CommandEnd.FAILED, "vehicle-class", [])
    assert english(outcome.why) == f"The vehicle is a {kind}: Spanwise plans for and commands multicopters only."
    assert not known(vehicle).can_be_stopped, "not into the dark either"


@pytest.mark.parametrize("order", Order)
def test_px4_of_another_kind_is_held_brought_back_and_landed_and_nothing_else(order):
    vehicle = Px4(vehicle_type=PLANE, heartbeats=True, is_armed=True, is_in_air=True, custom_mode=4 << 16 | 4 << 24)
    outcome, _ = reported(vehicle, order)
    assert outcome.state is (CommandEnd.APPLIED if order in STOPS else CommandEnd.FAILED), outcome
    assert outcome.code == ("" if order in STOPS else "vehicle-class")


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
@pytest.mark.parametrize("vehicle_type", OTHERS)
def test_no_mission_is_sent_to_another_kind(autopilot_type, vehicle_type):
    vehicle = AUTOPILOT_TYPES[autopilot_type](vehicle_type=vehicle_type)
    channel = Channel(MissionSync(load(7), known(vehicle), ADDRESSING, TransferRules()), vehicle)
    outcome = channel.run()
    assert (outcome.state, outcome.code, channel.to_vehicle) == (SyncState.INTACT, "vehicle-class", [])
    assert english(outcome.why).startswith("Nothing was sent. The vehicle is a ")
