"""Converts a command's row to the task of its delivery, or to the reason why it cannot be delivered."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from django.conf import settings
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import WGS84
from mavlink.approved_route import TakeOff
from mavlink.autopilot_type import RESTARTS, AutopilotType, Mode
from mavlink.commands.actions import ITEM, SPEED_MPS, Order
from mavlink.legs import FLOWN, BesideLeg, beside_leg, beside_place
from mavlink.mission_sync.supported_items import PHOTO_RADIUS_M
from mavlink.vehicle_plan import FlightLoad
from mavlink.vehicle_state import VehicleState
from missions.command_rules import ALONG_ROUTE
from missions.models import CommandKind, MissionState, UavCommand
from missions.services.commands.dispatch import ApprovedLoad, DamagedApproval, approved_load, load_of
from missions.services.commands.start_slots import START_SLOT, reasons_to_carry_later
from operation.reasons import Reason, text_reason
from telemetry.services.links.onboard_lists import LoadedLists, loaded_on
from telemetry.services.returns.along_route import OnBoard, along_route, held_flight

SAME_M = 1.0  # if two legs are equally near within this, the earlier one is used
LOADING = (CommandKind.UPLOAD_MISSION, CommandKind.CLEAR_MISSION)
FLIES_LIST = (CommandKind.START, CommandKind.RESUME)
EMPTY = FlightLoad(())
KNOWN_LOADS = 5
NEW_S = 10.0
PHOTO_LEG_M = 2.0  # of a leg beside wires: errors of position


def item_to_begin_with(load: FlightLoad, begun_by: int, state: VehicleState) -> int | None:
    """Return the item, counted from 0 without home, whose leg the vehicle is on; None if on none up to `begun_by`.

    `begun_by` is a waypoint of the route. The first leg has no start: it is the first item's position.
    """
    places = [number for number, item in enumerate(load.mission) if item.command in FLOWN]
    last = max((number for number in places if load.mission[number].waypoint == begun_by), default=None)
    if last is None or state.position is None or state.altitude_relative_m is None:
        return None
    found, nearest_m = None, settings.RESUME_DISTANCE_M
    beside: BesideLeg | None
    for number in (place for place in places if place <= last):
        if number == places[0]:
            beside = beside_place(load.mission[number], state.position, state.altitude_relative_m)
        else:
            beside = beside_leg(load, number, state.position, state.position, state.altitude_relative_m)
        away_m, above_m = _allowed_m(load, number)
        if beside is None or beside.away_m > away_m or abs(beside.above_m) > above_m:
            continue
        if beside.away_m <= nearest_m - (0.0 if found is None else SAME_M):
            found, nearest_m = number, beside.away_m
    return found


@dataclass(frozen=True)
class CannotCarry:
    """Why a command cannot be delivered. `is_for_good`: a retry will not help."""

    code: str
    why: tuple[Reason, ...]
    is_for_good: bool = True


def _cannot(code: str, reason: str, *, is_for_good: bool = True, **params: Any) -> CannotCarry:
    return CannotCarry(code, (Reason(reason, params),), is_for_good)


_OFF_ROUTE = _cannot("off-route", "off_first_leg")


@dataclass(frozen=True)
class DeliveryTask:
    """The task of a delivery: to bring `load` onto the vehicle, or to carry out `order`.

    `wanted` is the state of UavLink afterwards, `before` its present state. `onboard` is read back before an order that flies it.
    `begun_by`: the flight starts in the air, on the way to this waypoint. `return_height_m` is to be set on the vehicle, above its
    take-off. `along`: return by the rest of this list.
    """

    load: FlightLoad | None = None
    order: Order | None = None
    parameters: dict[str, float] | None = None
    onboard: FlightLoad | None = None
    take_off: TakeOff | None = None
    wanted: LoadedLists | None = None
    before: LoadedLists | None = None
    begun_by: int | None = None
    return_height_m: float | None = None
    along: OnBoard | None = None
    known: Sequence[FlightLoad] = ()


def reason_not_to_start(start: UavCommand) -> CannotCarry | None:
    """Return a refusal if UAVs in the air come near its route, else None."""
    to_wait = reasons_to_carry_later(start)
    return CannotCarry(START_SLOT, (text_reason(to_wait[0].message),)) if to_wait else None


def task_of(command: UavCommand) -> DeliveryTask | CannotCarry:
    """Return the task of a command, or why there is none. Reads the database."""
    before = loaded_on(command.uav_id)
    if command.kind == CommandKind.CLEAR_MISSION:
        return DeliveryTask(load=EMPTY, before=before, known=_others(command, EMPTY))
    if command.kind == CommandKind.SET_RETURN_HEIGHT:
        return DeliveryTask(return_height_m=float(command.parameters["height_m"]), before=before)
    if command.kind == CommandKind.RETURN and command.parameters.get(ALONG_ROUTE):
        return _return_along(command, before)
    if command.kind not in (CommandKind.UPLOAD_MISSION, *FLIES_LIST):
        parameters = {name: float(value) for name, value in command.parameters.items() if isinstance(value, int | float)}
        return DeliveryTask(order=Order(command.kind), parameters=parameters, before=before)
    try:
        approved = _approved(command, before)
    except DamagedApproval:
        return _cannot("damaged-approval", "damaged_approval")
    except (LookupError, StopIteration):
        return _cannot("no-flight", "no_such_flight")
    if isinstance(approved, CannotCarry):
        return approved
    if approved.load is None:
        return CannotCarry("not-mavlink", (Reason("approved_for_companion"), Reason("revoke_and_approve")))
    wanted = LoadedLists(approved.load.content_sha256, approved.approval, approved.flight)
    if command.kind == CommandKind.UPLOAD_MISSION:
        known = _others(command, approved.load)
        begun_by = approved.route.begun_by
        return DeliveryTask(load=approved.load, take_off=approved.take_off, wanted=wanted, before=before, begun_by=begun_by, known=known)
    if before != wanted:
        return _cannot("not-loaded", "flight_not_loaded")
    begun_by = approved.route.begun_by if command.kind == CommandKind.START else None
    if command.kind == CommandKind.START:
        too_near = reason_not_to_start(command)
        if too_near is not None:
            return too_near
    return DeliveryTask(order=Order(command.kind), take_off=approved.take_off, onboard=approved.load, before=before, begun_by=begun_by)


def _return_along(command: UavCommand, before: LoadedLists | None) -> DeliveryTask | CannotCarry:
    approval = command.approval
    held = None if approval is None else held_flight(approval, command.uav_id, before)
    if held is None or approval is None or approval.revoked_at is not None or approval.revoke_requested_at is not None:
        return _cannot("not-loaded", "list_not_sure")
    return DeliveryTask(order=Order.RETURN, before=before, along=held)


def return_by_list(held: OnBoard, state: VehicleState, now_s: float, now: datetime) -> dict[str, float] | CannotCarry:
    """Return the parameters of a return along the route from the vehicle's position. Reads the database. now_s: by the state's clock."""
    if state.position is None or state.altitude_relative_m is None or not _is_new(state.position_at_s, now_s):
        return _cannot("no-position", "position_unknown", is_for_good=False)
    if state.mission_item is None or not _is_new(state.mission_item_at_s, now_s):
        return _cannot("no-item", "waypoint_unknown", is_for_good=False)
    is_ardupilot = state.autopilot_type is AutopilotType.ARDUPILOT
    if is_ardupilot and not state.is_in(Mode.MISSION):
        if state.parameters.get(RESTARTS) is None:
            return _cannot("no-item", "restart_unknown", parameter=RESTARTS, is_for_good=False)
        if state.parameters[RESTARTS]:
            return _cannot("begins-anew", "would_restart", parameter=RESTARTS)
    waypoint = held.waypoint_of(state.mission_item - 1 if is_ardupilot else state.mission_item)
    found = along_route(held, position=state.position, height_m=state.altitude_relative_m, waypoint=waypoint, now=now)
    if found is None:
        return _cannot("not-clear", "no_clear_return")
    return {ITEM: float(found.item), SPEED_MPS: found.path.speed_mps}


def _approved(command: UavCommand, before: LoadedLists | None) -> ApprovedLoad | CannotCarry:
    """Return the flight of a command; for a resume, the flight on the UAV. Raises as `load_of`."""
    approval = command.approval
    if approval is None or command.mission is None:
        return _cannot("no-mission", "not_approved")
    if command.kind in FLIES_LIST and (approval.revoked_at is not None or approval.revoke_requested_at is not None):
        return _cannot("revoked", "approval_revoked")
    if command.kind != CommandKind.RESUME:
        return load_of(command)
    if command.mission.state != MissionState.ACTIVE:
        return _cannot("not-active", "only_active_resumed")
    if before is None or before.approval != approval.pk:
        return _cannot("not-loaded", "no_flight_loaded")
    return approved_load(approval, uav_id=command.uav_id, flight=before.flight)


def reason_not_to(task: DeliveryTask, state: VehicleState, now_s: float) -> CannotCarry | None:
    """Return a refusal unless the vehicle is at its planned start, or on its leg in the air, with its home at the take-off; else None.

    now_s: by the state's clock. Older values may date from before a boot, or before the vehicle was moved.
    """
    if task.take_off is None:
        return None
    if task.begun_by is not None and not state.is_in_air:
        return _cannot("on-ground", "mid_air_start_not_flying", is_for_good=state.is_in_air is False)
    if not state.is_in_air:
        if state.position is None or not _is_new(state.position_at_s, now_s):
            return _cannot("no-position", "stand_unknown", is_for_good=False)
        elsewhere = _elsewhere(task.take_off, state.position, state.altitude_amsl_m, "stands", "elsewhere", "other-height")
        if elsewhere is not None:
            return elsewhere
    if task.order is None:
        return None
    if state.home is None or not _is_new(state.home_at_s, now_s):
        return _cannot("no-home", "home_unknown", is_for_good=False)
    elsewhere = _elsewhere(task.take_off, state.home, state.home_amsl_m, "home", "home-elsewhere", "home-height")
    if elsewhere is not None or not state.is_in_air or task.onboard is None or state.is_in(Mode.MISSION):
        return elsewhere
    if task.begun_by is not None:
        return _not_on_the_way(task.onboard, task.begun_by, state, now_s)
    return _off_the_leg(task.take_off, task.onboard, state, now_s)


def _not_on_the_way(load: FlightLoad, begun_by: int, state: VehicleState, now_s: float) -> CannotCarry | None:
    """Return a refusal unless the UAV is on a leg that was checked for a mid-air start."""
    if state.position is None or state.altitude_relative_m is None or not _is_new(state.position_at_s, now_s):
        return _cannot("no-position", "position_unknown", is_for_good=False)
    item = item_to_begin_with(load, begun_by, state)
    if item is None:
        return _OFF_ROUTE
    if state.autopilot_type is AutopilotType.ARDUPILOT and item > 0:
        if state.parameters.get(RESTARTS) is None:
            return _cannot("no-item", "restart_unknown", parameter=RESTARTS, is_for_good=False)
        if state.parameters[RESTARTS]:
            return _cannot("begins-anew", "would_fly_back", parameter=RESTARTS)
    return None


def as_begun(task: DeliveryTask, state: VehicleState) -> DeliveryTask | CannotCarry:
    """Return the task with the item to start with, for a UAV that holds in the air; unchanged if it already flies its mission."""
    if task.begun_by is None or task.onboard is None or state.is_in(Mode.MISSION):
        return task
    item = item_to_begin_with(task.onboard, task.begun_by, state)
    return _OFF_ROUTE if item is None else replace(task, parameters={ITEM: float(item)})


def _off_the_leg(take_off: TakeOff, load: FlightLoad, state: VehicleState, now_s: float) -> CannotCarry | None:
    """Return a refusal if the UAV is off the leg to its present item, to which it would fly straight."""
    if state.position is None or state.altitude_relative_m is None or not _is_new(state.position_at_s, now_s):
        return _cannot("no-position", "position_unknown", is_for_good=False)
    if state.mission_item is None or not _is_new(state.mission_item_at_s, now_s):
        return _cannot("no-item", "waypoint_unknown", is_for_good=False)
    item = state.mission_item
    if state.autopilot_type is AutopilotType.ARDUPILOT:
        if state.parameters.get(RESTARTS) is None:
            return _cannot("no-item", "restart_unknown", parameter=RESTARTS, is_for_good=False)
        item = 0 if state.parameters[RESTARTS] else max(item - 1, 0)
    beside = beside_leg(load, item, take_off.position, state.position, state.altitude_relative_m)
    if beside is None:
        return _cannot("flown-already", "flown_to_end")
    away_m, above_m = _allowed_m(load, item)
    if beside.away_m > away_m:
        return _cannot("off-route", "beside_leg", metres=round(beside.away_m), allowed=round(away_m))
    if abs(beside.above_m) > above_m:
        reason = "above_leg" if beside.above_m > 0 else "below_leg"
        return _cannot("off-height", reason, metres=round(abs(beside.above_m)), allowed=round(above_m))
    return None


def _allowed_m(load: FlightLoad, item: int) -> tuple[float, float]:
    """Return how far beside and above the leg to an item a UAV may be that flies straight to it [m, m].

    A leg beside wires ends at a waypoint with the radius of photo flights.
    """
    end = next((own for own in load.mission[item:] if own.command in FLOWN), None)
    if end is not None and end.command == mavlink.MAV_CMD_NAV_WAYPOINT and end.parameters[1] == PHOTO_RADIUS_M:
        return PHOTO_LEG_M, PHOTO_LEG_M
    return settings.RESUME_DISTANCE_M, settings.TAKE_OFF_HEIGHT_M


def _is_new(sent_at_s: float | None, now_s: float) -> bool:
    return sent_at_s is not None and now_s - sent_at_s <= NEW_S


def _elsewhere(take_off: TakeOff, place: LonLat, amsl_m: float | None, reason: str, off_place: str, off_height: str) -> CannotCarry | None:
    """Return a refusal if a place or its height is away from the take-off. Unknown heights are not compared.

    `off_place` and `off_height` are codes.
    """
    away_m = _apart_m(place, take_off.position)
    if away_m > settings.TAKE_OFF_DISTANCE_M:
        return _cannot(off_place, f"{reason}_elsewhere", metres=round(away_m), allowed=round(settings.TAKE_OFF_DISTANCE_M))
    if take_off.altitude_amsl_m is None or amsl_m is None:
        return None
    above_m = amsl_m - take_off.altitude_amsl_m
    if abs(above_m) > settings.TAKE_OFF_HEIGHT_M:
        side = "above" if above_m > 0 else "below"
        return _cannot(off_height, f"{reason}_{side}", metres=round(abs(above_m)), allowed=round(settings.TAKE_OFF_HEIGHT_M))
    return None


def _others(command: UavCommand, wanted: FlightLoad) -> list[FlightLoad]:
    """Return loads sent to the vehicle before, one of which it may still hold."""
    earlier = UavCommand.objects.filter(uav=command.uav_id, kind=CommandKind.UPLOAD_MISSION, sequence__lt=command.sequence)
    loads = []
    for other in earlier.select_related("approval").order_by("-sequence")[:KNOWN_LOADS]:
        try:
            load = load_of(other).load
        except (DamagedApproval, LookupError, StopIteration):
            continue
        if load is not None and load != wanted:
            loads.append(load)
    return loads


def _apart_m(one: LonLat, other: LonLat) -> float:
    return float(WGS84.inv(one.lon, one.lat, other.lon, other.lat)[2])
