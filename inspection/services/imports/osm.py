"""Updates assets to an OSM file: new rows, changed rows, and vanished ones that the file no longer has."""

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
from django.db import transaction
from django.db.backends.utils import CursorWrapper
from django.db.models import Count
from django.utils.dateparse import parse_datetime

from inspection.importers.osm.file_validator import OsmFileError
from inspection.importers.osm.reader import read_osm
from inspection.importers.osm.records import Extent, OsmAssetRecord, OsmContent
from inspection.models import ROW_ACTIONS, Asset, ChangeAction, DataImport, ImportKind
from inspection.services.ground import hold_ground, mark_ground_changed, number_supports
from inspection.services.imports.asset_merge import UNCHANGED, Merge, MergeSource, Sample, staging
from inspection.services.imports.regions import join_region
from inspection.services.proposals.reading import Provenance
from operation.reasons import Reason
from workspace.models import User

SYNTHETIC_ATTRIBUTION = "Synthetic data made by Spanwise; nothing in it exists"
SAME_SOURCE_OVERLAP = 0.5  # two files show the same region if their extents share at least half of their union
EXTENT_MARGIN_DEG = 0.01
HANDFUL = 10  # of one subtype; so few may really have vanished, while more missing at once were filtered out of the file

_IS_NEWER = "EXISTS (SELECT FROM inspection_dataimport i WHERE i.id = a.data_import_id AND i.data_timestamp > %(timestamp)s)"

Progress = Callable[[Reason, float], None]


# Files of different regions, even overlapping neighbours, are independent: only rows written by an import with nearly the same extent may
# vanish, and only those in the header's box, if it states one.
OPENSTREETMAP = MergeSource(
    same="a.kind = s.kind AND a.osm_type = s.osm_type AND a.osm_id = s.osm_id",
    newer=_IS_NEWER,
    missing=f"""
a.osm_id IS NOT NULL AND NOT a.is_edited AND a.vanished_at IS NULL
AND (a.data_import_id = ANY(%(sources)s) OR %(whole_region)s)
AND a.kind || ' ' || a.subtype <> ALL(%(filtered_out)s)
AND NOT {_IS_NEWER}
AND (%(box)s::geometry IS NULL OR ST_Intersects(ST_Points(a.geometry), %(box)s::geometry))""",
    facts=("osm_type", "osm_id", "node_osm_ids", "parts", "content_hash", "data_import_id"),
    order="a.id, s.kind, s.osm_id",
)
# Of duplicate objects in a file the last one counts.
_KEEP_THE_LAST = """
DELETE FROM asset_staging s USING (
    SELECT kind, osm_type, osm_id, max(id) AS last FROM asset_staging GROUP BY kind, osm_type, osm_id HAVING count(*) > 1
) twice
WHERE s.kind = twice.kind AND s.osm_type = twice.osm_type AND s.osm_id = twice.osm_id AND s.id <> twice.last
"""


@dataclass(frozen=True)
class OsmDifference:
    """The changes of an OSM file: all totals, and the first few rows of each action."""

    counts: dict[str, Any]  # content of the file
    numbers: dict[str, int]
    samples: dict[ChangeAction, list[Sample]]


def import_osm(
    *,
    path: Path,
    imported_by: User | None = None,
    is_synthetic: bool = False,
    progress: Progress | None = None,
    replace_edited: bool = False,
    replace_region: bool = False,
    excluded: Sequence[str] = (),
    provenance: Provenance | None = None,
) -> DataImport:
    """Update the assets to the file and return the import with its counts. Raises OsmFileError and changes nothing.

    Importing the same file again changes nothing. Rows that a curator edited stay (unless replace_edited), and so do rows from a file with
    newer data. Assets of an earlier file of the same region that are missing from this one are marked as vanished, never deleted: see
    _sources. With replace_region that applies to all OSM assets within the file's extent, whatever file they came from. `excluded` names
    rows of the difference that stay as they are.
    """
    with path.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    with transaction.atomic():
        with _staged(path, progress) as (cursor, content):
            _notify(progress, Reason("writing"), 0.0)
            hold_ground()
            data_import = DataImport.objects.create(
                kind=ImportKind.OSM, file_name=path.name[:255], sha256=sha256, is_synthetic=is_synthetic, imported_by=imported_by,
                data_timestamp=_timestamp(content.data_timestamp), **(provenance.of_import if provenance else {})
                | {"attribution": SYNTHETIC_ATTRIBUTION if is_synthetic else content.attribution},
            )  # fmt: skip
            values = _values(content, path, is_synthetic, replace_region, but=data_import)
            merge = Merge(cursor, OPENSTREETMAP, replace_edited=replace_edited, excluded=excluded, **values)
            numbers = _numbers(merge)
            _notify(progress, Reason("writing"), 0.2)
            merge.write(data_import.pk, imported_by, lambda share: _notify(progress, Reason("writing"), 0.2 + 0.8 * share))
        counts = content.counts | numbers | {"extent": content.extent}
        if number_supports() or merge.changes_something:
            mark_ground_changed()
        known = DataImport.objects.filter(kind=ImportKind.OSM, is_synthetic=is_synthetic, sha256=sha256).exclude(pk=data_import.pk).first()
        if known is not None and not merge.changes_something:
            data_import.delete()
            known.counts = counts  # of this run, for the caller; the row keeps its own
            return known
        data_import.counts = counts
        data_import.save(update_fields=["counts"])
        join_region(data_import)
    return data_import


def difference_of_osm(
    *, path: Path, progress: Progress | None = None, replace_edited: bool = False, replace_region: bool = False, most: int = 2_000
) -> OsmDifference:
    """Return what import_osm would do with the file; nothing is written. Raises OsmFileError."""
    with transaction.atomic():
        with _staged(path, progress) as (cursor, content):
            _notify(progress, Reason("comparing"), 0.0)
            values = _values(content, path, False, replace_region)
            merge = Merge(cursor, OPENSTREETMAP, replace_edited=replace_edited, **values)
            _notify(progress, Reason("comparing"), 0.6)
            samples = {action: merge.samples(action, most) for action in ROW_ACTIONS}
            more = {} if replace_region else merge.missing(**_values(content, path, False, True))
            tables = {"by_kind": merge.by_kind(), "replaced_region_removes": more}
        transaction.set_rollback(True)
    counts = content.counts | {"extent": content.extent, "data_timestamp": content.data_timestamp} | tables
    return OsmDifference(counts, _numbers(merge), samples)


@contextmanager
def _staged(path: Path, progress: Progress | None) -> Iterator[tuple[CursorWrapper, OsmContent]]:
    """Stage the file's records in a temporary table as they are read; yields its cursor and the totals. Raises OsmFileError."""
    with staging() as (cursor, copying):
        with copying() as copy:

            def take(records: list[OsmAssetRecord]) -> None:
                for row in _rows(records):
                    copy.write_row(row)

            content = read_osm(path, progress, take)
            if not content.kinds:
                raise OsmFileError(Reason("no_infrastructure"))
        if content.is_unsorted:
            cursor.execute(_KEEP_THE_LAST)
        yield cursor, content


def _numbers(merge: Merge) -> dict[str, int]:
    """Return the totals, with manually edited rows counted separately whatever their outcome."""
    unchanged = merge.numbers[UNCHANGED] - merge.edited.get(UNCHANGED, 0)
    return merge.numbers | {"kept_edited": sum(merge.edited.values()), "kept_newer": merge.newer, UNCHANGED: unchanged}


def _values(content: OsmContent, path: Path, is_synthetic: bool, replace_region: bool, *, but: DataImport | None = None) -> dict[str, Any]:
    """Return the parameters of the statements for the file.

    A file may be filtered (power lines only): a subtype that is missing completely counts as filtered out, unless there were at most
    HANDFUL of it or the file has the same name.
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
        "timestamp": _timestamp(content.data_timestamp), "whole_region": replace_region,
        "sources": [source.pk for source in sources], "filtered_out": filtered_out,
        "box": box and shapely.to_wkb(shapely.set_srid(shapely.box(*box), 4326), hex=True, include_srid=True),
    }  # fmt: skip


def _notify(progress: Progress | None, stage: Reason, share: float) -> None:
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


def _rows(records: Sequence[OsmAssetRecord]) -> Iterator[tuple[Any, ...]]:
    geometries = np.array([record.geometry for record in records], dtype=object)
    wkb = shapely.to_wkb(shapely.set_srid(geometries, 4326), hex=True, include_srid=True)
    centres = shapely.points(np.array([record.centre for record in records], dtype=np.float64))
    centre_wkb = shapely.to_wkb(shapely.set_srid(centres, 4326), hex=True, include_srid=True)
    for record, geometry, centre in zip(records, wkb, centre_wkb, strict=True):
        yield (
            record.kind, record.osm_type, record.osm_id, "", record.subtype, geometry, centre, record.name[:255], record.ref[:255],
            record.operator[:255], list(record.voltages_v), max(record.voltages_v, default=None), record.circuits, record.height_m,
            record.length_m, record.is_flyable, list(record.node_osm_ids), json.dumps(record.tags), json.dumps(record.parts),
            record.content_hash, "",
        )  # fmt: skip


def _timestamp(text: str | None) -> datetime | None:
    try:
        moment = parse_datetime(text or "")
    except ValueError:
        return None
    return moment.replace(tzinfo=moment.tzinfo or UTC) if moment else None
