"""Saying which simulated airframe flies for a type of UAV."""

from django.db import transaction

from missions.models import UavType
from simulation.flight.airframe import AIRFRAMES
from simulation.models import SimulatedAirframe
from simulation.selectors import chosen_airframe
from workspace.models import User
from workspace.services import record_change


class NoSuchAirframe(ValueError):
    """There is no airframe of that code."""


def choose_airframe(*, uav_type: UavType, airframe: str | None, actor: User) -> None:
    """None: whichever is nearest. Raises NoSuchAirframe."""
    if airframe is not None and airframe not in AIRFRAMES:
        raise NoSuchAirframe(airframe)
    with transaction.atomic():
        before = chosen_airframe(uav_type)
        if airframe is None:
            SimulatedAirframe.objects.filter(uav_type=uav_type).delete()
        else:
            SimulatedAirframe.objects.update_or_create(uav_type=uav_type, defaults={"airframe": airframe})
        if before != airframe:
            record_change(
                organisation=uav_type.organisation, actor=actor, action="changed", subject_type="uavtype", subject_id=uav_type.pk,
                before={"simulated_airframe": before}, after={"simulated_airframe": airframe},
            )  # fmt: skip
