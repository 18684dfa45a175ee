"""Selections of targets that users save for later."""

from collections.abc import Sequence
from typing import Any

from django.db import IntegrityError, transaction

from missions.models import SavedSelection
from missions.selectors.resolved_targets import resolved_targets
from planning.request import TargetRequest, priority_to_json
from planning.task import task_to_json
from workspace.audit import record_change
from workspace.models import Organisation, User


class SelectionNameTaken(Exception):
    """Raised when another selection of the organisation has this name."""


class SelectionChanged(Exception):
    """Raised when another user changed the selection after the caller read it."""


def create_selection(*, organisation: Organisation, author: User, name: str, targets: Sequence[TargetRequest]) -> SavedSelection:
    """Create a selection. Raises SelectionNameTaken, and InvalidRequest if a target is not on the map."""
    selection = SavedSelection(organisation=organisation, author=author, name=name, targets=_as_kept(targets))
    return _save(selection, author, "create", before=None)


def change_selection(
    *, selection: SavedSelection, actor: User, name: str | None, targets: Sequence[TargetRequest] | None, expected_revision: int | None
) -> SavedSelection:
    """Change a selection; None leaves a part as it is. Raises SelectionChanged, SelectionNameTaken and InvalidRequest."""
    with transaction.atomic():
        locked = _locked(selection, expected_revision)
        before = _summary(locked)
        if name is not None:
            locked.name = name
        if targets is not None:
            locked.targets = _as_kept(targets)
        locked.revision += 1
        return _save(locked, actor, "change", before=before)


def delete_selection(*, selection: SavedSelection, actor: User, expected_revision: int | None) -> None:
    """Delete a selection. Raises SelectionChanged."""
    with transaction.atomic():
        locked = _locked(selection, expected_revision)
        before, key = _summary(locked), locked.pk
        locked.delete()
        _note(locked.organisation, actor, key, "delete", before=before, after=None)


def _as_kept(targets: Sequence[TargetRequest]) -> list[dict[str, Any]]:
    """Return the targets as in a mission's request, each with its current label, which remains if the asset is deleted."""
    places, _ = resolved_targets(targets)
    return [
        {
            "asset": target.asset,
            "position": list(target.position) if target.position else None,
            "stretch": [list(end) for end in target.stretch] if target.stretch else None,
            "task": task_to_json(place.task),
            "priority": priority_to_json(target.priority),
            "sensor": target.sensor,
            "label": place.label[:255],
        }
        for place in places
        for target in [targets[place.target]]
    ]


def _locked(selection: SavedSelection, expected_revision: int | None) -> SavedSelection:
    locked = SavedSelection.objects.select_for_update().filter(pk=selection.pk).first()
    if locked is None or (expected_revision is not None and locked.revision != expected_revision):
        raise SelectionChanged
    return locked


def _save(selection: SavedSelection, actor: User, action: str, *, before: Any) -> SavedSelection:
    try:
        with transaction.atomic():
            selection.save()
    except IntegrityError as error:
        if "saved_selection_name_unique" in str(error):
            raise SelectionNameTaken from error
        raise
    _note(selection.organisation, actor, selection.pk, action, before=before, after=_summary(selection))
    return selection


def _summary(selection: SavedSelection) -> dict[str, Any]:
    return {"name": selection.name, "targets": len(selection.targets), "revision": selection.revision}


def _note(organisation: Organisation, actor: User, key: int, action: str, *, before: Any, after: Any) -> None:
    record_change(
        organisation=organisation, actor=actor, action=action, subject_type="selection", subject_id=key, before=before, after=after
    )
