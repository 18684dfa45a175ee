"""OpenStreetMap files as proposals."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from django.contrib.gis.geos import GEOSGeometry

from inspection.importers.osm.file_validator import OsmFileError
from inspection.models import ChangeAction, DataImport
from inspection.services.facts import differing
from inspection.services.imports.osm import OsmDifference, difference_of_osm, import_osm
from inspection.services.proposals.reading import Change, Fault, FileRefused, Progress, Provenance, Reading, excluded_of
from inspection.services.proposals.undo import apply_undo, is_undo, read_undo
from operation.reasons import Reason, reason_of
from workspace.models import User

STAYING = (ChangeAction.KEPT, ChangeAction.VANISHED)  # drawn at their stored place instead of the file's
_FOR_PROGRAMS = {"node_osm_ids", "parts", "content_hash", "osm_type", "osm_id", "data_import_id"}


def read(*, path: Path | None, parameters: dict[str, Any], provenance: Provenance, progress: Progress) -> Reading:
    """Return the changes of the file. Raises FileRefused."""
    if path is None and is_undo(parameters):
        return read_undo(parameters)
    try:
        found = difference_of_osm(path=_file(path), progress=progress, **_options(parameters))
    except OsmFileError as error:
        raise FileRefused([Fault("", reason_of(error))]) from error
    return Reading(found.counts, found.numbers, tuple(_changes(found)))


def apply(
    *, path: Path | None, parameters: dict[str, Any], provenance: Provenance, applied_by: User | None, progress: Progress
) -> DataImport:
    """Update the assets to the file. Raises FileRefused."""
    if path is None and is_undo(parameters):
        return apply_undo(parameters, applied_by)
    try:
        return import_osm(
            path=_file(path), imported_by=applied_by, progress=progress, provenance=provenance, excluded=excluded_of(parameters),
            **_options(parameters),
        )  # fmt: skip
    except OsmFileError as error:
        raise FileRefused([Fault("", reason_of(error))]) from error


def _file(path: Path | None) -> Path:
    if path is None:
        raise FileRefused([Fault("", Reason("no_file"))])
    return path


def _options(parameters: dict[str, Any]) -> dict[str, bool]:
    return {name: bool(parameters.get(name)) for name in ("replace_edited", "replace_region")}


def _changes(found: OsmDifference) -> Iterator[Change]:
    for action, rows in found.samples.items():
        for row in rows:
            before, after = differing(_facts(row.facts), _facts(row.facts_in_file))
            drawn = row.geometry if action in STAYING else row.geometry_in_file
            label = row.label or row.label_in_file or ""
            yield Change(
                action, row.kind, label, row.asset_id, GEOSGeometry(memoryview(bytes(drawn or b"")), srid=4326), before, after, row.key
            )


def _facts(text: str | None) -> dict[str, Any] | None:
    """Return the facts that users read; the cursor returns jsonb as text."""
    return None if text is None else {name: value for name, value in json.loads(text).items() if name not in _FOR_PROGRAMS}
