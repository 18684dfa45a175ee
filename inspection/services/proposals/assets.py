"""Asset files other than OpenStreetMap's as proposals: first their content, then, once the columns are mapped, the difference."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from django.contrib.gis.geos import GEOSGeometry
from django.db import transaction

from inspection.importers.assets.asset_file import AssetFile
from inspection.importers.assets.mapping import Tally
from inspection.importers.assets.survey import AssetFileSurvey, suggested_mapping, survey_of
from inspection.importers.rows import AssetFileError, FaultyRows
from inspection.models import ROW_ACTIONS, AssetSet, DataImport
from inspection.services.facts import ASSET_FACTS, differing
from inspection.services.imports.asset_merge import UNCHANGED, Merge
from inspection.services.imports.assets import (
    EXPLANATIONS,
    UnfinishedMapping,
    count_of_ids,
    counts_of,
    import_assets,
    opened,
    organisation_of,
    reported,
    row_faults,
    set_name_of,
    staged,
    with_what_is_known,
)
from inspection.services.proposals.reading import Change, Fault, FileRefused, Progress, Provenance, Reading, excluded_of
from inspection.services.proposals.undo import apply_undo, is_undo, read_undo
from operation.reasons import Reason, reason_of
from workspace.models import User

MAX_CHANGES = 2_000  # of each action
NOTHING = dict.fromkeys((*ROW_ACTIONS, UNCHANGED), 0)


def read(*, path: Path | None, parameters: dict[str, Any], provenance: Provenance, progress: Progress) -> Reading:
    """Return the content of the file and, once the mapping is sufficient, its changes of the set. Raises FileRefused."""
    if path is None and is_undo(parameters):
        return read_undo(parameters)
    with _faults_as_refusal():
        file_path = _file(path)
        name = set_name_of(file_path, parameters.get("set_name"))
        asset_set = AssetSet.objects.filter(name=name).first()
        stated = with_what_is_known(parameters, asset_set)
        progress(Reason("reading_rows"), 0.1)
        with opened(file_path, stated) as file:
            faults = row_faults(stated)
            survey = survey_of(reported(file.rows(faults), progress, "reading_rows_row", 0.1), file.source.columns)
            faults.refuse_if_any()
            if not survey.rows:
                raise FileRefused([Fault("", Reason("no_records"))])
            summary = _summary(file, survey, name, stated, file_path)
            if words := _nothing_to_read(file, survey):
                return Reading(summary | {"needs_mapping": True, "words": words}, dict(NOTHING))
            progress(Reason("comparing"), 0.5)
            return _compared(
                file, stated, asset_set, summary, replace_edited=parameters.get("replace_edited") is True, progress=progress,
                organisation=organisation_of(provenance, None),
            )  # fmt: skip


def apply(
    *, path: Path | None, parameters: dict[str, Any], provenance: Provenance, applied_by: User | None, progress: Progress
) -> DataImport:
    """Update the set to the file. Raises FileRefused."""
    if path is None and is_undo(parameters):
        return apply_undo(parameters, applied_by)
    with _faults_as_refusal():
        return import_assets(
            path=_file(path), parameters=parameters, imported_by=applied_by, provenance=provenance,
            replace_edited=parameters.get("replace_edited") is True, progress=progress, excluded=excluded_of(parameters),
        )  # fmt: skip


def _compared(
    file: AssetFile,
    stated: dict[str, Any],
    asset_set: AssetSet | None,
    summary: dict[str, Any],
    *,
    replace_edited: bool,
    progress: Progress,
    organisation: int,
) -> Reading:
    tally, faults = Tally(), row_faults(stated)
    columns = [column["name"] for column in summary["columns"]]
    try:
        with (
            transaction.atomic(),
            staged(
                file, stated, asset_set, tally=tally, faults=faults, replace_edited=replace_edited, columns=columns, progress=progress
            ) as found,
        ):
            changes = tuple(_changes(found))
            by_kind = found.by_kind()
            ids = count_of_ids(asset_set.pk if asset_set else None, organisation)
    except UnfinishedMapping as error:
        return Reading(summary | {"needs_mapping": True, "words": reason_of(error)}, dict(NOTHING))
    return Reading(summary | counts_of(file, tally, faults, ids) | {"by_kind": by_kind}, found.numbers, changes)


def _nothing_to_read(file: AssetFile, survey: AssetFileSurvey) -> str:
    if survey.geometries:
        return ""
    if file.source.file_format == "csv" and not file.source.geometry_columns:
        return "Say which columns hold longitude and latitude, or which one the geometry as WKT."
    return "None of the rows has a geometry."


def _summary(file: AssetFile, survey: AssetFileSurvey, name: str, stated: dict[str, Any], path: Path) -> dict[str, Any]:
    suggested = suggested_mapping(survey, file_name=path.stem, geometry_columns=file.source.geometry_columns)
    role_of = {column: role for role, column in (suggested["columns"] | file.source.geometry_columns).items()}
    columns = [
        {
            "name": column.name, "type": column.type, "samples": column.samples or _first_cell(file, column.name),
            "suggestion": role_of.get(column.name), "values": dict(column.values.most_common()) if column.values else None,
        }
        for column in survey.columns.values()
    ]  # fmt: skip
    return {
        "set": name, "format": file.source.file_format, "crs": file.crs_name, "layer": file.source.layer,
        "layers": list(file.source.layers), "rows": survey.rows, "without_geometry": survey.without_geometry,
        "geometry_types": dict(survey.geometries),
        "extent": list(survey.extent) if survey.extent else None, "notes": file.notes, "columns": columns,
        "suggested_mapping": suggested, "mapping": {key: stated[key] for key in EXPLANATIONS if stated.get(key)},
        "needs_mapping": False, "preview": {"type": "FeatureCollection", "features": survey.preview},
    }  # fmt: skip


def _first_cell(file: AssetFile, name: str) -> list[str]:
    cell = file.source.first_cells.get(name, "")
    return [cell[:60]] if cell else []


def _changes(found: Merge) -> Iterator[Change]:
    for action in ROW_ACTIONS:
        for row in found.samples(action, MAX_CHANGES):
            before, after = differing(_shown(row.facts), _shown(row.facts_in_file))
            drawn = GEOSGeometry(memoryview(bytes(row.geometry_in_file or row.geometry or b"")), srid=4326)
            yield Change(action, row.kind, row.label_in_file or row.label or "", row.asset_id, drawn, before, after, row.key)


def _shown(text: str | None) -> dict[str, Any] | None:
    """Return the facts that users read; the cursor returns jsonb as text."""
    if text is None:
        return None
    facts = json.loads(text)
    return {name: facts[name] for name in (*ASSET_FACTS, "geometry")}


def _file(path: Path | None) -> Path:
    if path is None:
        raise FileRefused([Fault("", Reason("no_file"))])
    return path


@contextmanager
def _faults_as_refusal() -> Iterator[None]:
    try:
        yield
    except AssetFileError as error:
        faults = (
            Fault(fault.place, fault.why, (fault.position.lon, fault.position.lat) if fault.position else None) for fault in error.faults
        )
        raise FileRefused(faults, are_of_records=isinstance(error, FaultyRows)) from error
    except UnfinishedMapping as error:
        raise FileRefused([Fault("kind", reason_of(error))]) from error
