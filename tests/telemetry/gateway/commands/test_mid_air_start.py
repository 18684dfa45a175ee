"""A route that is begun in the air: with which item, by which commands, and never where nobody has looked."""

import time
from dataclasses import replace

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.approved_route import TakeOff
from mavlink.autopilot_type import RESTARTS, AutopilotType
from mavlink.commands.actions import ITEM, Order, plan_of
from mavlink.mission_sync.supported_items import PHOTO_RADIUS_M
from mavlink.vehicle_plan import FlightLoad, MissionItem
from mavlink.vehicle_state import VehicleState
from telemetry.gateway.preparation import CannotCarry, DeliveryTask, as_begun, reason_not_to

HOME = LonLat(10.0, 56.0)
HELD = {AutopilotType.PX4: 4 << 16 | 3 << 24, AutopilotType.ARDUPILOT: 17}


def item(lon: float, waypoint: int, lat: float = 56.01, radius_m: float = 0.0) -> MissionItem:
    return MissionItem(mavlink.MAV_CMD_NAV_WAYPOINT, 6, (0.0, radius_m, 0.0, 0.0), round(lon * 1e7), round(lat * 1e7), 60.0, waypoint)


#  10.00 ---- 10.01 ---- 10.02   then away to the north
LOAD = FlightLoad((item(10.0, 0), item(10.01, 1), item(10.02, 2), item(10.02, 3, 56.02)))


def held(autopilot_type: AutopilotType, place: LonLat, height_m: float = 60.0, **facts) -> VehicleState:
    now_s = time.monotonic()
    state = VehicleState(
        7, autopilot_type=autopilot_type, custom_mode=HELD[autopilot_type], is_armed=True, heartbeat_at_s=now_s, received_at_s=now_s
    )
    state.vehicle_type = mavlink.MAV_TYPE_QUADROTOR
    state.landed_state, state.landed_at_s = mavlink.MAV_LANDED_STATE_IN_AIR, now_s
    state.position, state.altitude_relative_m, state.position_at_s = place, height_m, now_s
    state.home, state.home_amsl_m, state.home_at_s = HOME, 100.0, now_s
    state.parameters[RESTARTS] = 0.0
    for name, value in facts.items():
        setattr(state, name, value)
    return state


def task(**facts) -> DeliveryTask:
    return DeliveryTask(order=Order.START, onboard=LOAD, take_off=TakeOff(HOME, 100.0), begun_by=2, **facts)


@pytest.mark.parametrize("autopilot_type", HELD)
@pytest.mark.parametrize(("lon", "begins_with"), [(10.0, 0), (10.004, 1), (10.0099, 1), (10.015, 2), (10.0201, 2)])
def test_it_begins_with_the_end_of_the_leg_on_which_it_is_held(autopilot_type, lon, begins_with):
    state = held(autopilot_type, LonLat(lon, 56.01))
    assert reason_not_to(task(), state, time.monotonic()) is None
    begun = as_begun(task(), state)
    assert isinstance(begun, DeliveryTask) and begun.parameters == {ITEM: float(begins_with)}
    (steps,) = plan_of(Order.START, state, begun.parameters).ways
    assert [step.command for step in steps] == [mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, mavlink.MAV_CMD_DO_SET_MODE]
    assert steps[0].parameters[0] == begins_with + (autopilot_type is AutopilotType.ARDUPILOT)


OFF = [(10.01, 56.011, 60.0), (10.02, 56.015, 60.0), (10.0, 56.005, 60.0), (10.01, 56.01, 90.0)]


@pytest.mark.parametrize("autopilot_type", HELD)
@pytest.mark.parametrize(("lon", "lat", "height_m"), OFF)
def test_beside_below_and_beyond_its_way_it_is_not_begun(autopilot_type, lon, lat, height_m):
    state = held(autopilot_type, LonLat(lon, lat), height_m)
    reason = reason_not_to(task(), state, time.monotonic())
    assert reason is not None and reason.code == "off-route"
    assert isinstance(as_begun(task(), state), CannotCarry)


def test_on_the_ground_it_is_neither_loaded_nor_begun():
    state = held(AutopilotType.PX4, HOME, 0.0, landed_state=mavlink.MAV_LANDED_STATE_ON_GROUND)
    for one in (task(), DeliveryTask(load=LOAD, take_off=TakeOff(HOME, 100.0), begun_by=2)):
        reason = reason_not_to(one, state, time.monotonic())
        assert reason is not None and reason.code == "on-ground"


def test_an_ardupilot_that_begins_its_list_anew_is_begun_at_its_beginning_alone():
    state = held(AutopilotType.ARDUPILOT, LonLat(10.004, 56.01))
    state.parameters[RESTARTS] = 1.0
    reason = reason_not_to(task(), state, time.monotonic())
    assert reason is not None and reason.code == "begins-anew"
    assert reason_not_to(task(), held(AutopilotType.ARDUPILOT, LonLat(10.0, 56.01)), time.monotonic()) is None


def test_one_whose_home_is_elsewhere_counts_its_heights_from_there():
    state = held(AutopilotType.PX4, LonLat(10.004, 56.01), home=LonLat(10.05, 56.0))
    reason = reason_not_to(task(), state, time.monotonic())
    assert reason is not None and reason.code == "home-elsewhere"


# Legs beside wires: the leg to waypoint 2 is that of a photo flight.

PHOTOS = FlightLoad((item(10.0, 0), item(10.01, 1), item(10.02, 2, radius_m=PHOTO_RADIUS_M), item(10.02, 3, 56.02)))
METRE_OF_LATITUDE = 1.0 / 111_000.0


@pytest.mark.parametrize("autopilot_type", HELD)
@pytest.mark.parametrize(
    ("lon", "beside_m", "above_m", "is_refused"),
    [(10.015, 5.0, 0.0, True), (10.015, 1.0, 0.0, False), (10.015, 0.0, 4.0, True), (10.015, 0.0, -1.0, False), (10.005, 5.0, 4.0, False)],
)
def test_a_leg_beside_wires_is_begun_on_it_alone(autopilot_type, lon, beside_m, above_m, is_refused):
    state = held(autopilot_type, LonLat(lon, 56.01 + beside_m * METRE_OF_LATITUDE), 60.0 + above_m)
    reason = reason_not_to(replace(task(), onboard=PHOTOS), state, time.monotonic())
    assert (None if reason is None else reason.code) == ("off-route" if is_refused else None)


@pytest.mark.parametrize(
    ("item_flown", "beside_m", "above_m", "code"),
    [(2, 5.0, 0.0, "off-route"), (2, 1.0, 0.0, None), (2, 0.0, -4.0, "off-height"), (1, 5.0, 4.0, None)],
)
def test_a_leg_beside_wires_is_resumed_on_it_alone(item_flown, beside_m, above_m, code):
    lon = {1: 10.005, 2: 10.015}[item_flown]
    place = LonLat(lon, 56.01 + beside_m * METRE_OF_LATITUDE)
    state = held(AutopilotType.PX4, place, 60.0 + above_m, mission_item=item_flown, mission_item_at_s=time.monotonic())
    resume = DeliveryTask(order=Order.RESUME, onboard=PHOTOS, take_off=TakeOff(HOME, 100.0))
    reason = reason_not_to(resume, state, time.monotonic())
    assert (None if reason is None else reason.code) == code
