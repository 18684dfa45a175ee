"""Unknown vehicles: an administrator adopts or ignores them."""

from dataclasses import dataclass
from typing import Any

from django.db import transaction
from django.utils import timezone

from inspection.geodesy import LonLat
from missions.models import LinkKind, Uav, UavType
from missions.services import change_uav, create_uav
from telemetry.models import UnknownVehicle, UnknownVehicleState
from workspace.audit import record_change
from workspace.models import User


class AlreadySettled(Exception):
    """Another user has already settled the vehicle."""


class NoPlace(Exception):
    """The vehicle has not reported a position, so a new UAV needs a position or a base."""


@dataclass(frozen=True)
class NewUav:
    """Data of a UAV to be created. Without a position it stands where the vehicle is."""

    name: str
    uav_type: UavType | None = None
    position: LonLat | None = None


@transaction.atomic
def adopt_vehicle(*, vehicle: UnknownVehicle, actor: User, uav: Uav | NewUav) -> Uav:
    """Give a UAV the vehicle's system id; it then receives its commands by MAVLink.

    Raises AlreadySettled, NoPlace, NameTaken, SystemIdTaken, or Refused if commands for the UAV are under way on another link.
    """
    held = _held(vehicle, UnknownVehicleState.NEW, UnknownVehicleState.IGNORED)
    system_id: dict[str, Any] = {"mavlink_system_id": held.mavlink_system_id, "link": LinkKind.MAVLINK}  # gateways serve only these
    if isinstance(uav, Uav):
        owner = change_uav(uav=uav, actor=actor, position=None, values=system_id)
    else:
        place = uav.position or (LonLat(*held.location.coords[:2]) if held.location else None)
        if place is None:
            raise NoPlace
        values = system_id | {"name": uav.name, "uav_type": uav.uav_type}
        owner = create_uav(organisation=actor.organisation, actor=actor, position=place, values=values)
    _settle(held, UnknownVehicleState.ADOPTED, actor, owner)
    return owner


@transaction.atomic
def ignore_vehicle(*, vehicle: UnknownVehicle, actor: User) -> None:
    """Hide the vehicle. Raises AlreadySettled if it was adopted."""
    held = _held(vehicle, UnknownVehicleState.NEW, UnknownVehicleState.IGNORED)
    if held.state == UnknownVehicleState.NEW:
        _settle(held, UnknownVehicleState.IGNORED, actor)


@transaction.atomic
def heed_vehicle(*, vehicle: UnknownVehicle, actor: User) -> None:
    """Show an ignored vehicle again. Raises AlreadySettled if it was adopted."""
    held = _held(vehicle, UnknownVehicleState.NEW, UnknownVehicleState.IGNORED)
    if held.state == UnknownVehicleState.IGNORED:
        _settle(held, UnknownVehicleState.NEW, actor)


def _held(vehicle: UnknownVehicle, *states: UnknownVehicleState) -> UnknownVehicle:
    held = UnknownVehicle.objects.select_for_update().filter(pk=vehicle.pk, state__in=states).first()
    if held is None:
        raise AlreadySettled
    return held


def _settle(vehicle: UnknownVehicle, state: UnknownVehicleState, actor: User, uav: Uav | None = None) -> None:
    before = vehicle.state
    vehicle.state, vehicle.uav = state, uav
    vehicle.settled_by, vehicle.settled_at = (None, None) if state == UnknownVehicleState.NEW else (actor, timezone.now())
    vehicle.save(update_fields=["state", "uav", "settled_by", "settled_at"])
    record_change(
        organisation=actor.organisation, actor=actor, action="settle", subject_type="unknown_vehicle", subject_id=vehicle.pk,
        before={"state": str(before)}, after={"state": str(state), "system_id": vehicle.mavlink_system_id, "uav": uav and uav.pk},
    )  # fmt: skip
