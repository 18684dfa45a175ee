"""Orders to a UAV, and the MAVLink commands by which each autopilot carries them out."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing, Message
from mavlink.autopilot_type import COMMANDED, COPTER_MODES, COPTER_NOT_ARMABLE, PX4_AUTO, PX4_SUB_MODES, AutopilotType, Mode
from mavlink.commands.command import CommandStep, Effect, Seven
from mavlink.vehicle_class import VehicleClass, refusal_of
from mavlink.vehicle_state import VehicleState
from operation.reasons import Reason

FIRST_PAUSE_S, MAX_PAUSE_S = 1.0, 15.0  # short at first, when each second counts; long later, as a pilot may have taken over
OWN_MODE = float(mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED)
NAN = math.nan
ABORT_ROUNDS = 3
ITEM, SPEED_MPS = "item", "speed_mps"


class Order(StrEnum):
    """Names of a UAV's commands."""

    ARM = "arm"
    DISARM = "disarm"
    TAKE_OFF = "take-off"
    START = "start"
    PAUSE = "pause"
    RESUME = "resume"
    HOLD = "hold"
    RETURN = "return"
    LAND = "land"
    ABORT = "abort"
    CHANGE_SPEED = "change-speed"


STOPS = frozenset({Order.ABORT, Order.LAND, Order.RETURN, Order.HOLD, Order.PAUSE})


class CannotOrder(ValueError):
    """The order cannot be given to this vehicle now. `code` is the machine-readable reason."""

    def __init__(self, code: str, reason: Reason) -> None:
        super().__init__(str(reason))
        self.code = code
        self.reason = reason


@dataclass(frozen=True)
class OrderPlan:
    """How an order is carried out.

    `goal` is the vehicle state that shows success. `ways` are alternatives, tried in order, each a sequence of steps. After `rounds` rounds
    in which all alternatives failed the order fails. Each round is planned from the vehicle's current state.
    """

    goal: Effect | None
    ways: tuple[tuple[CommandStep, ...], ...]
    rounds: int = 1


def plan_of(order: Order, state: VehicleState, parameters: Mapping[str, float]) -> OrderPlan:
    """Return the plan of an order for the vehicle's current state. Raises CannotOrder.

    parameters: `altitude_relative_m` of a take-off, `speed_mps` to fly at, and `item`, the mission item of a mid-air start, counted from 0
    without home. A return with an `item` continues the mission from there at `speed_mps`: the rest of the mission is the RTL path.
    """
    if state.autopilot_type not in COMMANDED:
        raise CannotOrder("autopilot", Reason("only_known_autopilots"))
    if state.vehicle_class is not VehicleClass.COPTER and not (order in STOPS and state.can_be_stopped):
        raise CannotOrder("vehicle-class", refusal_of(state.vehicle_class))
    if order in (Order.PAUSE, Order.HOLD):
        return OrderPlan(_or_on_ground(_is_in(Mode.HOLD)), ((_mode(state, Mode.HOLD),),))
    if order is Order.RETURN and ITEM in parameters:
        return _return_by_list(state, parameters)
    if order is Order.RETURN:
        return OrderPlan(_or_on_ground(_is_in(Mode.RETURN)), ((_mode(state, Mode.RETURN),),))
    if order is Order.LAND:
        return OrderPlan(_or_on_ground(_is_in(Mode.LAND)), ((_mode(state, Mode.LAND),),))
    if order is Order.ABORT:
        return _abort(state)
    if order is Order.CHANGE_SPEED:
        return OrderPlan(None, ((_speed(parameters),),))
    if order is Order.ARM:
        return OrderPlan(_is_armed, ((*_armable(state), _ARM),))
    if order is Order.DISARM:
        return OrderPlan(_is_disarmed, ((_DISARM,),))
    if order is Order.RESUME:
        if not _is_ordered_to_fly(state):
            raise CannotOrder("not-flying", Reason("resume_on_ground"))
        return OrderPlan(_is_in(Mode.MISSION), ((_mode(state, Mode.MISSION),),))
    if order is Order.TAKE_OFF:
        return _take_off(state, parameters)
    return _begin_in_air(state, int(parameters[ITEM])) if ITEM in parameters else _start(state)


# effects


def _is_armed(state: VehicleState) -> bool:
    return bool(state.is_armed)


def _is_disarmed(state: VehicleState) -> bool:
    return state.is_armed is False


def _is_down(state: VehicleState) -> bool:
    return state.is_armed is False and not state.is_in_air


def _is_flying(state: VehicleState) -> bool:
    return bool(state.is_armed and state.is_in_air)


def _flies_mission(state: VehicleState) -> bool:
    return _is_flying(state) and state.is_in(Mode.MISSION)


def _is_in(mode: Mode) -> Effect:
    return lambda state: state.is_in(mode)


def _or_on_ground(effect: Effect) -> Effect:
    """Return an effect that a UAV disarmed on the ground also shows: it holds, has returned and has landed."""
    return lambda state: effect(state) or _is_down(state)


# steps

_ARM = CommandStep(Reason("order_arm"), mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), _is_armed)
_DISARM = CommandStep(Reason("order_disarm"), mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), _is_disarmed)
_STAY_DOWN = replace(_DISARM, is_too_late=lambda state: state.is_in_air)
_LEAVE_GROUND = CommandStep(Reason("step_leave_ground"), None, effect=_is_flying, is_slow=True)
_MISSION_START = CommandStep(Reason("step_start_mission"), mavlink.MAV_CMD_MISSION_START, effect=_flies_mission, is_slow=True)


def mode_numbers(autopilot_type: AutopilotType | None, mode: Mode) -> Seven:
    """Return the parameters of MAV_CMD_DO_SET_MODE. Source for PX4: main mode and sub mode are the second and third parameter."""
    if autopilot_type is AutopilotType.PX4:
        return (OWN_MODE, float(PX4_AUTO), float(PX4_SUB_MODES[mode]), 0.0, 0.0, 0.0, 0.0)
    return (OWN_MODE, float(COPTER_MODES[mode]), 0.0, 0.0, 0.0, 0.0, 0.0)


def _mode(state: VehicleState, mode: Mode) -> CommandStep:
    return CommandStep(
        Reason("step_mode", {"mode": mode.value}), mavlink.MAV_CMD_DO_SET_MODE, mode_numbers(state.autopilot_type, mode), _is_in(mode)
    )


def _armable(state: VehicleState) -> tuple[CommandStep, ...]:
    """Return the change to GUIDED that ArduCopter needs before arming in AUTO and other modes; else nothing."""
    is_barred = state.autopilot_type is AutopilotType.ARDUPILOT and not state.is_armed and state.custom_mode in COPTER_NOT_ARMABLE
    return (_mode(state, Mode.GUIDED),) if is_barred else ()


def _start(state: VehicleState) -> OrderPlan:
    """Start the mission from its first item.

    PX4: mission mode, then arming. ArduCopter: GUIDED, arming, AUTO and MISSION_START. A disarmed ArduCopter accepts a start and does
    nothing, so only flying counts as started.
    """
    if _is_ordered_to_fly(state):
        return OrderPlan(_flies_mission, ((_mode(state, Mode.MISSION),),))
    first = _first_item(state)
    if state.autopilot_type is AutopilotType.PX4:
        return OrderPlan(_flies_mission, ((first, _mode(state, Mode.MISSION), _ARM, _LEAVE_GROUND),))
    begin = () if state.is_armed else (_mode(state, Mode.GUIDED), _ARM)
    return OrderPlan(_flies_mission, ((first, *begin, _mode(state, Mode.MISSION), _MISSION_START),))


def _begin_in_air(state: VehicleState, item: int) -> OrderPlan:
    """Start the mission at an item, for a UAV that holds on its way there. Sends nothing to a UAV that already flies its mission."""
    if not _is_ordered_to_fly(state):
        raise CannotOrder("not-flying", Reason("mid_air_start_on_ground"))
    return OrderPlan(_flies_mission, ((_item(state, item), _mode(state, Mode.MISSION)),))


def _return_by_list(state: VehicleState, parameters: Mapping[str, float]) -> OrderPlan:
    """Continue the mission at an item or past it. The speed is sent first, because items that set it may be skipped."""
    if state.vehicle_class is not VehicleClass.COPTER:
        raise CannotOrder("vehicle-class", refusal_of(state.vehicle_class))
    if not _is_ordered_to_fly(state):
        raise CannotOrder("not-flying", Reason("on_ground"))
    place = int(parameters[ITEM])
    number = _number_of(state, place)

    def is_past(seen: VehicleState) -> bool:
        return _flies_mission(seen) and seen.mission_item is not None and seen.mission_item >= number

    return OrderPlan(_or_on_ground(is_past), ((_speed(parameters), _item(state, place), _mode(state, Mode.MISSION)),))


def _is_ordered_to_fly(state: VehicleState) -> bool:
    """Return whether the UAV is in the air. Raises CannotOrder if that is unknown."""
    if state.is_in_air is None:
        raise CannotOrder("not-told", Reason("in_air_unknown"))
    return state.is_in_air


def _first_item(state: VehicleState) -> CommandStep:
    """Select the first item. Otherwise a mission flown before would resume where it stopped, over an unchecked leg.

    ArduPilot's item 0 is home.
    """
    return _item(state, 0)


def _item(state: VehicleState, place: int) -> CommandStep:
    """Select an item. place: counted from 0 without home."""
    item = _number_of(state, place)
    return CommandStep(
        Reason("step_first_item") if place == 0 else Reason("step_item", {"item": place + 1}),
        mavlink.MAV_CMD_DO_SET_MISSION_CURRENT,
        (float(item), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        effect=lambda seen: seen.mission_item == item,
        sent_at_s=lambda seen: seen.mission_item_at_s,
        instead=lambda addressing: mavlink.MAVLink_mission_set_current_message(addressing.system, addressing.component, item),
    )


def _number_of(state: VehicleState, place: int) -> int:
    """Return the item's number as the vehicle counts."""
    return place if state.autopilot_type is AutopilotType.PX4 else place + 1


def _take_off(state: VehicleState, parameters: Mapping[str, float]) -> OrderPlan:
    """Plan a take-off. PX4 expects the altitude AMSL, and arming after it; ArduCopter the height above home, after GUIDED and arming."""
    relative_m = _positive(parameters, "altitude_relative_m")
    if state.autopilot_type is AutopilotType.PX4:
        ground_m = state.altitude_amsl_m if state.home_amsl_m is None else state.home_amsl_m
        if ground_m is None:
            raise CannotOrder("no-home", Reason("height_unknown"))
        numbers = (-1.0, 0.0, 0.0, NAN, NAN, NAN, ground_m + relative_m)
        up = CommandStep(Reason("step_take_off"), mavlink.MAV_CMD_NAV_TAKEOFF, numbers, _is_in(Mode.TAKE_OFF))
        return OrderPlan(_is_flying, ((up, _ARM, _LEAVE_GROUND),))
    numbers = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, relative_m)
    up = CommandStep(Reason("step_take_off"), mavlink.MAV_CMD_NAV_TAKEOFF, numbers, _is_flying, is_slow=True)
    return OrderPlan(_is_flying, ((_mode(state, Mode.GUIDED), _ARM, up),))


def _abort(state: VehicleState) -> OrderPlan:
    """Return, or land if that is refused. On the ground: disarm first, then the same, as the UAV may be about to take off."""
    down = ((_mode(state, Mode.RETURN),), (_mode(state, Mode.LAND),))
    if state.is_in_air is False:
        return OrderPlan(_is_down, ((_STAY_DOWN,), *down), ABORT_ROUNDS)
    return OrderPlan(lambda seen: seen.is_in(Mode.RETURN) or seen.is_in(Mode.LAND) or _is_down(seen), down, ABORT_ROUNDS)


def _speed(parameters: Mapping[str, float]) -> CommandStep:
    """Set the ground speed. No message that all vehicles send shows it, so the acknowledgement has to suffice."""
    numbers = (1.0, _positive(parameters, SPEED_MPS), -1.0, 0.0, 0.0, 0.0, 0.0)
    return CommandStep(Reason("step_change_speed"), mavlink.MAV_CMD_DO_CHANGE_SPEED, numbers)


def _positive(parameters: Mapping[str, float], name: str) -> float:
    value = parameters.get(name)
    if value is None or not (math.isfinite(value) and value > 0):
        raise CannotOrder("parameters", Reason("not_positive", {"name": name}))
    return float(value)


MODES = {Order.HOLD: Mode.HOLD, Order.RETURN: Mode.RETURN, Order.ABORT: Mode.RETURN, Order.LAND: Mode.LAND}


def unacknowledged_message(order: Order, autopilot_type: AutopilotType, addressing: Addressing, sent: int) -> Message:
    """Return the command to send again without waiting for an acknowledgement.

    `order` is one of MODES, `autopilot_type` one that is commanded, `sent` the number of sends so far.
    """
    numbers = mode_numbers(autopilot_type, MODES[order])
    return mavlink.MAVLink_command_long_message(
        addressing.system, addressing.component, mavlink.MAV_CMD_DO_SET_MODE, min(sent, 255), *numbers
    )


def pause_s(sent: int) -> float:
    """Return the pause after this many sends [s]."""
    return min(FIRST_PAUSE_S * 2.0 ** max(sent - 1, 0), MAX_PAUSE_S)
