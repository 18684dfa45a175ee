"""Orders to vehicles of both autopilots, and their effect."""

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.commands.actions import Order
from mavlink.commands.command import CommandEnd
from mavlink.commands.driver import CommandDriver
from mavlink.vehicle_state import VehicleState
from operation.reasons import english
from tests.mavlink.commands.orders_given import (
    APPLIED,
    ARM,
    FIRST_ITEM,
    MODES,
    PARAMETERS,
    RULES,
    SET_ITEM,
    SET_MODE,
    SPEED,
    START,
    TAKEOFF,
    commands,
    mode_of,
    reported,
    vehicle_of,
)
from tests.mavlink.mission_sync.test_upload import received
from tests.mavlink.test_vehicle_state import heartbeat
from tests.telemetry.vehicles import ardupilot, px4
from tests.telemetry.vehicles.channel import Link
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES
from tests.telemetry.vehicles.vehicle import GROUND


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_arming_is_seen_in_the_heartbeat(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type)
    outcome, _ = reported(vehicle, Order.ARM)
    assert (outcome, vehicle.is_armed) == (APPLIED, True)


def test_copter_that_cannot_be_armed_in_auto_is_put_into_guided_first():
    vehicle = vehicle_of("ardupilot", mode="mission")
    outcome, channel = reported(vehicle, Order.ARM)
    assert (outcome, commands(channel), mode_of(vehicle)) == (APPLIED, [SET_MODE, ARM], ardupilot.GUIDED)


def test_px4_starts_by_its_mode_and_arming():
    vehicle = vehicle_of("px4")
    outcome, channel = reported(vehicle, Order.START)
    assert (outcome, commands(channel)) == (APPLIED, [SET_ITEM, SET_MODE, ARM])
    assert (vehicle.is_in_air, mode_of(vehicle)) == (True, px4.MISSION)


def test_copter_starts_by_guided_arming_auto_and_the_start():
    vehicle = vehicle_of("ardupilot")
    outcome, channel = reported(vehicle, Order.START)
    assert (outcome, commands(channel)) == (APPLIED, [SET_ITEM, SET_MODE, ARM, SET_MODE, START])
    assert [message.param2 for message in channel.to_vehicle if message.command == SET_MODE] == [ardupilot.GUIDED, ardupilot.AUTO]
    assert (vehicle.is_in_air, mode_of(vehicle)) == (True, ardupilot.AUTO)


@pytest.mark.parametrize("knows_command", [True, False])
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_start_on_the_ground_begins_with_the_first_item(autopilot_type: str, knows_command: bool):
    """Not where the last flight was broken off."""
    vehicle = vehicle_of(autopilot_type)
    vehicle.current_item, vehicle.knows_set_current = 5, knows_command
    outcome, channel = reported(vehicle, Order.START)
    assert (outcome, vehicle.is_in_air, vehicle.current_item) == (APPLIED, True, FIRST_ITEM[autopilot_type])
    assert channel.to_vehicle[0].command == SET_ITEM


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_start_does_not_begin_before_the_first_item_is_seen(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type)
    vehicle.current_item = 5
    vehicle._set_current = lambda item: 0  # type: ignore[method-assign]
    outcome, channel = reported(vehicle, Order.START)
    assert (outcome.state, outcome.code) == (CommandEnd.FAILED, "no-effect")
    assert set(commands(channel)) == {SET_ITEM}
    assert not vehicle.is_armed


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_start_in_the_air_goes_on_where_it_was_held(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type, mode="hold", in_air=True)
    vehicle.current_item = 5
    reported(vehicle, Order.START)
    assert vehicle.current_item == 5


@pytest.mark.parametrize("order", [Order.START, Order.RESUME])
def test_uav_that_does_not_tell_whether_it_flies_is_not_set_in_motion(order: Order):
    keeper, state = fresh()
    state.receive(received(mavlink.MAVLink_extended_sys_state_message(0, mavlink.MAV_LANDED_STATE_ON_GROUND)), 0.0)
    state.receive(heartbeat(mavlink.MAV_AUTOPILOT_PX4), RULES.fresh_s + 0.1)
    keeper = CommandDriver(order, state, ADDRESSING, RULES)
    assert keeper.start(RULES.fresh_s + 0.2) == []
    assert keeper.outcome is not None and keeper.outcome.code == "not-told"


def test_yes_to_a_start_without_leaving_the_ground_is_no_start():
    vehicle = vehicle_of("ardupilot")
    vehicle.carry_out = lambda command, values: 0 if command == START else type(vehicle).carry_out(vehicle, command, values)  # type: ignore[method-assign]
    outcome, channel = reported(vehicle, Order.START)
    assert (outcome.state, outcome.code) == (CommandEnd.FAILED, "no-effect")
    assert channel.now_s > RULES.lift_off_s


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_take_off_lifts_to_the_height_that_the_flavour_wants(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type)
    outcome, channel = reported(vehicle, Order.TAKE_OFF)
    (up,) = [message for message in channel.to_vehicle if message.command == TAKEOFF]
    assert (outcome, vehicle.is_in_air) == (APPLIED, True)
    assert up.param7 == (32.0 if autopilot_type == "px4" else 12.0)
    assert commands(channel) == ([TAKEOFF, ARM] if autopilot_type == "px4" else [SET_MODE, ARM, TAKEOFF])


@pytest.mark.parametrize(
    ("order", "mode"),
    [(Order.PAUSE, "hold"), (Order.HOLD, "hold"), (Order.RETURN, "return"), (Order.LAND, "land"), (Order.ABORT, "return")],
)
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_uav_in_the_air_changes_its_mode(autopilot_type: str, order: Order, mode: str):
    vehicle = vehicle_of(autopilot_type, mode="mission", in_air=True)
    outcome, channel = reported(vehicle, order)
    assert (outcome, mode_of(vehicle), commands(channel)) == (APPLIED, MODES[autopilot_type][mode], [SET_MODE])


@pytest.mark.parametrize("order", [Order.RESUME, Order.START])
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_held_uav_goes_on_with_its_mission(autopilot_type: str, order: Order):
    vehicle = vehicle_of(autopilot_type, mode="hold", in_air=True)
    outcome, channel = reported(vehicle, order)
    assert (outcome, mode_of(vehicle), commands(channel)) == (APPLIED, MODES[autopilot_type]["mission"], [SET_MODE])


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_speed_is_changed_by_its_yes(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type, mode="mission", in_air=True)
    outcome, channel = reported(vehicle, Order.CHANGE_SPEED)
    assert outcome == APPLIED
    assert (channel.to_vehicle[0].command, channel.to_vehicle[0].param1, channel.to_vehicle[0].param2) == (SPEED, 1.0, 4.5)


@pytest.mark.parametrize(
    ("order", "mode", "in_air"),
    [
        (Order.PAUSE, "hold", True), (Order.RETURN, "return", True), (Order.LAND, "land", True), (Order.RESUME, "mission", True),
        (Order.START, "mission", True), (Order.HOLD, "", False), (Order.LAND, "", False), (Order.ABORT, "", False),
        (Order.DISARM, "", False), (Order.TAKE_OFF, "hold", True), (Order.ABORT, "land", True),
    ],
)  # fmt: skip
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_uav_that_is_so_already_is_told_nothing(autopilot_type: str, order: Order, mode: str, in_air: bool):
    outcome, channel = reported(vehicle_of(autopilot_type, mode=mode, in_air=in_air), order)
    assert (outcome.state, outcome.code, channel.to_vehicle) == (CommandEnd.APPLIED, "already", [])


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_repeated_order_changes_nothing(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type)
    reported(vehicle, Order.START)
    taken = list(vehicle.taken)
    assert reported(vehicle, Order.START)[0].code == "already"
    assert vehicle.taken == taken


def test_state_of_before_the_last_command_is_not_taken_for_the_present_one():
    """A pause is under way; the last heartbeat still says that the mission is flown."""
    vehicle = vehicle_of("px4", mode="mission", in_air=True)
    outcome, channel = reported(vehicle, Order.RESUME, unsettled_until_s=1.0)
    assert (outcome, commands(channel)) == (APPLIED, [SET_MODE])


@pytest.mark.parametrize(
    ("result", "code"),
    [
        (mavlink.MAV_RESULT_DENIED, "denied"),
        (mavlink.MAV_RESULT_FAILED, "failed"),
        (mavlink.MAV_RESULT_UNSUPPORTED, "unsupported"),
        (mavlink.MAV_RESULT_TEMPORARILY_REJECTED, "temporarily-rejected"),
    ],
)
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_refused_arming_is_told_in_the_vehicles_words(autopilot_type: str, result: int, code: str):
    vehicle = vehicle_of(autopilot_type)
    vehicle.denied = {ARM: result}
    vehicle.says = "Need Position Estimate"
    outcome, channel = reported(vehicle, Order.ARM)
    assert (outcome.state, outcome.code) == (CommandEnd.FAILED, code)
    assert "Need Position Estimate" in english(outcome.why)
    assert len(commands(channel)) == (1 + RULES.retries if code == "temporarily-rejected" else 1)
    assert not vehicle.is_armed


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_yes_without_an_effect_is_asked_for_again(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type)
    vehicle.deaf_commands = 2
    outcome, channel = reported(vehicle, Order.ARM)
    assert (outcome, commands(channel)) == (APPLIED, [ARM] * 3)
    assert [message.confirmation for message in channel.to_vehicle] == [0, 1, 2]


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_yes_that_never_has_an_effect_is_a_failure(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type)
    vehicle.deaf_commands = 100
    outcome, channel = reported(vehicle, Order.ARM)
    assert (outcome.state, outcome.code, len(channel.to_vehicle)) == (CommandEnd.FAILED, "no-effect", 1 + RULES.retries)


def test_effect_without_a_yes_is_enough():
    vehicle = vehicle_of("px4")
    vehicle.is_mute = True
    assert reported(vehicle, Order.ARM)[0] == APPLIED


def test_silent_vehicle_is_told():
    vehicle = vehicle_of("px4")
    vehicle.is_alive = False
    outcome, channel = reported(vehicle, Order.ARM)
    assert (outcome.code, len(channel.to_vehicle)) == ("silent", 1 + RULES.retries)


def test_abort_that_nobody_answers_is_not_turned_into_a_landing():
    vehicle = vehicle_of("px4", mode="mission", in_air=True)
    vehicle.is_alive = False
    outcome, channel = reported(vehicle, Order.ABORT)
    assert outcome.code == "silent"
    assert {message.param3 for message in channel.to_vehicle} == {float(px4.RETURN)}


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("order", [Order.ARM, Order.START, Order.TAKE_OFF])
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_orders_on_the_ground_get_through_a_bad_link(autopilot_type: str, order: Order, seed: int):
    """Either it is done and said to be done, or it failed and says so; ArduCopter disarms itself meanwhile."""
    vehicle = vehicle_of(autopilot_type)
    outcome, _ = reported(vehicle, order, link=Link(0.3, duplicates=0.1, reordered=0.1), seed=seed)
    if outcome.state is CommandEnd.APPLIED:
        assert vehicle.is_in_air or order is Order.ARM
    else:
        assert outcome.code in ("silent", "no-effect", "failed")


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("order", [Order.PAUSE, Order.RETURN, Order.LAND, Order.ABORT])
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_orders_in_the_air_get_through_a_bad_link(autopilot_type: str, order: Order, seed: int):
    vehicle = vehicle_of(autopilot_type, mode="mission", in_air=True)
    outcome, _ = reported(vehicle, order, link=Link(0.3, duplicates=0.1, reordered=0.1), seed=seed)
    assert outcome == APPLIED
    assert mode_of(vehicle) in (MODES[autopilot_type]["hold"], MODES[autopilot_type]["return"], MODES[autopilot_type]["land"])


def fresh(order: Order = Order.ARM) -> tuple[CommandDriver, VehicleState]:
    state = VehicleState(7)
    state.receive(heartbeat(mavlink.MAV_AUTOPILOT_PX4), 0.0)
    keeper = CommandDriver(order, state, ADDRESSING, RULES, parameters=PARAMETERS)
    assert len(keeper.start(0.0)) == 1
    return keeper, state


def answer(keeper: CommandDriver, result: int, at_s: float, command: int = ARM, to: tuple[int, int] = GROUND) -> None:
    keeper.receive(received(mavlink.MAVLink_command_ack_message(command, result, 0, 0, *to)), at_s)


def test_late_no_to_an_earlier_command_is_overruled_by_the_yes():
    keeper, state = fresh()
    answer(keeper, mavlink.MAV_RESULT_DENIED, 0.1)
    answer(keeper, mavlink.MAV_RESULT_ACCEPTED, 0.3)
    assert keeper.is_acknowledged
    armed = heartbeat(mavlink.MAV_AUTOPILOT_PX4, base_mode=129)
    state.receive(armed, 0.8)
    keeper.receive(armed, 0.8)
    assert keeper.outcome == APPLIED


def test_late_no_after_the_yes_changes_nothing():
    keeper, _ = fresh()
    answer(keeper, mavlink.MAV_RESULT_ACCEPTED, 0.1)
    answer(keeper, mavlink.MAV_RESULT_DENIED, 0.2)
    keeper.tick(1.5)
    assert keeper.outcome is None


def test_answers_to_other_commands_and_other_ground_stations_are_not_ours():
    keeper, _ = fresh()
    answer(keeper, mavlink.MAV_RESULT_DENIED, 0.1, command=SET_MODE)
    answer(keeper, mavlink.MAV_RESULT_DENIED, 0.1, to=(254, 190))
    assert [message.command for message in keeper.tick(1.5)] == [ARM]


def test_vehicle_at_work_is_waited_for_and_not_asked_again():
    keeper, _ = fresh()
    answer(keeper, mavlink.MAV_RESULT_IN_PROGRESS, 0.1)
    assert keeper.tick(9.0) == []
    answer(keeper, mavlink.MAV_RESULT_IN_PROGRESS, 9.5)
    assert keeper.tick(19.0) == []
    assert len(keeper.tick(19.6)) == 1


def test_old_heartbeat_is_no_proof_of_being_so_already():
    state = VehicleState(7)
    state.receive(heartbeat(mavlink.MAV_AUTOPILOT_PX4, base_mode=129), 0.0)
    keeper = CommandDriver(Order.ARM, state, ADDRESSING, RULES)
    assert len(keeper.start(RULES.fresh_s + 0.1)) == 1


def test_heartbeat_of_before_the_order_is_no_proof_of_being_so_already():
    """It held, and was told otherwise by somebody else before it could report again."""
    state = VehicleState(7)
    state.receive(heartbeat(mavlink.MAV_AUTOPILOT_PX4, base_mode=129, custom_mode=4 << 16 | 3 << 24), 0.0)
    keeper = CommandDriver(Order.HOLD, state, ADDRESSING, RULES)
    assert keeper.start(0.5) == []
    assert keeper.outcome is None
    flies = heartbeat(mavlink.MAV_AUTOPILOT_PX4, base_mode=129, custom_mode=4 << 16 | 4 << 24)
    state.receive(flies, 1.0)
    assert [message.command for message in keeper.receive(flies, 1.0)] == [SET_MODE]


def test_order_is_sent_where_no_heartbeat_shows_that_it_is_needless():
    state = VehicleState(7)
    state.receive(heartbeat(mavlink.MAV_AUTOPILOT_PX4, base_mode=129, custom_mode=4 << 16 | 3 << 24), 0.0)
    keeper = CommandDriver(Order.HOLD, state, ADDRESSING, RULES)
    assert keeper.start(0.5) == []
    assert [message.command for message in keeper.tick(0.5 + RULES.fresh_s)] == [SET_MODE]


@pytest.mark.parametrize(
    ("order", "parameters", "code"),
    [
        (Order.CHANGE_SPEED, {}, "parameters"),
        (Order.CHANGE_SPEED, {"speed_mps": 0.0}, "parameters"),
        (Order.CHANGE_SPEED, {"speed_mps": math.nan}, "parameters"),
        (Order.TAKE_OFF, {"altitude_relative_m": -3.0}, "parameters"),
        (Order.TAKE_OFF, {"altitude_relative_m": 12.0}, "no-home"),
    ],
)
def test_order_that_says_too_little_is_refused(order: Order, parameters: dict[str, float], code: str):
    state = VehicleState(7)
    state.receive(heartbeat(mavlink.MAV_AUTOPILOT_PX4), 0.0)
    keeper = CommandDriver(order, state, ADDRESSING, RULES, parameters=parameters)
    assert keeper.start(0.0) == []
    assert keeper.outcome is not None
    assert (keeper.outcome.state, keeper.outcome.code) == (CommandEnd.FAILED, code)


def test_resuming_on_the_ground_is_refused():
    outcome, channel = reported(vehicle_of("px4"), Order.RESUME)
    assert (outcome.code, channel.to_vehicle) == ("not-flying", [])


@pytest.mark.parametrize("order", list(Order))
def test_other_autopilot_is_told_nothing(order: Order):
    state = VehicleState(7)
    state.autopilot_type = AutopilotType.OTHER
    keeper = CommandDriver(order, state, ADDRESSING, RULES, parameters=PARAMETERS)
    assert keeper.start(0.0) == []
    assert keeper.outcome is not None
    assert keeper.outcome.code == "autopilot"


def test_effect_that_was_reported_before_the_command_is_no_effect():
    state = VehicleState(7)
    state.receive(heartbeat(mavlink.MAV_AUTOPILOT_PX4, base_mode=129), 0.0)
    keeper = CommandDriver(Order.ARM, state, ADDRESSING, RULES, unsettled_until_s=1.0)
    assert len(keeper.start(0.5)) == 1
    answer(keeper, mavlink.MAV_RESULT_ACCEPTED, 0.6)
    assert keeper.outcome is None
    again = heartbeat(mavlink.MAV_AUTOPILOT_PX4, base_mode=129)
    state.receive(again, 1.0)
    keeper.receive(again, 1.0)
    assert keeper.outcome == APPLIED


def test_the_late_answer_to_an_earlier_speed_is_no_answer_to_a_later_one():
    state = VehicleState(7)
    state.receive(heartbeat(mavlink.MAV_AUTOPILOT_PX4, base_mode=129), 0.0)
    keeper = CommandDriver(Order.CHANGE_SPEED, state, ADDRESSING, RULES, parameters=PARAMETERS, unsettled_until_s=2.0)
    assert keeper.start(0.5) == []
    message = received(mavlink.MAVLink_command_ack_message(SPEED, mavlink.MAV_RESULT_ACCEPTED, 0, 0, *GROUND))
    assert keeper.receive(message, 1.0) == [] and keeper.outcome is None
    (sent,) = keeper.tick(2.0)
    assert sent.command == SPEED
    keeper.receive(message, 2.1)
    assert keeper.outcome == APPLIED
