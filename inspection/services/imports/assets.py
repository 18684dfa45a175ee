"""Makes an asset set what a file says, and tells beforehand what that would change."""

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import shapely
from django.contrib.gis.geos import GEOSGeometry
from django.db import connection, transaction
from django.db.backends.utils import CursorWrapper

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.assets.asset_file import AssetFile, Row, RowFaults, opened_asset_file
from inspection.importers.assets.mapping import AssetRecord, Mapping, Tally, checked_mapping, records_of
from inspection.importers.rows import AssetFileError
from inspection.models import ROW_ACTIONS, Asset, AssetSet, ChangeAction, DataImport, ImportKind
from inspection.services.facts import asset_facts, says_the_same
from inspection.services.ground import hold_ground, mark_ground_changed
from inspection.services.imports.external_ids import count_of_ids, give_ids
from inspection.services.imports.osm import SYNTHETIC_ATTRIBUTION
from inspection.services.proposals.reading import Progress, Provenance
from inspection.services.supports import number_supports
from workspace.models import DEFAULT_ORGANISATION_ID, AuditEntry, User

EXPLANATIONS = ("kind", "columns", "units", "geometry")  # what somebody says of the columns
MAPPING_PARAMETERS = (*EXPLANATIONS, "crs", "layer", "leave_out_faulty")  # what the set keeps for the next file
UNCHANGED = "unchanged"
ROWS_BETWEEN_WORDS = 2_000
_BATCH = 1_000
_COLUMNS = (
    "kind", "subtype", "source_key", "geometry", "centre", "name", "ref", "operator", "voltages_v", "max_voltage_v", "circuits",
    "height_m", "length_m", "is_flyable", "tags", "content_hash",
)  # fmt: skip
_STAGING = """
CREATE TEMPORARY TABLE asset_staging (
    id serial, kind text, subtype text, source_key text, geometry geometry, centre geometry, name text, ref text, operator text,
    voltages_v integer[], max_voltage_v integer, circuits smallint, height_m double precision, length_m double precision,
    is_flyable boolean, tags jsonb, content_hash text, external_id text
) ON COMMIT DROP
"""
_COPY = f"COPY asset_staging ({', '.join(_COLUMNS)}, external_id) FROM STDIN"
# What becomes of each row of the file and of the set. An edited row is kept when the source now says something else than it did before.
_FATES = """
CREATE TEMPORARY TABLE asset_fate ON COMMIT DROP AS
SELECT a.id AS asset_id, s.id AS staging_id,
       CASE WHEN a.id IS NULL THEN 'new'
            WHEN a.is_edited AND NOT %(replace_edited)s THEN
                CASE WHEN s.id IS NULL AND NOT COALESCE((a.source_facts->>'vanished')::boolean, false) THEN 'kept'
                     WHEN s.content_hash <> a.content_hash THEN 'kept' ELSE 'unchanged' END
            WHEN s.id IS NULL THEN CASE WHEN a.vanished_at IS NULL THEN 'vanished' ELSE 'gone' END
            WHEN a.is_edited OR a.vanished_at IS NOT NULL OR s.content_hash <> a.content_hash THEN 'changed'
            ELSE 'unchanged' END AS fate
FROM asset_staging s
FULL JOIN (SELECT * FROM inspection_asset WHERE asset_set_id = %(asset_set)s AND source_key <> '') a
  ON a.kind = s.kind AND a.source_key = s.source_key
"""
_UPDATE = f"""
UPDATE inspection_asset a
SET {", ".join(f"{column} = s.{column}" for column in _COLUMNS if column not in {"kind", "source_key"})},
    node_osm_ids = '{{}}', data_import_id = %(data_import)s, is_edited = false, source_facts = NULL, vanished_at = NULL,
    revision = a.revision + 1, updated_at = now()
FROM asset_fate f JOIN asset_staging s ON s.id = f.staging_id
WHERE a.id = f.asset_id AND a.id = ANY(%(assets)s)
"""  # noqa: S608 -- column names only
_VANISH = """
UPDATE inspection_asset
SET vanished_at = now(), data_import_id = %(data_import)s, is_edited = false, source_facts = NULL, revision = revision + 1,
    updated_at = now()
WHERE id = ANY(%(assets)s)
"""
_INSERT = f"""
INSERT INTO inspection_asset ({", ".join(_COLUMNS)}, asset_set_id, data_import_id, osm_type, node_osm_ids, parts, is_edited, updated_at)
SELECT {", ".join(f"s.{column}" for column in _COLUMNS)}, %(asset_set)s, %(data_import)s, '', '{{}}', '[]', false, now()
FROM asset_staging s JOIN asset_fate f ON f.staging_id = s.id
WHERE f.fate = 'new' ORDER BY s.kind DESC, s.id
"""  # noqa: S608 -- column names only


class UnfinishedMapping(ValueError):
    """Somebody has to say more about the columns first; the message says what."""


@dataclass(frozen=True)
class Difference:
    """What the staged file would change in its set. Valid in the transaction that staged it."""

    numbers: dict[str, int]

    @property
    def changes_something(self) -> bool:
        return any(self.numbers[action] for action in (ChangeAction.NEW, ChangeAction.CHANGED, ChangeAction.VANISHED))

    def pairs(self, action: ChangeAction, most: int) -> list[tuple[Asset | None, Asset | None]]:
        """The row as it is, and as the file says it, for the first of this action."""
        with connection.cursor() as cursor:
            cursor.execute(
                "SELECT asset_id, staging_id FROM asset_fate WHERE fate = %s ORDER BY staging_id, asset_id LIMIT %s", [action, most]
            )
            keys = cursor.fetchall()
            stated = _staged(cursor, [staging for _, staging in keys if staging is not None])
        assets = Asset.objects.in_bulk([asset for asset, _ in keys if asset is not None])
        return [(assets.get(asset), stated.get(staging)) for asset, staging in keys]


def import_assets(
    *,
    path: Path,
    parameters: dict[str, Any],
    imported_by: User | None = None,
    is_synthetic: bool = False,
    replace_edited: bool = False,
    provenance: Provenance | None = None,
    progress: Progress | None = None,
) -> DataImport:
    """Make the set what the file says under the mapping in parameters, and return the import with its counts.

    The same file again changes nothing. Rows that a curator edited stay as they are unless replace_edited says otherwise; what the set
    has and the file has not is marked as vanished, never deleted. External ids are those of the organisation in provenance, else of who
    imports it. Raises AssetFileError and UnfinishedMapping, and changes nothing.
    """
    tell = progress or (lambda stage, share: None)
    name = set_name_of(path, parameters.get("set_name"))
    parameters = with_what_is_known(parameters, AssetSet.objects.filter(name=name).first())
    with path.open("rb") as data:
        sha256 = hashlib.file_digest(data, "sha256").hexdigest()
    tell("reading the rows", 0.1)
    with opened(path, parameters) as file, transaction.atomic():
        hold_ground()
        asset_set, _ = AssetSet.objects.select_related("data_import").get_or_create(name=name)
        tally = Tally()
        faults = row_faults(parameters)
        with staged(
            file, parameters, asset_set, tally=tally, faults=faults, replace_edited=replace_edited, progress=progress
        ) as found:  # fmt: skip
            tell("writing the assets", 0.6)
            owner = organisation_of(provenance, imported_by)
            ids = count_of_ids(asset_set.pk, owner)
            counts: dict[str, Any] = found.numbers | counts_of(file, tally, faults, ids)
            known = asset_set.data_import
            if known is not None and known.sha256 == sha256 and not found.changes_something:
                _keep_source_of_edited()
                give_ids(asset_set.pk, owner, imported_by.pk if imported_by else None)
                known.counts = counts  # of this run, for the caller; the row keeps those of its own
                return known
            data_import = DataImport.objects.create(
                kind=ImportKind.ASSETS, file_name=path.name[:255], sha256=sha256, is_synthetic=is_synthetic, imported_by=imported_by,
                counts=counts, **_origin(provenance, is_synthetic=is_synthetic),
            )  # fmt: skip
            _write(asset_set, data_import, imported_by)
            give_ids(asset_set.pk, owner, imported_by.pk if imported_by else None)
        stored = {key: parameters[key] for key in MAPPING_PARAMETERS if parameters.get(key)}
        AssetSet.objects.filter(pk=asset_set.pk).update(data_import=data_import, mapping=stored)
        if number_supports() or found.changes_something:
            mark_ground_changed()
    return data_import


def organisation_of(provenance: Provenance | None, actor: User | None) -> int:
    """Whose external ids a file has."""
    if provenance is not None and provenance.organisation_id is not None:
        return provenance.organisation_id
    return actor.organisation_id if actor else DEFAULT_ORGANISATION_ID


def set_name_of(path: Path, stated: Any) -> str:
    """Raises AssetFileError."""
    if stated is not None and not isinstance(stated, str):
        raise AssetFileError([GeometryFault("set_name", "the name of the set is a text")])
    return ((stated or "").strip() or path.stem)[:200]


def with_what_is_known(parameters: dict[str, Any], asset_set: AssetSet | None) -> dict[str, Any]:
    """The source's next file needs no explanation when nobody gives one: its columns mean what they meant."""
    if asset_set is None or any(parameters.get(key) for key in EXPLANATIONS):
        return parameters
    return asset_set.mapping | {key: value for key, value in parameters.items() if key not in EXPLANATIONS}


def opened(path: Path, parameters: dict[str, Any]) -> Any:
    """The file as the parameters say to read it; a context. Raises AssetFileError."""
    layer = parameters.get("layer")
    return opened_asset_file(
        path, crs=parameters.get("crs"), geometry_columns=parameters.get("geometry"), layer=layer if isinstance(layer, str) else ""
    )


def row_faults(parameters: dict[str, Any]) -> RowFaults:
    return RowFaults(leave_out=parameters.get("leave_out_faulty") is True)


@contextmanager
def staged(
    file: AssetFile,
    parameters: dict[str, Any],
    asset_set: AssetSet | None,
    *,
    tally: Tally,
    faults: RowFaults,
    replace_edited: bool,
    columns: Iterable[str] | None = None,
    progress: Progress | None = None,
) -> Iterator[Difference]:
    """The file's records in a temporary table, and the difference to the set. Call it in a transaction.

    columns are those of the file, if they are known already. Raises AssetFileError and UnfinishedMapping.
    """
    rows = file.rows(faults)
    mapping = checked_mapping(parameters, _columns_of(file) if columns is None else columns)
    if fault := unfinished(mapping):
        raise UnfinishedMapping(fault)
    with connection.cursor() as cursor:
        cursor.execute(_STAGING)
        with cursor.copy(_COPY) as copy:
            for record in records_of(told(rows, progress, "comparing", 0.4), mapping, faults, tally):
                copy.write_row(_row(record))
        faults.refuse_if_any()
        if tally.unknown_kinds:
            raise UnfinishedMapping(unknown_kinds(mapping.kind_column, tally))
        cursor.execute("ANALYZE asset_staging")
        cursor.execute(_FATES, {"asset_set": asset_set.pk if asset_set else None, "replace_edited": replace_edited})
        cursor.execute("SELECT fate, count(*) FROM asset_fate GROUP BY fate")
        found = dict(cursor.fetchall())
        yield Difference({fate: found.get(fate, 0) for fate in (*ROW_ACTIONS, UNCHANGED)})
        cursor.execute("DROP TABLE asset_fate")  # before the end of the transaction: several imports may share one
        cursor.execute("DROP TABLE asset_staging")


def told(rows: Iterable[Row], progress: Progress | None, stage: str, share: float) -> Iterator[Row]:
    """The rows, with a word to whoever watches every few thousand; that is where a cancelled job ends."""
    for number, row in enumerate(rows, start=1):
        if progress is not None and number % ROWS_BETWEEN_WORDS == 0:
            progress(f"{stage}, row {number:,}", share)
        yield row


def unfinished(mapping: Mapping) -> str:
    """What is still to be said, in words; empty when nothing is."""
    if mapping.kind or mapping.kind_column:
        return ""
    return "Say what the rows are: towers, lines, railways or bridges, or which column tells."


def unknown_kinds(column: str, tally: Tally) -> str:
    first = tally.unknown_kinds.most_common(10)
    shown = ", ".join(f"{value!r} ({number} rows)" if value else f"an empty cell ({number} rows)" for value, number in first)
    return f"Say what these values of {column!r} are, or leave their rows out: {shown}."


def counts_of(file: AssetFile, tally: Tally, faults: RowFaults, external_ids: int) -> dict[str, Any]:
    """What was read, for people and for the row of the import."""
    return {
        "format": file.source.file_format, "crs": file.crs_name, "layer": file.source.layer, "left_out": dict(tally.left_out),
        "unread_values": {role: number for role, number in tally.unread.items() if number}, "faulty_rows_left_out": faults.number,
        "external_ids": external_ids,
    }  # fmt: skip


def _columns_of(file: AssetFile) -> Iterable[str]:
    """Of the first rows of a file whose rows each bring their own columns, all of them are looked at."""
    if file.source.columns:
        return file.source.columns
    names: dict[str, None] = {}
    for row in file.source.rows():
        names.update(dict.fromkeys(row.properties))
    return names


def _write(asset_set: AssetSet, data_import: DataImport, actor: User | None) -> None:
    values = {"data_import": data_import.pk, "asset_set": asset_set.pk}
    for action, statement in ((ChangeAction.CHANGED, _UPDATE), (ChangeAction.VANISHED, _VANISH)):
        for assets in _batches(action):
            before = {asset.pk: asset_facts(asset) for asset in Asset.objects.filter(pk__in=assets)}
            with connection.cursor() as cursor:
                cursor.execute(statement, values | {"assets": assets})
            after = Asset.objects.filter(pk__in=assets).order_by("pk")
            AuditEntry.objects.bulk_create([_entry(actor, action, before[asset.pk], asset) for asset in after])
    _keep_source_of_edited()
    with connection.cursor() as cursor:
        cursor.execute(_INSERT, values)
        cursor.execute("ANALYZE inspection_asset (id, kind, osm_type, osm_id, line_id, vanished_at)")  # for what numbers the supports next


def _keep_source_of_edited() -> None:
    """Edited rows stay as they are, but know what their source says now."""
    with connection.cursor() as cursor:
        cursor.execute("SELECT asset_id, staging_id FROM asset_fate WHERE fate = 'kept'")
        keys = cursor.fetchall()
        for start in range(0, len(keys), _BATCH):
            batch = dict(keys[start : start + _BATCH])
            stated = _staged(cursor, [staging for staging in batch.values() if staging is not None])
            for asset in Asset.objects.filter(pk__in=batch):
                staging = batch[asset.pk]
                if staging is None:
                    asset.source_facts = (asset.source_facts or asset_facts(asset)) | {"vanished": True}
                else:
                    facts = asset_facts(stated[staging])
                    asset.content_hash = stated[staging].content_hash
                    asset.is_edited = asset.vanished_at is not None or not says_the_same(asset, facts)
                    asset.source_facts = facts if asset.is_edited else None
                asset.save(update_fields=["source_facts", "content_hash", "is_edited"])


def _batches(action: ChangeAction) -> Iterator[list[int]]:
    with connection.cursor() as cursor:
        cursor.execute("SELECT asset_id FROM asset_fate WHERE fate = %s ORDER BY asset_id", [action])
        keys = [key for (key,) in cursor.fetchall()]
    for start in range(0, len(keys), _BATCH):
        yield keys[start : start + _BATCH]


def _entry(actor: User | None, action: ChangeAction, before: dict[str, Any], asset: Asset) -> AuditEntry:
    return AuditEntry(
        organisation_id=actor.organisation_id if actor else DEFAULT_ORGANISATION_ID, actor=actor, action=action, subject_type="asset",
        subject_id=str(asset.pk), before=before, after=asset_facts(asset),
    )  # fmt: skip


def _staged(cursor: CursorWrapper, keys: Sequence[int]) -> dict[int, Asset]:
    """Rows of the file as assets that are not stored."""
    columns = [column for column in _COLUMNS if column not in {"geometry", "centre", "tags"}]
    cursor.execute(
        f"SELECT s.id, ST_AsBinary(s.geometry), s.tags::text, {', '.join(f's.{column}' for column in columns)}, f.asset_id "  # noqa: S608
        "FROM asset_staging s JOIN asset_fate f ON f.staging_id = s.id WHERE s.id = ANY(%s)",
        [list(keys)],
    )
    found = {}
    for key, wkb, tags, *values, asset in cursor.fetchall():
        geometry = GEOSGeometry(memoryview(bytes(wkb)), srid=4326)
        found[key] = Asset(pk=asset, geometry=geometry, tags=json.loads(tags), **dict(zip(columns, values, strict=True)))
    return found


def _row(record: AssetRecord) -> tuple[Any, ...]:
    shape = record.geometry
    if isinstance(shape, shapely.LineString):
        centre = shapely.line_interpolate_point(shape, 0.5, normalized=True)
    else:
        centre = shape.centroid if shape.contains(shape.centroid) else shape.representative_point()
    geometry, point = (shapely.to_wkb(shapely.set_srid(value, 4326), hex=True, include_srid=True) for value in (shape, centre))
    return (
        record.kind, record.subtype, record.source_key, geometry, point, record.name, record.ref, record.operator, list(record.voltages_v),
        max(record.voltages_v, default=None), record.circuits, record.height_m, record.length_m, record.is_flyable,
        json.dumps(record.tags), record.content_hash, record.external_id,
    )  # fmt: skip


def _origin(provenance: Provenance | None, *, is_synthetic: bool) -> dict[str, Any]:
    if is_synthetic:
        return {"attribution": SYNTHETIC_ATTRIBUTION}
    if provenance is None:
        return {}
    return {
        "attribution": provenance.attribution, "licence": provenance.licence, "source_address": provenance.source_address,
        "fetched_at": provenance.fetched_at,
    }  # fmt: skip
