"""From a command's row to what is to be done with the vehicle, or to the reason why nothing is."""

from collections.abc import Sequence
from dataclasses import dataclass

from django.conf import settings

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import WGS84
from missions.mavlink.content import FlightLoad
from missions.mavlink.frozen import TakeOff
from missions.models import CommandKind, UavCommand
from missions.services.dispatch import ApprovedLoad, DamagedApproval, load_of
from telemetry.ground_station.orders import Order
from telemetry.ground_station.vehicle_state import VehicleState
from telemetry.services.loads import Loaded, loaded_on

LOADING = (CommandKind.UPLOAD_MISSION, CommandKind.CLEAR_MISSION)
EMPTY = FlightLoad(())


@dataclass(frozen=True)
class CannotCarry:
    """`is_for_good`: another try will not help."""

    code: str
    words: str
    is_for_good: bool = True


@dataclass(frozen=True)
class Task:
    """`load` is to be on the vehicle, or `order` to be followed. `wanted` is what UavLink shows then, `before` what it showed."""

    load: FlightLoad | None = None
    order: Order | None = None
    parameters: dict[str, float] | None = None
    take_off: TakeOff | None = None
    wanted: Loaded | None = None
    before: Loaded | None = None
    known: Sequence[FlightLoad] = ()


def task_of(command: UavCommand) -> Task | CannotCarry:
    """Reads the database."""
    before = loaded_on(command.uav_id)
    if command.kind == CommandKind.CLEAR_MISSION:
        return Task(load=EMPTY, before=before)
    if command.kind not in (CommandKind.UPLOAD_MISSION, CommandKind.START) or command.approval_id is None:
        parameters = {name: float(value) for name, value in command.parameters.items() if isinstance(value, int | float)}
        return Task(order=Order(command.kind), parameters=parameters, before=before)
    try:
        approved = load_of(command)
    except DamagedApproval:
        return CannotCarry("damaged-approval", "The approval is not the one that was given: its hash is another one.")
    except (LookupError, StopIteration):
        return CannotCarry("no-flight", "The approval has no such flight of this UAV.")
    if approved.load is None:
        return CannotCarry("not-mavlink", "It was approved for a UAV with a companion computer. Revoke, and approve it again.")
    wanted = Loaded(approved.load.content_sha256, approved.approval, approved.flight)
    if command.kind == CommandKind.UPLOAD_MISSION:
        return Task(load=approved.load, take_off=approved.take_off, wanted=wanted, before=before, known=_others(command, approved))
    if before != wanted:
        return CannotCarry("not-loaded", "The UAV does not hold this flight of the approved mission: send it first.")
    return Task(order=Order.START, take_off=approved.take_off, before=before)


def reason_not_to(task: Task, state: VehicleState) -> CannotCarry | None:
    """Whether the vehicle stands where its flight was planned to begin. One that flies is not asked."""
    if task.take_off is None or state.is_in_air:
        return None
    if state.position is None:
        return CannotCarry("no-position", "The UAV has not told where it stands.", is_for_good=False)
    away_m = _apart_m(state.position, task.take_off.position)
    if away_m > settings.TAKE_OFF_DISTANCE_M:
        words = f"The UAV stands {away_m:.0f} m from the planned take-off; {settings.TAKE_OFF_DISTANCE_M:.0f} m are allowed."
        return CannotCarry("elsewhere", words)
    if task.take_off.altitude_amsl_m is None or state.altitude_amsl_m is None:
        return None
    above_m = state.altitude_amsl_m - task.take_off.altitude_amsl_m
    if abs(above_m) > settings.TAKE_OFF_HEIGHT_M:
        side = "above" if above_m > 0 else "below"
        words = f"The UAV reports {abs(above_m):.0f} m {side} the planned take-off; {settings.TAKE_OFF_HEIGHT_M:.0f} m are allowed."
        return CannotCarry("other-height", words)
    return None


def _others(command: UavCommand, approved: ApprovedLoad) -> list[FlightLoad]:
    """Loads that were sent to the vehicle before: what it holds may be one of them."""
    earlier = UavCommand.objects.filter(uav=command.uav_id, kind=CommandKind.UPLOAD_MISSION, sequence__lt=command.sequence)
    loads = []
    for other in earlier.select_related("approval").order_by("-sequence")[:3]:
        try:
            load = load_of(other).load
        except (DamagedApproval, LookupError, StopIteration):
            continue
        if load is not None and load != approved.load:
            loads.append(load)
    return loads


def _apart_m(one: LonLat, other: LonLat) -> float:
    return float(WGS84.inv(one.lon, one.lat, other.lon, other.lat)[2])
