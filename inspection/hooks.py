"""Functions of later apps that this one calls: inspections of assets and lines, bases of an organisation, deletion of the demo's UAVs."""

from collections.abc import Collection
from typing import Any

from django.db.models import QuerySet
from django.utils.module_loading import import_string

from workspace.models import User

LonLat = tuple[float, float]

_inspections: list[str] = []
_shares: list[str] = []
_bases: list[str] = []
_deletions: list[str] = []


def register_inspections(name: str) -> None:
    """Register a function by its dotted name. It takes an organisation's key and returns rows with `asset` and `inspected_at`."""
    if name not in _inspections:
        _inspections.append(name)


def register_inspected_shares(name: str) -> None:
    """Register a function by its dotted name. It takes an organisation's key and keys of lines, and returns the inspected share of each."""
    if name not in _shares:
        _shares.append(name)


def register_bases(name: str) -> None:
    """Register a function by its dotted name. It takes an organisation's key and lists the positions of its bases."""
    if name not in _bases:
        _bases.append(name)


def register_deletion(name: str) -> None:
    """Register a function by its dotted name. It takes a user and deletes the rest of the demo."""
    if name not in _deletions:
        _deletions.append(name)


def inspections_of(organisation_id: int) -> QuerySet[Any]:
    """Return one row for each inspection of an asset."""
    (name,) = _inspections
    rows: QuerySet[Any] = import_string(name)(organisation_id)
    return rows


def inspected_shares_of(organisation_id: int, lines: Collection[int]) -> dict[int, float]:
    """Return of inspected lines and railways the share of their length, 0 to 1, that was ever inspected."""
    (name,) = _shares
    shares: dict[int, float] = import_string(name)(organisation_id, lines)
    return shares


def bases_of(organisation_id: int) -> list[LonLat]:
    return [position for name in _bases for position in import_string(name)(organisation_id)]


def after_deletion(actor: User) -> None:
    for name in _deletions:
        import_string(name)(actor)
