"""UAV types and bases of an organisation."""

from typing import Any

from django.contrib.gis.geos import Point
from django.db import transaction
from django.db.models.functions import Now

from inspection.geodesy import LonLat
from missions.models import Base, Uav, UavType
from missions.services.fleet.rows import deleted, facts_to_restore, locked, stored
from workspace.models import Organisation, User

TYPE_FIELDS = (
    "name", "max_range_m", "range_unlimited", "cruise_speed_mps", "battery_wh", "mass_kg", "reserve_percent", "max_airspeed_mps",
    "rotor_disk_m2", "hover_power_w", "sensors", "cameras",
)  # fmt: skip


def create_uav_type(*, organisation: Organisation, actor: User, values: dict[str, Any]) -> UavType:
    """Create a type. values has some of TYPE_FIELDS, name among them. Raises FleetNameTaken."""
    return stored(UavType(organisation=organisation, **values), actor=actor, action="create", before=None, facts=_type_facts)


def change_uav_type(*, uav_type: UavType, actor: User, values: dict[str, Any], expected_revision: int | None) -> UavType:
    """Change a type. Raises FleetChanged or FleetNameTaken."""
    with transaction.atomic():
        held = locked(uav_type, expected_revision)
        before = _type_facts(held)
        for field, value in values.items():
            setattr(held, field, value)
        held.revision += 1
        return stored(held, actor=actor, action="change", before=before, facts=_type_facts)


def delete_uav_type(*, uav_type: UavType, actor: User, expected_revision: int | None) -> None:
    """Delete a type. Raises FleetChanged, or FleetRowInUse while a UAV is of this type."""
    deleted(uav_type, actor=actor, expected_revision=expected_revision, facts=_type_facts)


def restore_uav_type(*, organisation: Organisation, actor: User, key: int) -> UavType:
    """Restore a deleted type. Raises NotDeleted or FleetNameTaken."""
    facts = facts_to_restore(UavType, organisation=organisation, key=key)
    values = {field: facts[field] for field in TYPE_FIELDS if field in facts}  # it may have been deleted before a field existed
    row = UavType(pk=key, organisation=organisation, revision=facts["revision"] + 1, **values)
    return stored(row, actor=actor, action="restore", before=None, facts=_type_facts)


def create_base(*, organisation: Organisation, actor: User, position: LonLat, values: dict[str, Any]) -> Base:
    """Create a base. values has the name and optionally a note. Raises FleetNameTaken."""
    row = Base(organisation=organisation, location=Point(*position, srid=4326), **values)
    return stored(row, actor=actor, action="create", before=None, facts=_base_facts)


def change_base(*, base: Base, actor: User, position: LonLat | None, values: dict[str, Any], expected_revision: int | None) -> Base:
    """Change a base. Its UAVs take over a new name and keep their own positions. Raises FleetChanged or FleetNameTaken."""
    with transaction.atomic():
        held = locked(base, expected_revision)
        before = _base_facts(held)
        for field, value in values.items():
            setattr(held, field, value)
        if position is not None:
            held.location = Point(*position, srid=4326)
        held.revision += 1
        stored(held, actor=actor, action="change", before=before, facts=_base_facts)
        Uav.objects.filter(base=held).update(base_name=held.name, updated_at=Now())
        return held


def delete_base(*, base: Base, actor: User, expected_revision: int | None) -> None:
    """Delete a base. Raises FleetChanged, or FleetRowInUse while it is the base of a UAV."""
    deleted(base, actor=actor, expected_revision=expected_revision, facts=_base_facts)


def restore_base(*, organisation: Organisation, actor: User, key: int) -> Base:
    """Restore a deleted base. Raises NotDeleted or FleetNameTaken."""
    facts = facts_to_restore(Base, organisation=organisation, key=key)
    row = Base(
        pk=key, organisation=organisation, name=facts["name"], note=facts["note"], location=Point(facts["position"], srid=4326),
        revision=facts["revision"] + 1,
    )  # fmt: skip
    return stored(row, actor=actor, action="restore", before=None, facts=_base_facts)


def _type_facts(row: UavType) -> dict[str, Any]:
    return {field: getattr(row, field) for field in TYPE_FIELDS} | {"revision": row.revision}


def _base_facts(row: Base) -> dict[str, Any]:
    return {"name": row.name, "note": row.note, "position": list(row.location.coords), "revision": row.revision}
