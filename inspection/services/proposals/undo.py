"""The undoing of an import as a proposal: reviewed and applied like a file."""

from collections import Counter
from typing import Any

from inspection.models import ROW_ACTIONS, DataImport, ImportKind
from inspection.services.facts import asset_facts, differing
from inspection.services.imports.asset_merge import UNCHANGED
from inspection.services.imports.asset_undo import AssetUndo, HistoryIncomplete, key_of, undo_of, write_undo
from inspection.services.proposals.reading import Change, Fault, FileRefused, Reading, excluded_of
from operation.reasons import Reason
from workspace.models import User

UNDO = "undo"  # a parameter: the key of the import
_FOR_PROGRAMS = {"node_osm_ids", "parts", "content_hash", "osm_type", "osm_id", "data_import_id", "asset_set_id", "source_key", "is_edited"}


def is_undo(parameters: dict[str, Any]) -> bool:
    return UNDO in parameters


def read_undo(parameters: dict[str, Any]) -> Reading:
    """Return the changes that undoing the import makes. Raises FileRefused if it no longer exists."""
    found = _undo(_import_of(parameters))
    numbers: Counter[str] = Counter()
    by_kind: dict[str, Counter[str]] = {}
    changes = []
    for action, asset, facts in found.changes():
        numbers[action.value] += 1
        by_kind.setdefault(asset.kind, Counter())[action.value] += 1
        before, after = differing(_shown(asset_facts(asset)), None if facts is None else _shown(facts))
        label = asset.ref or asset.name or f"{asset.get_kind_display()} {asset.osm_id or asset.source_key or asset.pk}"
        changes.append(Change(action, asset.kind, label, asset.pk, asset.geometry, before, after, key_of(asset)))
    every = dict.fromkeys((*ROW_ACTIONS, UNCHANGED), 0)
    summary = {"by_kind": {kind: every | counted for kind, counted in by_kind.items()}}
    return Reading(summary, every | numbers, tuple(changes))


def apply_undo(parameters: dict[str, Any], actor: User | None) -> DataImport:
    """Undo the import. Raises FileRefused."""
    undone = _import_of(parameters)
    found = _undo(undone).without(excluded_of(parameters))
    write_undo(found, actor=actor)
    counts = Counter(action.value for action, _, _ in found.changes())
    return DataImport.objects.create(
        kind=undone.kind, file_name=undo_name(undone), sha256="", attribution=undone.attribution, licence=undone.licence,
        imported_by=actor, is_synthetic=undone.is_synthetic, counts=dict.fromkeys(ROW_ACTIONS, 0) | counts,
    )  # fmt: skip


def undo_name(data_import: DataImport) -> str:
    """Return what is shown in place of a file's name."""
    return f"{data_import.file_name[:220]}, undone"


def _undo(data_import: DataImport) -> AssetUndo:
    try:
        return undo_of(data_import)
    except HistoryIncomplete as error:
        raise FileRefused([Fault("", Reason("import_without_history"))]) from error


def _import_of(parameters: dict[str, Any]) -> DataImport:
    key = parameters.get(UNDO)
    kinds = (ImportKind.OSM, ImportKind.ASSETS)
    found = DataImport.objects.filter(pk=key, kind__in=kinds).first() if isinstance(key, int) and 0 < key < 2**31 else None
    if found is None:
        raise FileRefused([Fault(UNDO, Reason("import_gone"))])
    return found


def _shown(facts: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in facts.items() if name not in _FOR_PROGRAMS}
