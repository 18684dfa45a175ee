"""Which missions failed their rehearsal, as a later app knows."""

from collections.abc import Sequence
from uuid import UUID

from django.utils.module_loading import import_string

from missions.models import Mission

_sources: list[str] = []


def register_failed_rehearsals(name: str) -> None:
    """Register a function by its dotted name. It takes missions and returns the keys of those whose present plan failed its rehearsal."""
    if name not in _sources:
        _sources.append(name)


def failed_rehearsals(missions: Sequence[Mission]) -> frozenset[UUID]:
    """Return the keys of those whose present plan failed its newest rehearsal."""
    planned = [mission for mission in missions if mission.planned_at is not None]
    return frozenset(key for name in _sources if planned for key in import_string(name)(planned))
