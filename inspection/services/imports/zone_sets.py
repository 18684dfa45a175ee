"""The zones of one source: differences to another file, their application, and all former versions."""

import json
import zlib
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import shapely
from django.db import connection, transaction
from django.db.models import Max

from inspection.importers.zones.records import MAX_IDENTIFIER, HeightBand, UnreadRecord, ZoneRecord
from inspection.models import DataImport, NoFlyZone, ZoneSet, ZoneSetVersion, ZoneSubscription
from inspection.services.facts import zone_facts
from inspection.services.ground import hold_ground, mark_ground_changed
from workspace.audit import record_change
from workspace.models import DEFAULT_ORGANISATION_ID, AuditEntry, User

_BATCH = 1_000
_COLUMNS = (
    "identifier", "layer", "name", "geometry", "restriction", "reason", "lower_limit_m", "lower_reference", "upper_limit_m",
    "upper_reference", "source_heights", "circle", "schedule", "properties", "is_edited",
)  # fmt: skip
_STAGING = """
CREATE TEMPORARY TABLE zone_staging (
    identifier text, layer smallint, name text, geometry geometry, restriction text, reason text, lower_limit_m double precision,
    lower_reference text, upper_limit_m double precision, upper_reference text, source_heights jsonb, circle jsonb, schedule jsonb,
    properties jsonb, is_edited boolean
) ON COMMIT DROP
"""
_COPY = f"COPY zone_staging ({', '.join(_COLUMNS)}) FROM STDIN"
_MERGE = f"""
INSERT INTO inspection_noflyzone ({", ".join(_COLUMNS)}, zone_set_id, updated_at)
SELECT {", ".join(_COLUMNS)}, %(zone_set)s, now() FROM zone_staging
ON CONFLICT (zone_set_id, identifier, layer)
DO UPDATE SET updated_at = now(), revision = inspection_noflyzone.revision + 1,
              {", ".join(f"{column} = EXCLUDED.{column}" for column in _COLUMNS[2:])}
"""  # noqa: S608 -- column names only

Key = tuple[str, int]


@dataclass
class ZoneDifference:
    """The changes of a set by other records. kept: manually edited, and the source now states something else, or nothing.

    unread: the source has a record of them with a fault: they stay as they are.
    """

    new: list[ZoneRecord] = field(default_factory=list)
    changed: list[tuple[NoFlyZone, ZoneRecord]] = field(default_factory=list)
    vanished: list[NoFlyZone] = field(default_factory=list)
    kept: list[tuple[NoFlyZone, ZoneRecord | None]] = field(default_factory=list)
    confirmed: list[NoFlyZone] = field(default_factory=list)  # edited, and the source now states the same
    unread: list[NoFlyZone] = field(default_factory=list)
    unchanged: int = 0

    @property
    def numbers(self) -> dict[str, int]:
        return {
            "new": len(self.new), "changed": len(self.changed), "vanished": len(self.vanished), "kept": len(self.kept),
            "unchanged": self.unchanged,
        }  # fmt: skip

    @property
    def changes_something(self) -> bool:
        return bool(self.new or self.changed or self.vanished)

    def without(self, excluded: Collection[str]) -> "ZoneDifference":
        """Return the difference without the changes of these keys, which stay as they are."""
        return replace(
            self,
            new=[record for record in self.new if key_of(record) not in excluded],
            changed=[(zone, record) for zone, record in self.changed if key_of(zone) not in excluded],
            vanished=[zone for zone in self.vanished if key_of(zone) not in excluded],
            kept=[(zone, record) for zone, record in self.kept if key_of(zone) not in excluded],
        )


def key_of(zone: NoFlyZone | ZoneRecord) -> str:
    """Return what names a zone in a difference."""
    return f"zone {zone.layer} {zone.identifier}"


def difference_of(
    zone_set: ZoneSet | None, records: Iterable[ZoneRecord], *, replace_edited: bool = False, unread: Iterable[UnreadRecord] = ()
) -> ZoneDifference:
    """Compare the set's rows with a file or a version; edited rows are kept unless they are to be replaced.

    A zone with an unreadable record does not vanish, as its content in the file is unknown. Where a file has several zones of its
    identifier, their numbers do not match records to zones: the set's zones stay as they are, and records that differ from all of them are
    added.
    """
    found = ZoneDifference()
    held = {(zone.identifier, zone.layer): zone for zone in zone_set.zones.all()} if zone_set else {}
    not_read = {name for record in unread for name in (record.identifier, record.name[:MAX_IDENTIFIER]) if name}
    beside = {identifier: layer for identifier, layer in sorted(held) if identifier in not_read}  # the last layer of each
    for record in records:
        if record.identifier in beside:
            zone = next((zone for zone in held.values() if zone.identifier == record.identifier and says_the_same(zone, record)), None)
            if zone is None:
                beside[record.identifier] += 1
                found.new.append(replace(record, layer=beside[record.identifier]))
            else:
                del held[zone.identifier, zone.layer]
                found.unchanged += 1
            continue
        zone = held.pop((record.identifier, record.layer), None)
        if zone is None:
            found.new.append(record)
        elif says_the_same(zone, record):
            found.unchanged += 1
            if zone.is_edited:
                found.confirmed.append(zone)
        elif zone.is_edited and not replace_edited:
            found.kept.append((zone, record))
        else:
            found.changed.append((zone, record))
    for zone in held.values():
        if zone.identifier in not_read:
            found.unread.append(zone)
        elif zone.is_edited and not replace_edited:
            found.kept.append((zone, None))
        else:
            found.vanished.append(zone)
    return found


def write_difference(zone_set: ZoneSet, found: ZoneDifference, *, actor: User | None, edited: frozenset[Key] = frozenset()) -> None:
    """Apply a difference to the set, under hold_ground; `edited` are the records that count as manually edited."""
    written = [*found.new, *(record for _, record in found.changed)]
    entries = [_entry(actor, "vanished", zone, zone_facts(zone), None) for zone in found.vanished]
    for zone, record in found.changed:
        before = zone_facts(zone)
        after = before | record_facts(record) | {"is_edited": (record.identifier, record.layer) in edited}
        entries.append(_entry(actor, "changed", zone, before, after))
    AuditEntry.objects.bulk_create(entries, batch_size=_BATCH)
    NoFlyZone.objects.filter(pk__in=[zone.pk for zone in found.vanished]).delete()
    following = [zone.pk for zone in found.confirmed if (zone.identifier, zone.layer) not in edited]
    NoFlyZone.objects.filter(pk__in=following).update(is_edited=False)
    with connection.cursor() as cursor:
        cursor.execute(_STAGING)
        with cursor.copy(_COPY) as copy:
            for record in written:
                copy.write_row(_row(record, is_edited=(record.identifier, record.layer) in edited))
        cursor.execute(_MERGE, {"zone_set": zone_set.pk})
        cursor.execute("DROP TABLE zone_staging")  # before the end of the transaction, as several imports may share one


def store_version(zone_set: ZoneSet, *, data_import: DataImport | None, created_by: User | None) -> ZoneSetVersion:
    """Store the set's current zones as a version."""
    zones = [zone_facts(zone) for zone in zone_set.zones.order_by("identifier", "layer")]
    last = zone_set.versions.aggregate(last=Max("number"))["last"] or 0
    return ZoneSetVersion.objects.create(
        zone_set=zone_set, number=last + 1, data_import=data_import, zones=len(zones), created_by=created_by,
        content=zlib.compress(json.dumps(zones).encode(), level=6),
    )  # fmt: skip


def keep_what_was(zone_set: ZoneSet) -> None:
    """Store the set's current zones as a version before a change, unless one has them."""
    if not zone_set.zones.exists():
        return
    last = zone_set.versions.defer("content").first()
    if last is None or zone_set.zones.filter(updated_at__gt=last.created_at).exists() or zone_set.zones.count() != last.zones:
        store_version(zone_set, data_import=zone_set.data_import, created_by=None)


def empty_zone_set(*, zone_set: ZoneSet, actor: User) -> None:
    """Delete all zones of a set. The set stays, without zones: each of its versions can be restored.

    Its subscription is paused, as it would soon be proposed again. An empty set is unchanged.
    """
    with transaction.atomic():
        hold_ground()
        held = ZoneSet.objects.select_for_update(of=["self"]).get(pk=zone_set.pk)
        found = difference_of(held, [], replace_edited=True)
        ZoneSubscription.objects.filter(zone_set=held).update(is_active=False)
        if not found.vanished:
            return
        keep_what_was(held)
        write_difference(held, found, actor=actor)
        ZoneSet.objects.filter(pk=held.pk).update(data_import=None)
        record_change(
            organisation=actor.organisation, actor=actor, action="emptied", subject_type="zone_set", subject_id=held.pk,
            before={"name": held.name, "zones": len(found.vanished)}, after={"name": held.name, "zones": 0},
        )  # fmt: skip
        mark_ground_changed()


def records_of_version(version: ZoneSetVersion) -> tuple[list[ZoneRecord], frozenset[Key]]:
    """Return the version's records, and which of them were manually edited."""
    facts = json.loads(zlib.decompress(bytes(version.content)))
    edited = frozenset((zone["identifier"], zone["layer"]) for zone in facts if zone["is_edited"])
    return [_record(zone) for zone in facts], edited


def says_the_same(zone: NoFlyZone, record: ZoneRecord) -> bool:
    if any(getattr(zone, name) != value for name, value in _facts(record).items()):
        return False
    return bool(shapely.from_wkb(bytes(zone.geometry.wkb)).equals_exact(record.geometry, 0.0))


def record_facts(record: ZoneRecord) -> dict[str, Any]:
    """Return the keys of zone_facts, as far as a record has them."""
    geometry = json.loads(shapely.to_geojson(record.geometry))
    return _facts(record) | {"geometry": {"type": geometry["type"], "coordinates": geometry["coordinates"]}}


def _facts(record: ZoneRecord) -> dict[str, Any]:
    band = record.band
    return {
        "name": record.name, "restriction": record.restriction, "reason": record.reason, "lower_limit_m": band.lower_limit_m,
        "lower_reference": band.lower_reference, "upper_limit_m": band.upper_limit_m, "upper_reference": band.upper_reference,
        "source_heights": band.as_stated, "circle": record.circle, "schedule": record.schedule, "properties": record.properties,
    }  # fmt: skip


def _row(record: ZoneRecord, *, is_edited: bool) -> Sequence[Any]:
    geometry = shapely.to_wkb(shapely.set_srid(record.geometry, 4326), hex=True, include_srid=True)
    values: dict[str, Any] = {
        "identifier": record.identifier, "layer": record.layer, "geometry": geometry, "is_edited": is_edited, **_facts(record),
    }  # fmt: skip
    for column in ("source_heights", "circle", "schedule", "properties"):
        values[column] = None if values[column] is None else json.dumps(values[column])
    return [values[column] for column in _COLUMNS]


def _record(facts: dict[str, Any]) -> ZoneRecord:
    band = HeightBand(
        facts["lower_limit_m"], facts["lower_reference"], facts["upper_limit_m"], facts["upper_reference"], facts["source_heights"]
    )
    geometry = shapely.from_geojson(json.dumps(facts["geometry"]))
    if not isinstance(geometry, shapely.MultiPolygon):
        raise TypeError(f"a zone's area is a MultiPolygon, not a {geometry.geom_type}")
    return ZoneRecord(
        identifier=facts["identifier"], layer=facts["layer"], name=facts["name"], geometry=geometry,
        band=band, restriction=facts["restriction"], reason=facts["reason"], circle=facts["circle"], schedule=facts["schedule"],
        properties=facts["properties"],
    )  # fmt: skip


def _entry(actor: User | None, action: str, zone: NoFlyZone, before: dict[str, Any], after: dict[str, Any] | None) -> AuditEntry:
    return AuditEntry(
        organisation_id=actor.organisation_id if actor else DEFAULT_ORGANISATION_ID, actor=actor, action=action, subject_type="zone",
        subject_id=str(zone.pk), before=before, after=after,
    )  # fmt: skip
