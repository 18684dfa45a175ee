"""Writes what an OSM file says into the assets: new rows, changed rows, and a mark on those that the file no longer has."""

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from django.db import connection, transaction
from django.db.backends.utils import CursorWrapper
from django.db.models import Count
from django.utils.dateparse import parse_datetime

from inspection.models import Asset, DataImport, ImportKind
from inspection.osm.file_gate import OsmFileError
from inspection.osm.reader import read_osm
from inspection.osm.records import AssetRecord, Extent, OsmContent
from inspection.services.ground import hold_ground, mark_ground_changed
from inspection.services.supports import number_supports
from workspace.models import User

SYNTHETIC_ATTRIBUTION = "Synthetic data made by Spanwise; nothing in it exists"
SAME_SOURCE_OVERLAP = 0.5  # two files show the same region if their extents share at least half of what they cover together
EXTENT_MARGIN_DEG = 0.01
HANDFUL = 10  # of one subtype; so few can really all be gone, more of them missing at once were filtered out of the file

_COLUMNS = (
    "kind", "subtype", "osm_type", "osm_id", "geometry", "centre", "name", "ref", "operator", "voltages_v", "max_voltage_v", "circuits",
    "height_m", "length_m", "is_flyable", "node_osm_ids", "tags", "parts", "content_hash",
)  # fmt: skip

_STAGING = """
CREATE TEMPORARY TABLE osm_staging (
    kind text, subtype text, osm_type text, osm_id bigint, geometry geometry, centre geometry, name text, ref text, operator text,
    voltages_v integer[], max_voltage_v integer, circuits smallint, height_m double precision, length_m double precision,
    is_flyable boolean, node_osm_ids bigint[], tags jsonb, parts jsonb, content_hash text
) ON COMMIT DROP
"""
_COPY = f"COPY osm_staging ({', '.join(_COLUMNS)}) FROM STDIN"

_MATCHES = """
SELECT count(*) FILTER (WHERE a.is_edited),
       count(*) FILTER (WHERE NOT a.is_edited AND i.data_timestamp > %(timestamp)s),
       count(*) FILTER (WHERE NOT a.is_edited AND (i.data_timestamp > %(timestamp)s) IS NOT TRUE
                              AND a.content_hash = s.content_hash AND a.vanished_at IS NULL)
FROM inspection_asset a
JOIN osm_staging s USING (kind, osm_type, osm_id)
LEFT JOIN inspection_dataimport i ON i.id = a.data_import_id
"""
_UPDATE = """
UPDATE inspection_asset a
SET subtype = s.subtype, geometry = s.geometry, centre = s.centre, name = s.name, ref = s.ref, operator = s.operator,
    voltages_v = s.voltages_v, max_voltage_v = s.max_voltage_v, circuits = s.circuits, height_m = s.height_m, length_m = s.length_m,
    is_flyable = s.is_flyable, node_osm_ids = s.node_osm_ids, tags = s.tags, parts = s.parts, content_hash = s.content_hash,
    data_import_id = %(data_import)s, vanished_at = NULL, updated_at = now()
FROM osm_staging s
WHERE a.kind = s.kind AND a.osm_type = s.osm_type AND a.osm_id = s.osm_id AND NOT a.is_edited
  AND (a.content_hash <> s.content_hash OR a.vanished_at IS NOT NULL)
  AND NOT EXISTS (SELECT FROM inspection_dataimport i WHERE i.id = a.data_import_id AND i.data_timestamp > %(timestamp)s)
"""
_INSERT = f"""
INSERT INTO inspection_asset ({", ".join(_COLUMNS)}, data_import_id, is_edited, updated_at)
SELECT {", ".join(f"s.{column}" for column in _COLUMNS)}, %(data_import)s, false, now()
FROM osm_staging s
WHERE NOT EXISTS (SELECT FROM inspection_asset a WHERE a.kind = s.kind AND a.osm_type = s.osm_type AND a.osm_id = s.osm_id)
ORDER BY s.kind DESC, s.osm_id
"""  # noqa: S608 -- column names only
_VANISH = """
UPDATE inspection_asset a
SET vanished_at = now(), updated_at = now(), data_import_id = %(data_import)s
WHERE a.osm_id IS NOT NULL AND NOT a.is_edited AND a.vanished_at IS NULL
  AND a.data_import_id = ANY(%(sources)s)
  AND a.kind || ' ' || a.subtype <> ALL(%(filtered_out)s)
  AND NOT EXISTS (SELECT FROM osm_staging s WHERE s.kind = a.kind AND s.osm_type = a.osm_type AND s.osm_id = a.osm_id)
  AND NOT EXISTS (SELECT FROM inspection_dataimport i WHERE i.id = a.data_import_id AND i.data_timestamp > %(timestamp)s)
  AND (%(box)s::geometry IS NULL OR ST_Intersects(ST_Points(a.geometry), %(box)s::geometry))
"""


def import_osm(
    *, path: Path, imported_by: User | None = None, is_synthetic: bool = False, progress: Callable[[str, float], None] | None = None
) -> DataImport:
    """Bring the assets to what the file says and return the import with its counts; raises OsmFileError and changes nothing.

    The same file again changes nothing. Rows that a curator edited stay as they are, and so do rows that a file with newer data has
    written. What an earlier file of the same region had and this one has not is marked as vanished, never deleted: see _vanish.
    """
    content = read_osm(path, progress)
    if not content.records:
        raise OsmFileError("The file has no power lines, towers, railways or bridges.")
    with path.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    if progress is not None:
        progress("writing", 0.0)
    with transaction.atomic():
        hold_ground()
        earlier = DataImport.objects.filter(kind=ImportKind.OSM, is_synthetic=is_synthetic)
        sources = [row for row in earlier if _is_same_source(row.counts.get("extent"), content.extent)]
        data_import = DataImport.objects.create(
            kind=ImportKind.OSM, file_name=path.name[:255], sha256=sha256, is_synthetic=is_synthetic, imported_by=imported_by,
            attribution=SYNTHETIC_ATTRIBUTION if is_synthetic else content.attribution, data_timestamp=_timestamp(content.data_timestamp),
        )  # fmt: skip
        written = _write(content, data_import, sources)
        counts = content.counts | written | {"extent": content.extent}
        has_changed = any(written[key] for key in ("new", "changed", "vanished"))
        if number_supports() or has_changed:
            mark_ground_changed()
        known = next((row for row in earlier if row.sha256 == sha256), None)
        if known is not None and not has_changed:
            data_import.delete()
            known.counts = counts  # of this run, for the caller; the row keeps those of its own
            return known
        data_import.counts = counts
        data_import.save(update_fields=["counts"])
    return data_import


def _write(content: OsmContent, data_import: DataImport, sources: Sequence[DataImport]) -> dict[str, int]:
    values = {"data_import": data_import.pk, "timestamp": data_import.data_timestamp}
    with connection.cursor() as cursor:
        cursor.execute(_STAGING)
        with cursor.copy(_COPY) as copy:
            for row in _rows(content.records):
                copy.write_row(row)
        cursor.execute("ANALYZE osm_staging, inspection_asset")  # right after a first import the planner still takes the table for empty
        cursor.execute(_MATCHES, values)
        edited, newer, unchanged = cursor.fetchone()
        cursor.execute(_UPDATE, values)
        changed = cursor.rowcount
        vanished = _vanish(cursor, content, data_import, sources)
        cursor.execute(_INSERT, values)
        new = cursor.rowcount
        cursor.execute("ANALYZE inspection_asset (id, kind, osm_type, osm_id, line_id, vanished_at)")  # for what numbers the supports next
        cursor.execute("DROP TABLE osm_staging")  # before the end of the transaction: several imports may share one
    return {"new": new, "changed": changed, "unchanged": unchanged, "vanished": vanished, "kept_edited": edited, "kept_newer": newer}


def _vanish(cursor: CursorWrapper, content: OsmContent, data_import: DataImport, sources: Sequence[DataImport]) -> int:
    """Mark what an earlier file of the same region had and this one has not.

    Files of different regions, even neighbours that overlap, say nothing about each other: only rows written by an import whose extent
    is nearly this one's are looked at, of these only what the header's box holds, if it states one. A file may be filtered (power lines
    only): a subtype of which it has none at all is taken for filtered out, unless there was a handful only or the file has the old name.
    """
    if not sources:
        return 0
    present = Counter((record.kind, record.subtype) for record in content.records)
    is_same_name = any(source.file_name == data_import.file_name for source in sources)
    held = Asset.objects.filter(data_import__in=sources, vanished_at=None, osm_id__isnull=False).order_by()
    filtered_out = [
        f"{row['kind']} {row['subtype']}"
        for row in held.values("kind", "subtype").annotate(number=Count("pk"))
        if not present[row["kind"], row["subtype"]] and row["number"] > HANDFUL and not is_same_name
    ]
    box = None
    if content.stated_extent is not None:
        box = shapely.to_wkb(shapely.set_srid(shapely.box(*content.stated_extent), 4326), hex=True, include_srid=True)
    values = {"data_import": data_import.pk, "timestamp": data_import.data_timestamp, "box": box, "filtered_out": filtered_out}
    cursor.execute(_VANISH, values | {"sources": [source.pk for source in sources]})
    return int(cursor.rowcount)


def _is_same_source(earlier: Sequence[float] | None, extent: Extent | None) -> bool:
    if earlier is None or extent is None:
        return False
    margin = EXTENT_MARGIN_DEG  # a single tower has an extent too
    one, other = (
        shapely.box(west - margin, south - margin, east + margin, north + margin) for west, south, east, north in (earlier, extent)
    )
    return bool(one.intersection(other).area >= SAME_SOURCE_OVERLAP * one.union(other).area)


def _rows(records: Sequence[AssetRecord]) -> Iterator[tuple[Any, ...]]:
    geometries = np.array([record.geometry for record in records], dtype=object)
    wkb = shapely.to_wkb(shapely.set_srid(geometries, 4326), hex=True, include_srid=True)
    centres = shapely.points(np.array([record.centre for record in records], dtype=np.float64))
    centre_wkb = shapely.to_wkb(shapely.set_srid(centres, 4326), hex=True, include_srid=True)
    for record, geometry, centre in zip(records, wkb, centre_wkb, strict=True):
        yield (
            record.kind, record.subtype, record.osm_type, record.osm_id, geometry, centre, record.name[:255], record.ref[:255],
            record.operator[:255], list(record.voltages_v), max(record.voltages_v, default=None), record.circuits, record.height_m,
            record.length_m, record.is_flyable, list(record.node_osm_ids), json.dumps(record.tags), json.dumps(record.parts),
            record.content_hash,
        )  # fmt: skip


def _timestamp(text: str | None) -> datetime | None:
    try:
        moment = parse_datetime(text or "")
    except ValueError:
        return None
    return moment.replace(tzinfo=moment.tzinfo or UTC) if moment else None
