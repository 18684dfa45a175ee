"""Updates a zone set to a file: completely, or not at all with a list of faults."""

import hashlib
from collections import Counter
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

import shapely
from django.contrib.gis.geos import Polygon
from django.db import transaction
from django.utils.dateparse import parse_datetime

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.zones.records import UnreadRecord
from inspection.importers.zones.zone_file import MAX_FILE_BYTES, ZoneFile, ZoneFileError, read_zones
from inspection.models import DataImport, ImportKind, ZoneSet
from inspection.reasons import notes_json
from inspection.services.ground import hold_ground, mark_ground_changed
from inspection.services.imports.osm import SYNTHETIC_ATTRIBUTION
from inspection.services.imports.regions import join_region
from inspection.services.imports.zone_sets import ZoneDifference, difference_of, keep_what_was, store_version, write_difference
from inspection.services.proposals.reading import Provenance
from workspace.models import User
from workspace.reason_texts import message_json

FORMAT_NAMES = {"ed269": "ED-269", "ed318": "ED-318", "openair": "OpenAir", "geojson": "GeoJSON"}


def import_zones(
    *,
    path: Path,
    set_name: str | None = None,
    imported_by: User | None = None,
    is_synthetic: bool = False,
    replace_edited: bool = False,
    replace_all: bool | None = None,
    source_format: str = "",
    leave_out_faulty: bool = False,
    excluded: Sequence[str] = (),
    provenance: Provenance | None = None,
) -> DataImport:
    """Update the set (by default named after the file) to the file, and return the import with its counts.

    Unchanged zones keep their rows; others are changed, added or removed. Those that a curator edited stay unless replace_edited is set.
    Raises ZoneFileError and changes nothing, also when all zones of the set are elsewhere, as they would be removed unnoticed. Naming a
    set, or replace_all, confirms that this is intended.
    """
    content, sha256 = read_zone_file(path, source_format=source_format, leave_out_faulty=leave_out_faulty)
    name = set_name_of(path, set_name)
    with transaction.atomic():
        hold_ground()
        zone_set, _ = ZoneSet.objects.select_related("data_import").get_or_create(name=name)
        if not (set_name is not None if replace_all is None else replace_all):
            refuse_if_elsewhere(zone_set, content, f"--set {name} replaces them, another name keeps both")
        found = difference_of(zone_set, content.zones, replace_edited=replace_edited, unread=content.unread).without(excluded)
        counts = zone_counts(content) | found.numbers | {"removed": len(found.vanished)}
        origin = _origin(content, provenance, is_synthetic=is_synthetic)
        if zone_set.data_import is not None and zone_set.data_import.sha256 == sha256 and not found.changes_something:
            return _seen_again(zone_set.data_import, origin, counts)
        data_import = DataImport.objects.create(
            kind=ImportKind.ZONES, file_name=path.name[:255], sha256=sha256, is_synthetic=is_synthetic, imported_by=imported_by,
            counts=counts, **origin,
        )  # fmt: skip
        make_so(zone_set, found, data_import=data_import, actor=imported_by)
        ZoneSet.objects.filter(pk=zone_set.pk).update(data_import=data_import, source_format=content.source_format)
        join_region(data_import)
    return data_import


def make_so(
    zone_set: ZoneSet,
    found: ZoneDifference,
    *,
    data_import: DataImport,
    actor: User | None,
    edited: frozenset[tuple[str, int]] = frozenset(),
) -> None:
    """Apply a difference, and store the states before and after it as versions. Under hold_ground."""
    if not found.changes_something:
        write_difference(zone_set, found, actor=actor, edited=edited)
        return
    keep_what_was(zone_set)
    write_difference(zone_set, found, actor=actor, edited=edited)
    store_version(zone_set, data_import=data_import, created_by=actor)
    mark_ground_changed()


def read_zone_file(path: Path, *, source_format: str = "", leave_out_faulty: bool = False) -> tuple[ZoneFile, str]:
    """Return the zones of a file and its SHA-256. Raises ZoneFileError, also if the file is not in the stated format."""
    if path.stat().st_size > MAX_FILE_BYTES:
        raise ZoneFileError([GeometryFault("", f"the file is larger than {MAX_FILE_BYTES // 2**20} MiB")])
    data = path.read_bytes()
    content = read_zones(data, leave_out_faulty=leave_out_faulty)
    if source_format and content.source_format != FORMAT_NAMES[source_format]:
        message = f"the file is {content.source_format}, not {FORMAT_NAMES[source_format]} as was said"
        raise ZoneFileError([GeometryFault("", message)])
    return content, hashlib.sha256(data).hexdigest()


def stated_validity(content: ZoneFile) -> tuple[datetime | None, datetime | None]:
    """Return the stated start and end of the file's validity."""
    return _instant(content.valid_from), _instant(content.valid_until)


def _instant(stated: str | None) -> datetime | None:
    return parse_datetime(stated) if stated else None


def set_name_of(path: Path, set_name: str | None) -> str:
    return (set_name or path.stem)[:200]


def refuse_if_elsewhere(zone_set: ZoneSet | None, content: ZoneFile, what_to_do: str) -> None:
    """Raise ZoneFileError if the set has zones, none of which is near those of the file."""
    if zone_set is None or not zone_set.zones.exists():
        return
    near = Polygon.from_bbox(extent_of(content))
    near.srid = 4326
    if not zone_set.zones.filter(geometry__bboverlaps=near).exists():
        raise ZoneFileError([GeometryFault("", f"the set {zone_set.name!r} has zones, all of them elsewhere: {what_to_do}")])


def extent_of(content: ZoneFile) -> tuple[float, float, float, float]:
    """Return west, south, east, north [deg]."""
    west, south, east, north = shapely.total_bounds([zone.geometry for zone in content.zones]).tolist()
    return west, south, east, north


def zone_counts(content: ZoneFile) -> dict[str, Any]:
    """Return the counts of a zone file."""
    return {
        "zones": content.zone_count, "layers": len(content.zones), "format": content.source_format,
        "circles": sum(zone.circle is not None for zone in content.zones),
        "polygons": sum(zone.circle is None for zone in content.zones),
        "with_schedule": sum(zone.schedule is not None for zone in content.zones),
        "restrictions": dict(sorted(Counter(zone.restriction or "not stated" for zone in content.zones).items())),
        "extent": list(extent_of(content)), "provider": content.provider,
        "valid_from": content.valid_from, "valid_until": content.valid_until,
        **notes_json(content.notes),
    } | ({"not_read": [_unread_json(record) for record in content.unread]} if content.unread else {})  # fmt: skip


def _unread_json(record: UnreadRecord) -> dict[str, Any]:
    position = record.fault.position
    return {
        "place": record.fault.place, **message_json(record.fault.why), "position": list(position) if position else None,
        "name": record.name, "bbox": list(record.bbox) if record.bbox else None,
    }  # fmt: skip


def _origin(content: ZoneFile, provenance: Provenance | None, *, is_synthetic: bool) -> dict[str, Any]:
    """Return the source of the zones, as stated by the user or the file."""
    stated: dict[str, Any] = {} if provenance is None else provenance.of_import
    if is_synthetic:
        stated["attribution"] = SYNTHETIC_ATTRIBUTION
    elif not stated.get("attribution"):
        stated["attribution"] = content.provider[:300]
    stated["valid_from"], stated["valid_until"] = stated_validity(content)
    return {name: value for name, value in stated.items() if value}


def _seen_again(data_import: DataImport, origin: dict[str, Any], counts: dict[str, Any]) -> DataImport:
    """Store new facts of the source of a file that is imported again. The row keeps its counts, the caller gets this run's."""
    for name, value in origin.items():
        setattr(data_import, name, value)
    data_import.save(update_fields=list(origin))
    data_import.counts = counts
    return data_import
