"""What later apps add to regions: where an organisation has its bases, and what of the demo goes with its region."""

from django.utils.module_loading import import_string

from workspace.models import User

LonLat = tuple[float, float]

_bases: list[str] = []
_deletions: list[str] = []


def register_bases(name: str) -> None:
    """Register a function by its dotted name. It takes an organisation's key and lists the positions of its bases."""
    if name not in _bases:
        _bases.append(name)


def register_deletion(name: str) -> None:
    """Register a function by its dotted name. It takes a user and deletes the rest of the demo."""
    if name not in _deletions:
        _deletions.append(name)


def bases_of(organisation_id: int) -> list[LonLat]:
    return [position for name in _bases for position in import_string(name)(organisation_id)]


def after_deletion(actor: User) -> None:
    for name in _deletions:
        import_string(name)(actor)
