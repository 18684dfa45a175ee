"""UAVs of an organisation."""

from typing import Any

from django.contrib.gis.geos import Point
from django.db import IntegrityError, transaction
from django.db.models import ProtectedError

from inspection.geodesy import LonLat
from missions.models import Uav
from workspace.models import Organisation, User
from workspace.services import record_change

FIELDS = ("name", "base_name", "max_range_m", "cruise_speed_mps", "battery_percent", "sensor", "end_action")


class NameTaken(Exception):
    """Another UAV of the organisation has this name."""


class UavInUse(Exception):
    """A mission points at the UAV."""


def create_uav(*, organisation: Organisation, actor: User, position: LonLat, values: dict[str, Any]) -> Uav:
    """values has some of FIELDS, name among them. Raises NameTaken."""
    uav = Uav(organisation=organisation, location=Point(*position, srid=4326), **values)
    return _save(uav, actor, "create", before=None)


def change_uav(*, uav: Uav, actor: User, position: LonLat | None, values: dict[str, Any]) -> Uav:
    """Raises NameTaken."""
    before = _summary(uav)
    for field, value in values.items():
        setattr(uav, field, value)
    if position is not None:
        uav.location = Point(*position, srid=4326)
    return _save(uav, actor, "change", before=before)


def delete_uav(*, uav: Uav, actor: User) -> None:
    """Raises UavInUse."""
    before, key = _summary(uav), uav.pk
    try:
        with transaction.atomic():
            uav.delete()
            record_change(organisation=uav.organisation, actor=actor, action="delete", subject_type="uav", subject_id=key, before=before)
    except ProtectedError as error:
        raise UavInUse from error


def _save(uav: Uav, actor: User, action: str, *, before: Any) -> Uav:
    try:
        with transaction.atomic():
            uav.save()
            record_change(
                organisation=uav.organisation,
                actor=actor,
                action=action,
                subject_type="uav",
                subject_id=uav.pk,
                before=before,
                after=_summary(uav),
            )
    except IntegrityError as error:
        if "uav_name_unique" in str(error):
            raise NameTaken from error
        raise
    return uav


def _summary(uav: Uav) -> dict[str, Any]:
    return {"position": list(uav.location.coords)} | {field: getattr(uav, field) for field in FIELDS}
