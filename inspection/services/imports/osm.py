"""Writes what an OSM file says into the assets: new rows, changed rows, and a mark on those that the file no longer has."""

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from django.db import connection, transaction
from django.db.backends.utils import CursorWrapper
from django.db.models import Count
from django.utils.dateparse import parse_datetime
from django.utils.translation import gettext as _

from inspection.importers.osm.file_validator import OsmFileError
from inspection.importers.osm.reader import read_osm
from inspection.importers.osm.records import AssetRecord, Extent, OsmContent
from inspection.models import Asset, DataImport, ImportKind
from inspection.services.ground import hold_ground, mark_ground_changed
from inspection.services.imports import osm_merge
from inspection.services.proposals.reading import Provenance
from inspection.services.supports import number_supports
from workspace.models import DEFAULT_ORGANISATION_ID, User

SYNTHETIC_ATTRIBUTION = "Synthetic data made by Spanwise; nothing in it exists"
SAME_SOURCE_OVERLAP = 0.5  # two files show the same region if their extents share at least half of what they cover together
EXTENT_MARGIN_DEG = 0.01
MANY_NEW = 10_000  # rows after which all that the planner knows of the assets is out of date
HANDFUL = 10  # of one subtype; so few can really all be gone, more of them missing at once were filtered out of the file

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class OsmDifference:
    """What an OSM file would change: numbers of all, and of each action the first few rows."""

    counts: dict[str, Any]  # what is in the file
    numbers: dict[str, int]
    samples: dict[str, list[tuple[Any, ...]]]  # by action: kind, id of the asset, label, WKB, facts before and after


def import_osm(
    *,
    path: Path,
    imported_by: User | None = None,
    is_synthetic: bool = False,
    progress: Progress | None = None,
    replace_edited: bool = False,
    replace_region: bool = False,
    provenance: Provenance | None = None,
) -> DataImport:
    """Bring the assets to what the file says and return the import with its counts; raises OsmFileError and changes nothing.

    The same file again changes nothing. Rows that a curator edited stay as they are (unless replace_edited), and so do rows that a file
    with newer data has written. What an earlier file of the same region had and this one has not is marked as vanished, never deleted:
    see _sources. With replace_region that holds for all OSM assets within the file's extent, whichever file they came from.
    """
    with path.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    with transaction.atomic():
        with _staged(path, progress) as (cursor, content):
            _tell(progress, "writing", 0.0)
            hold_ground()
            data_import = DataImport.objects.create(
                kind=ImportKind.OSM, file_name=path.name[:255], sha256=sha256, is_synthetic=is_synthetic, imported_by=imported_by,
                attribution=SYNTHETIC_ATTRIBUTION if is_synthetic else content.attribution,
                data_timestamp=_timestamp(content.data_timestamp), **_origin(provenance),
            )  # fmt: skip
            values = _values(cursor, content, path, is_synthetic, replace_edited, replace_region, but=data_import)
            values |= {
                "data_import": data_import.pk, "actor": imported_by and imported_by.pk,
                "organisation": imported_by.organisation_id if imported_by else DEFAULT_ORGANISATION_ID,
            }  # fmt: skip
            numbers = _numbers(cursor, values)
            _tell(progress, "writing", 0.2)
            for statement in (
                osm_merge.REMEMBER_CHANGED,
                osm_merge.REMEMBER_GONE,
                osm_merge.VANISH,
                osm_merge.UPDATE,
                osm_merge.KEEP_BESIDE,
            ):
                cursor.execute(statement, values)
            _tell(progress, "writing", 0.4)
            cursor.execute(osm_merge.INSERT, values)
            _tell(progress, "writing", 0.8)
            columns = "" if numbers["new"] > MANY_NEW else "(id, kind, osm_type, osm_id, line_id, vanished_at)"
            cursor.execute(f"ANALYZE inspection_asset {columns}")  # the supports are numbered next, and tiles are asked for soon
        counts = content.counts | numbers | {"extent": content.extent}
        has_changed = any(numbers[key] for key in ("new", "changed", "vanished"))
        if number_supports() or has_changed:
            mark_ground_changed()
        known = DataImport.objects.filter(kind=ImportKind.OSM, is_synthetic=is_synthetic, sha256=sha256).exclude(pk=data_import.pk).first()
        if known is not None and not has_changed:
            data_import.delete()
            known.counts = counts  # of this run, for the caller; the row keeps those of its own
            return known
        data_import.counts = counts
        data_import.save(update_fields=["counts"])
    return data_import


def difference_of_osm(
    *, path: Path, progress: Progress | None = None, replace_edited: bool = False, replace_region: bool = False, most: int = 2_000
) -> OsmDifference:
    """What import_osm would do with the file; nothing is written. Raises OsmFileError."""
    with transaction.atomic():
        with _staged(path, progress) as (cursor, content):
            _tell(progress, "comparing", 0.0)
            values = _values(cursor, content, path, False, replace_edited, replace_region)
            numbers = _numbers(cursor, values)
            _tell(progress, "comparing", 0.6)
            samples = {}
            for action, statement in osm_merge.SAMPLES.items():
                cursor.execute(statement, values | {"most": most})
                samples[action] = cursor.fetchall()
        transaction.set_rollback(True)
    return OsmDifference(content.counts | {"extent": content.extent, "data_timestamp": content.data_timestamp}, numbers, samples)


@contextmanager
def _staged(path: Path, progress: Progress | None) -> Iterator[tuple[CursorWrapper, OsmContent]]:
    """Read the file's records into a temporary table as they come; a cursor beside it, and what is known of all. Raises OsmFileError."""
    with connection.cursor() as cursor:
        cursor.execute(osm_merge.STAGING)
        with cursor.copy(osm_merge.COPY) as copy:

            def take(records: list[AssetRecord]) -> None:
                for row in _rows(records):
                    copy.write_row(row)

            content = read_osm(path, progress, take)
            if not content.kinds:
                raise OsmFileError(_("The file has no power lines, towers, railways or bridges."))
        if content.is_unsorted:
            cursor.execute(osm_merge.KEEP_THE_LAST)
        cursor.execute("ANALYZE osm_staging, inspection_asset")  # right after a first import the planner still takes the table for empty
        yield cursor, content
        cursor.execute("DROP TABLE osm_staging")  # before the end of the transaction: several imports may share one


def _numbers(cursor: CursorWrapper, values: dict[str, Any]) -> dict[str, int]:
    cursor.execute(osm_merge.COUNTS, values)
    names = ("new", "changed", "vanished", "kept", "kept_edited", "kept_newer", "unchanged")
    return dict(zip(names, cursor.fetchone(), strict=True))


def _values(
    cursor: CursorWrapper, content: OsmContent, path: Path, is_synthetic: bool, replace_edited: bool, replace_region: bool,
    *, but: DataImport | None = None,
) -> dict[str, Any]:  # fmt: skip
    """What the statements need to know of the file.

    Files of different regions, even neighbours that overlap, say nothing about each other: only rows written by an import whose extent
    is nearly this one's may vanish, of these only what the header's box holds, if it states one. A file may be filtered (power lines
    only): a subtype of which it has none at all is taken for filtered out, unless there was a handful only or the file has the old name.
    """
    earlier = DataImport.objects.filter(kind=ImportKind.OSM, is_synthetic=is_synthetic)
    if but is not None:
        earlier = earlier.exclude(pk=but.pk)
    sources = [row for row in earlier if _is_same_source(row.counts.get("extent"), content.extent)]
    present = content.kinds
    is_same_name = any(source.file_name == path.name[:255] for source in sources)
    held = Asset.objects.filter(data_import__in=sources, vanished_at=None, osm_id__isnull=False).order_by()
    filtered_out = [
        f"{row['kind']} {row['subtype']}"
        for row in held.values("kind", "subtype").annotate(number=Count("pk"))
        if not present[row["kind"], row["subtype"]] and row["number"] > HANDFUL and not is_same_name
    ]
    box = content.stated_extent or (content.extent if replace_region else None)
    return {
        "timestamp": _timestamp(content.data_timestamp), "replace_edited": replace_edited, "whole_region": replace_region,
        "sources": [source.pk for source in sources], "filtered_out": filtered_out,
        "box": box and shapely.to_wkb(shapely.set_srid(shapely.box(*box), 4326), hex=True, include_srid=True),
    }  # fmt: skip


def _origin(provenance: Provenance | None) -> dict[str, Any]:
    if provenance is None:
        return {}
    return {"licence": provenance.licence, "source_address": provenance.source_address, "fetched_at": provenance.fetched_at}


def _tell(progress: Progress | None, stage: str, share: float) -> None:
    if progress is not None:
        progress(stage, share)


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
