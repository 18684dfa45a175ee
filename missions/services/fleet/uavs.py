"""UAVs of an organisation, and updates of their rows from reports: last position, heading, battery."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from django.conf import settings
from django.contrib.gis.geos import Point
from django.db import connection, transaction
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from missions.models import Base, Uav, UavState, UavType
from missions.services.commands.refused import Refused, refuse, refuse_for
from missions.services.fleet.link_changes import refuse_to_cut_off, removal_reasons
from missions.services.fleet.rows import SystemIdQuota, deleted, facts_to_restore, locked, stored
from workspace.models import Organisation, User

FIELDS = (
    "name", "base_name", "state", "serial_number", "mavlink_system_id", "link", "is_simulated", "allows_unsigned", "max_range_m",
    "cruise_speed_mps", "battery_wh", "mass_kg", "reserve_percent", "max_airspeed_mps", "heading_deg", "battery_percent", "sensor",
    "end_action", "external_id", "attributes",
)  # fmt: skip


OF_LINK = ("link", "mavlink_system_id", "is_simulated", "allows_unsigned")


def create_uav(*, organisation: Organisation, actor: User, position: LonLat | None, values: dict[str, Any]) -> Uav:
    """Create a UAV. values has some of FIELDS, name among them, and optionally `base` and `uav_type`; its base supplies a missing position.

    Raises FleetNameTaken, ExternalIdTaken, SystemIdTaken or SystemIdQuota.
    """
    uav = Uav(organisation=organisation)
    _put(uav, values)
    _place(uav, position or LonLat(*values["base"].location.coords))
    with transaction.atomic():
        _refuse_beyond_quota(uav)
        return stored(uav, actor=actor, action="create", before=None, facts=_facts)


def change_uav(
    *,
    uav: Uav,
    actor: User | None,
    position: LonLat | None,
    values: dict[str, Any],
    expected_revision: int | None = None,
    by_simulation: bool = False,
) -> Uav:
    """Change a UAV. When it is retired, its MAVLink system id is released.

    Raises FleetChanged, what create_uav raises, or Refused for another link or system id while a command or flight depends on it. Only
    `by_simulation` changes those of a simulated twin, for which no real aircraft may answer.
    """
    with transaction.atomic():
        held = locked(uav, expected_revision)
        before = _facts(held)
        if held.twin_of_id is not None and not by_simulation and any(values.get(name, before[name]) != before[name] for name in OF_LINK):
            raise refuse_twin(held)
        _put(held, values)
        refuse_to_cut_off(held, before)
        if held.mavlink_system_id != before["mavlink_system_id"]:
            _refuse_beyond_quota(held)
        if position is not None:
            _place(held, position)
        held.revision += 1
        return stored(held, actor=actor, action="change", before=before, facts=_facts)


def delete_uav(*, uav: Uav, actor: User, expected_revision: int | None = None) -> None:
    """Delete a UAV and its credentials.

    Raises FleetChanged, FleetRowInUse where a mission refers to it, or Refused while it flies or a command to it is on its way, and for a
    simulated twin, which is deleted with its UAV.
    """
    if uav.twin_of_id is not None:
        raise refuse_twin(uav)
    with transaction.atomic():
        refuse_for(removal_reasons(locked(uav, expected_revision)))
        deleted(uav, actor=actor, expected_revision=expected_revision, facts=_facts)


def refuse_twin(uav: Uav) -> Refused:
    """Return the refusal of an action on another UAV's simulated twin."""
    return refuse("simulated_twin", _("%(uav)s is the simulated twin of another UAV.") % {"uav": uav.name})


def restore_uav(*, organisation: Organisation, actor: User, key: int) -> Uav:
    """Restore a deleted UAV without its credentials. Raises NotDeleted, or what create_uav raises."""
    facts = facts_to_restore(Uav, organisation=organisation, key=key)
    type_key, base_key = facts.get("uav_type"), facts.get("base")
    uav = Uav(  # an entry older than states, types and bases has none of them
        pk=key, organisation=organisation, revision=facts.get("revision", 1) + 1,
        **{field: facts[field] for field in FIELDS if field in facts},
        uav_type=None if type_key is None else UavType.objects.filter(organisation=organisation, pk=type_key).first(),
    )  # fmt: skip
    base = None if base_key is None else Base.objects.filter(organisation=organisation, pk=base_key).first()
    if base is not None:
        uav.base, uav.base_name = base, base.name  # it may have been renamed
    uav.location = Point(facts["position"], srid=4326)
    located_at = facts.get("located_at")
    uav.located_at = located_at and datetime.fromisoformat(located_at)
    with transaction.atomic():
        _refuse_beyond_quota(uav)
        return stored(uav, actor=actor, action="restore", before=None, facts=_facts)


def _refuse_beyond_quota(uav: Uav) -> None:
    """Raise SystemIdQuota at the quota: an installation has 254 ids, which one organisation could use up.

    Concurrent requests for the last id are serialised.
    """
    if uav.mavlink_system_id is None or Organisation.objects.count() == 1:
        return
    Organisation.objects.select_for_update(no_key=True).filter(pk=uav.organisation_id).values_list("pk").first()
    others = Uav.objects.filter(organisation=uav.organisation_id, mavlink_system_id__isnull=False).exclude(pk=uav.pk)
    if others.count() >= settings.MAX_SYSTEM_IDS:
        raise SystemIdQuota(settings.MAX_SYSTEM_IDS)


def _put(uav: Uav, values: dict[str, Any]) -> None:
    """Set the values. A base supplies the base name; a name alone selects the base of that name, if there is one."""
    for field, value in values.items():
        setattr(uav, field, value)
    if values.get("base") is not None:
        uav.base_name = values["base"].name
    elif "base" in values:
        uav.base_name = values.get("base_name", "")
    elif "base_name" in values:
        uav.base = Base.objects.filter(organisation=uav.organisation, name=uav.base_name).first()
    if uav.state == UavState.RETIRED:
        uav.mavlink_system_id = None


def _place(uav: Uav, position: LonLat) -> None:
    uav.location = Point(*position, srid=4326)
    uav.located_at = timezone.now()


def _facts(uav: Uav) -> dict[str, Any]:
    own = {field: getattr(uav, field) for field in FIELDS}
    return own | {
        "base": uav.base_id, "uav_type": uav.uav_type_id, "position": list(uav.location.coords), "revision": uav.revision,
        "located_at": uav.located_at and uav.located_at.isoformat(),
    }  # fmt: skip


MOVE_FORWARD = """
WITH reported AS (
    SELECT * FROM unnest(%s::bigint[], %s::timestamptz[], %s::float8[], %s::float8[], %s::float8[], %s::float8[])
        AS r(uav_id, measured_at, longitude_deg, latitude_deg, heading_deg, battery_percent)
), held AS (
    SELECT uav.id FROM missions_uav uav JOIN reported ON reported.uav_id = uav.id
    WHERE uav.located_at IS NULL OR uav.located_at < reported.measured_at
    ORDER BY uav.id FOR NO KEY UPDATE OF uav
)
UPDATE missions_uav uav
SET location = ST_SetSRID(ST_MakePoint(reported.longitude_deg, reported.latitude_deg), 4326), located_at = reported.measured_at,
    heading_deg = coalesce(reported.heading_deg, uav.heading_deg),
    battery_percent = coalesce(reported.battery_percent, uav.battery_percent)
FROM reported
WHERE uav.id = reported.uav_id AND uav.id IN (SELECT id FROM held)
    AND (uav.located_at IS NULL OR uav.located_at < reported.measured_at)
"""


@dataclass(frozen=True)
class ReportedPosition:
    uav_id: int
    measured_at: datetime
    longitude_deg: float
    latitude_deg: float
    heading_deg: float | None = None
    battery_percent: float | None = None


def note_reported_positions(*, reports: Sequence[ReportedPosition]) -> int:
    """Store at most one report per UAV, unless it is older than the row. Returns how many rows changed.

    A report is no edit: the row's revision stays.
    """
    if not reports:
        return 0
    columns = ("uav_id", "measured_at", "longitude_deg", "latitude_deg", "heading_deg", "battery_percent")
    with connection.cursor() as cursor:
        cursor.execute(MOVE_FORWARD, [[getattr(report, column) for report in reports] for column in columns])
        return int(cursor.rowcount)
