"""Writes the zones of a file as one set: all of them, or none and the list of faults."""

import hashlib
import json
from collections import Counter
from pathlib import Path
from typing import Any

import shapely
from django.contrib.gis.geos import Polygon
from django.db import connection, transaction

from inspection.models import DataImport, ImportKind, NoFlyZone, ZoneSet
from inspection.services.ground import hold_ground, mark_ground_changed
from inspection.services.osm_import import SYNTHETIC_ATTRIBUTION
from inspection.zones.geometry_gate import GeometryFault
from inspection.zones.records import ZoneRecord
from inspection.zones.zone_file import MAX_FILE_BYTES, ZoneFileError, read_zones
from workspace.models import User

_COLUMNS = (
    "identifier", "layer", "name", "geometry", "restriction", "reason", "lower_limit_m", "lower_reference", "upper_limit_m",
    "upper_reference", "source_heights", "circle", "schedule", "properties",
)  # fmt: skip
_STAGING = """
CREATE TEMPORARY TABLE zone_staging (
    identifier text, layer smallint, name text, geometry geometry, restriction text, reason text, lower_limit_m double precision,
    lower_reference text, upper_limit_m double precision, upper_reference text, source_heights jsonb, circle jsonb, schedule jsonb,
    properties jsonb
) ON COMMIT DROP
"""
_COPY = f"COPY zone_staging ({', '.join(_COLUMNS)}) FROM STDIN"
_MERGE = f"""
INSERT INTO inspection_noflyzone ({", ".join(_COLUMNS)}, zone_set_id, updated_at)
SELECT {", ".join(_COLUMNS)}, %(zone_set)s, now() FROM zone_staging
ON CONFLICT (zone_set_id, identifier, layer)
DO UPDATE SET updated_at = now(), {", ".join(f"{column} = EXCLUDED.{column}" for column in _COLUMNS[2:])}
"""  # noqa: S608 -- column names only


def import_zones(*, path: Path, set_name: str | None = None, imported_by: User | None = None, is_synthetic: bool = False) -> DataImport:
    """Make the set (by default named after the file) what the file says, and return the import with its counts.

    Zones that are the same keep their rows; others are changed, added or taken out. Raises ZoneFileError and changes nothing, also
    when only the name of the file is that of a set whose zones are all elsewhere: they would be gone unnoticed.
    """
    if path.stat().st_size > MAX_FILE_BYTES:
        raise ZoneFileError([GeometryFault("", f"the file is larger than {MAX_FILE_BYTES // 2**20} MiB")])
    data = path.read_bytes()
    sha256 = hashlib.sha256(data).hexdigest()
    content = read_zones(data)
    name = (set_name or path.stem)[:200]
    with transaction.atomic():
        hold_ground()
        zone_set, _ = ZoneSet.objects.select_related("data_import").get_or_create(name=name)
        extent = shapely.total_bounds([zone.geometry for zone in content.zones]).tolist()
        if set_name is None and _is_elsewhere(zone_set, extent):
            raise ZoneFileError(
                [
                    GeometryFault(
                        "", f"the set {name!r} has zones, all of them elsewhere: --set {name} replaces them, another name keeps both"
                    )
                ]
            )
        written = _write(zone_set, content.zones, keep=_is_already_in(zone_set, sha256, len(content.zones)))
        counts: dict[str, Any] = {
            "zones": content.zone_count, "layers": len(content.zones), "format": content.source_format,
            "circles": sum(zone.circle is not None for zone in content.zones),
            "polygons": sum(zone.circle is None for zone in content.zones),
            "with_schedule": sum(zone.schedule is not None for zone in content.zones),
            "restrictions": dict(sorted(Counter(zone.restriction or "not stated" for zone in content.zones).items())),
            "extent": extent, **written,
        }  # fmt: skip
        has_changed = any(written[key] for key in ("new", "changed", "removed"))
        if zone_set.data_import is not None and zone_set.data_import.sha256 == sha256 and not has_changed:
            zone_set.data_import.counts = counts  # of this run, for the caller; the row keeps those of its own
            return zone_set.data_import
        data_import = DataImport.objects.create(
            kind=ImportKind.ZONES, file_name=path.name[:255], sha256=sha256, is_synthetic=is_synthetic, imported_by=imported_by,
            counts=counts, attribution=SYNTHETIC_ATTRIBUTION if is_synthetic else "",
        )  # fmt: skip
        ZoneSet.objects.filter(pk=zone_set.pk).update(data_import=data_import, source_format=content.source_format)
        if has_changed:
            mark_ground_changed()
    return data_import


def _is_elsewhere(zone_set: ZoneSet, extent: list[float]) -> bool:
    """The set has zones, and none of them comes near to the extent."""
    near = Polygon.from_bbox(extent)
    near.srid = 4326
    return zone_set.zones.exists() and not zone_set.zones.filter(geometry__bboverlaps=near).exists()


def _is_already_in(zone_set: ZoneSet, sha256: str, number: int) -> bool:
    """The same file was read into the set before and all of its zones are there: what a curator changed since then stays."""
    return zone_set.data_import is not None and zone_set.data_import.sha256 == sha256 and zone_set.zones.count() == number


def _write(zone_set: ZoneSet, records: list[ZoneRecord], *, keep: bool) -> dict[str, int]:
    if keep:
        return {"new": 0, "changed": 0, "unchanged": len(records), "removed": 0}
    held = {(zone.identifier, zone.layer): zone for zone in zone_set.zones.all()}
    new, changed = [], []
    for record in records:
        zone = held.pop((record.identifier, record.layer), None)
        if zone is None:
            new.append(record)
        elif not _says_the_same(zone, record):
            changed.append(record)
    NoFlyZone.objects.filter(pk__in=[zone.pk for zone in held.values()]).delete()
    with connection.cursor() as cursor:
        cursor.execute(_STAGING)
        with cursor.copy(_COPY) as copy:
            for record in changed + new:
                copy.write_row(_row(record))
        cursor.execute(_MERGE, {"zone_set": zone_set.pk})
        cursor.execute("DROP TABLE zone_staging")  # before the end of the transaction: several imports may share one
    return {"new": len(new), "changed": len(changed), "unchanged": len(records) - len(new) - len(changed), "removed": len(held)}


def _facts(record: ZoneRecord) -> dict[str, Any]:
    band = record.band
    return {
        "name": record.name, "restriction": record.restriction, "reason": record.reason, "lower_limit_m": band.lower_limit_m,
        "lower_reference": band.lower_reference, "upper_limit_m": band.upper_limit_m, "upper_reference": band.upper_reference,
        "source_heights": band.as_stated, "circle": record.circle, "schedule": record.schedule, "properties": record.properties,
    }  # fmt: skip


def _row(record: ZoneRecord) -> tuple[Any, ...]:
    geometry = shapely.to_wkb(shapely.set_srid(record.geometry, 4326), hex=True, include_srid=True)
    values: dict[str, Any] = {"identifier": record.identifier, "layer": record.layer, "geometry": geometry, **_facts(record)}
    for column in ("source_heights", "circle", "schedule", "properties"):
        values[column] = None if values[column] is None else json.dumps(values[column])
    return tuple(values[column] for column in _COLUMNS)


def _says_the_same(zone: NoFlyZone, record: ZoneRecord) -> bool:
    if any(getattr(zone, field) != value for field, value in _facts(record).items()):
        return False
    return bool(shapely.from_wkb(bytes(zone.geometry.wkb)).equals_exact(record.geometry, 0.0))
