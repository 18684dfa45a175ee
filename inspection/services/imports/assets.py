"""Updates an asset set to a file, and computes the changes beforehand."""

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import shapely
from django.db import connection, transaction

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.assets.asset_file import AssetFile, Row, RowFaults, opened_asset_file
from inspection.importers.assets.mapping import AssetRecord, Mapping, Tally, checked_mapping, records_of
from inspection.importers.rows import AssetFileError
from inspection.models import AssetSet, DataImport, ImportKind
from inspection.services.ground import hold_ground, mark_ground_changed, number_supports
from inspection.services.imports.asset_merge import Merge, MergeSource, staging
from inspection.services.imports.osm import SYNTHETIC_ATTRIBUTION
from inspection.services.imports.regions import join_region
from inspection.services.proposals.reading import Progress, Provenance
from operation.reasons import Reason
from workspace.models import DEFAULT_ORGANISATION_ID, User

MAX_REPORTED = 50
_OF_THE_SET = "a.asset_set_id = %(asset_set)s AND a.kind = s.kind AND a.source_key = s.source_key"
_REFERENCE = "r.asset_id = a.id AND r.organisation_id = %(organisation)s"
_TAKEN = """
SELECT s.external_id
FROM asset_staging s
JOIN inspection_assetreference r ON r.organisation_id = %(organisation)s AND r.external_id = s.external_id
JOIN inspection_asset a ON a.id = r.asset_id
WHERE s.external_id <> '' AND a.vanished_at IS NULL AND a.asset_set_id IS DISTINCT FROM %(asset_set)s
ORDER BY s.id LIMIT %(most)s
"""
_NUMBER = f"""
SELECT count(*)
FROM asset_staging s LEFT JOIN inspection_asset a ON {_OF_THE_SET} LEFT JOIN inspection_assetreference r ON {_REFERENCE}
WHERE s.external_id <> '' AND s.external_id IS DISTINCT FROM r.external_id
"""  # noqa: S608 -- constant texts of this file
# Each asset that gets or loses an id: its organisation's reference, before and after.
_IDS = f"""
CREATE TEMPORARY TABLE asset_id_given ON COMMIT DROP AS
WITH given AS (SELECT a.id, s.external_id FROM asset_staging s JOIN inspection_asset a ON {_OF_THE_SET} WHERE s.external_id <> '')
SELECT given.id AS asset_id, r.external_id AS before, given.external_id AS after, COALESCE(r.attributes, '{{}}') AS attributes
FROM given LEFT JOIN inspection_assetreference r ON r.asset_id = given.id AND r.organisation_id = %(organisation)s
WHERE r.external_id IS DISTINCT FROM given.external_id
UNION ALL
SELECT r.asset_id, r.external_id, '', r.attributes
FROM inspection_assetreference r JOIN given ON given.external_id = r.external_id AND given.id <> r.asset_id
WHERE r.organisation_id = %(organisation)s AND r.asset_id NOT IN (SELECT id FROM given)
"""  # noqa: S608
_STATEMENTS = (
    """UPDATE inspection_assetreference r SET external_id = '', updated_at = now()
       FROM asset_id_given g WHERE r.asset_id = g.asset_id AND r.organisation_id = %(organisation)s""",
    """INSERT INTO inspection_assetreference (organisation_id, asset_id, external_id, attributes)
       SELECT %(organisation)s, asset_id, after, attributes FROM asset_id_given WHERE after <> ''
       ON CONFLICT (organisation_id, asset_id) DO UPDATE SET external_id = excluded.external_id""",
    """UPDATE inspection_asset a SET revision = a.revision + 1, updated_at = now() FROM asset_id_given g WHERE a.id = g.asset_id""",
    """INSERT INTO workspace_auditentry (organisation_id, actor_id, action, subject_type, subject_id, before, after)
       SELECT %(organisation)s, %(actor)s, 'changed', 'asset_reference', asset_id::text,
              jsonb_build_object('external_id', COALESCE(before, ''), 'attributes', attributes),
              jsonb_build_object('external_id', after, 'attributes', attributes)
       FROM asset_id_given""",
    "DROP TABLE asset_id_given",
)


def count_of_ids(asset_set: int | None, organisation: int) -> int:
    """Return how many ids the staged rows would set. Raises AssetFileError for ids of assets outside the set."""
    values = {"asset_set": asset_set, "organisation": organisation, "most": MAX_REPORTED}
    with connection.cursor() as cursor:
        cursor.execute(_TAKEN, values)
        taken = [GeometryFault("columns.external_id", f"the external id {key[:60]!r} is another asset's") for (key,) in cursor.fetchall()]
        if taken:
            raise AssetFileError(taken)
        cursor.execute(_NUMBER, values)
        return int(cursor.fetchone()[0])


def give_ids(asset_set: int, organisation: int, actor: int | None) -> None:
    """Store the ids once the rows are assets, in the transaction that staged them."""
    values = {"asset_set": asset_set, "organisation": organisation, "actor": actor}
    with connection.cursor() as cursor:
        for statement in (_IDS, *_STATEMENTS):
            cursor.execute(statement, values)


EXPLANATIONS = ("kind", "columns", "units", "geometry")  # a user's description of the columns
MAPPING_PARAMETERS = (*EXPLANATIONS, "crs", "layer", "leave_out_faulty")  # stored in the set for the next file
ROWS_BETWEEN_WORDS = 2_000
ASSET_SET = MergeSource(
    same="a.asset_set_id = %(asset_set)s AND a.kind = s.kind AND a.source_key = s.source_key AND a.source_key <> ''",
    missing="a.asset_set_id = %(asset_set)s AND a.source_key <> ''",
    facts=(
        "osm_type", "osm_id", "node_osm_ids", "parts", "asset_set_id", "source_key", "data_import_id", "content_hash", "is_edited",
    ),
    follows_again=True,
)  # fmt: skip


class UnfinishedMapping(ValueError):
    """Raised when the user must describe more of the columns; the message says what."""


def import_assets(
    *,
    path: Path,
    parameters: dict[str, Any],
    imported_by: User | None = None,
    is_synthetic: bool = False,
    replace_edited: bool = False,
    provenance: Provenance | None = None,
    progress: Progress | None = None,
    excluded: Sequence[str] = (),
) -> DataImport:
    """Update the set to the file under the mapping in parameters, and return the import with its counts.

    Importing the same file again changes nothing. Rows that a curator edited stay unless replace_edited is set; assets of the set that are
    missing from the file are marked as vanished, never deleted. External ids belong to the organisation in provenance, else to the
    importer's. Raises AssetFileError and UnfinishedMapping, and changes nothing.
    """
    notify = progress or (lambda stage, share: None)
    name = set_name_of(path, parameters.get("set_name"))
    parameters = with_what_is_known(parameters, AssetSet.objects.filter(name=name).first())
    with path.open("rb") as data:
        sha256 = hashlib.file_digest(data, "sha256").hexdigest()
    notify(Reason("reading_rows"), 0.1)
    with opened(path, parameters) as file, transaction.atomic():
        hold_ground()
        asset_set, _ = AssetSet.objects.select_related("data_import").get_or_create(name=name)
        tally = Tally()
        faults = row_faults(parameters)
        with staged(
            file, parameters, asset_set, tally=tally, faults=faults, replace_edited=replace_edited, progress=progress, excluded=excluded
        ) as found:  # fmt: skip
            notify(Reason("writing_assets"), 0.6)
            owner = organisation_of(provenance, imported_by)
            ids = count_of_ids(asset_set.pk, owner)
            counts: dict[str, Any] = found.numbers | counts_of(file, tally, faults, ids)
            known = asset_set.data_import
            if known is not None and known.sha256 == sha256 and not found.changes_something:
                found.keep_beside()
                give_ids(asset_set.pk, owner, imported_by.pk if imported_by else None)
                known.counts = counts  # of this run, for the caller; the row keeps its own
                return known
            data_import = DataImport.objects.create(
                kind=ImportKind.ASSETS, file_name=path.name[:255], sha256=sha256, is_synthetic=is_synthetic, imported_by=imported_by,
                counts=counts, **({"attribution": SYNTHETIC_ATTRIBUTION} if is_synthetic else provenance.of_import if provenance else {}),
            )  # fmt: skip
            found.write(data_import.pk, imported_by)
            give_ids(asset_set.pk, owner, imported_by.pk if imported_by else None)
        stored = {key: parameters[key] for key in MAPPING_PARAMETERS if parameters.get(key)}
        AssetSet.objects.filter(pk=asset_set.pk).update(data_import=data_import, mapping=stored)
        join_region(data_import)
        if number_supports() or found.changes_something:
            mark_ground_changed()
    return data_import


def organisation_of(provenance: Provenance | None, actor: User | None) -> int:
    """Return the organisation of a file's external ids."""
    if provenance is not None and provenance.organisation_id is not None:
        return provenance.organisation_id
    return actor.organisation_id if actor else DEFAULT_ORGANISATION_ID


def set_name_of(path: Path, stated: Any) -> str:
    """Return the name of the set. Raises AssetFileError."""
    if stated is not None and not isinstance(stated, str):
        raise AssetFileError([GeometryFault("set_name", "the name of the set is a text")])
    return ((stated or "").strip() or path.stem)[:200]


def with_what_is_known(parameters: dict[str, Any], asset_set: AssetSet | None) -> dict[str, Any]:
    """Return the parameters, by default with the set's mapping: the columns of a source's next file have the same meaning."""
    if asset_set is None or any(parameters.get(key) for key in EXPLANATIONS):
        return parameters
    return asset_set.mapping | {key: value for key, value in parameters.items() if key not in EXPLANATIONS}


def opened(path: Path, parameters: dict[str, Any]) -> Any:
    """Open the file with the parameters; a context. Raises AssetFileError."""
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
    excluded: Sequence[str] = (),
) -> Iterator[Merge]:
    """Stage the file's records in a temporary table, with their difference to the set. Call it in a transaction.

    columns are those of the file, if already known. Raises AssetFileError and UnfinishedMapping.
    """
    rows = file.rows(faults)
    mapping = checked_mapping(parameters, _columns_of(file) if columns is None else columns)
    if fault := unfinished(mapping):
        raise UnfinishedMapping(fault)
    with staging() as (cursor, copying):
        with copying() as copy:
            for record in records_of(reported(rows, progress, "comparing_rows", 0.4), mapping, faults, tally):
                copy.write_row(_row(record))
        faults.refuse_if_any()
        if tally.unknown_kinds:
            raise UnfinishedMapping(unknown_kinds(mapping.kind_column, tally))
        key = asset_set.pk if asset_set else None
        yield Merge(cursor, ASSET_SET, replace_edited=replace_edited, asset_set=key, excluded=excluded)


def reported(rows: Iterable[Row], progress: Progress | None, code: str, share: float) -> Iterator[Row]:
    """Yield the rows and report progress every few thousand, at which point a cancelled job ends."""
    for number, row in enumerate(rows, start=1):
        if progress is not None and number % ROWS_BETWEEN_WORDS == 0:
            progress(Reason(code, {"row": number}), share)
        yield row


def unfinished(mapping: Mapping) -> str:
    """Return what the user must still describe as text; empty if nothing."""
    if mapping.kind or mapping.kind_column:
        return ""
    return "Say what the rows are: towers, lines, railways or bridges, or which column tells."


def unknown_kinds(column: str, tally: Tally) -> str:
    first = tally.unknown_kinds.most_common(10)
    shown = ", ".join(f"{value!r} ({number} rows)" if value else f"an empty cell ({number} rows)" for value, number in first)
    return f"Say what these values of {column!r} are, or leave their rows out: {shown}."


def counts_of(file: AssetFile, tally: Tally, faults: RowFaults, external_ids: int) -> dict[str, Any]:
    """Return what was read, for users and for the import's row."""
    return {
        "format": file.source.file_format, "crs": file.crs_name, "layer": file.source.layer, "left_out": dict(tally.left_out),
        "unread_values": {role: number for role, number in tally.unread.items() if number}, "faulty_rows_left_out": faults.number,
        "external_ids": external_ids,
    }  # fmt: skip


def _columns_of(file: AssetFile) -> Iterable[str]:
    """Return the columns of a file; of one whose rows each have their own, the columns of all rows."""
    if file.source.columns:
        return file.source.columns
    names: dict[str, None] = {}
    for row in file.source.rows():
        names.update(dict.fromkeys(row.properties))
    return names


def _row(record: AssetRecord) -> tuple[Any, ...]:
    shape = record.geometry
    if isinstance(shape, shapely.LineString):
        centre = shapely.line_interpolate_point(shape, 0.5, normalized=True)
    else:
        centre = shape.centroid if shape.contains(shape.centroid) else shape.representative_point()
    geometry, point = (shapely.to_wkb(shapely.set_srid(value, 4326), hex=True, include_srid=True) for value in (shape, centre))
    return (
        record.kind, "", None, record.source_key, record.subtype, geometry, point, record.name, record.ref, record.operator,
        list(record.voltages_v), max(record.voltages_v, default=None), record.circuits, record.height_m, record.length_m,
        record.is_flyable, [], json.dumps(record.tags), "[]", record.content_hash, record.external_id,
    )  # fmt: skip
