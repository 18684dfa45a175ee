"""What later apps ask of a mission before it is approved, and before its UAVs are started together."""

from collections.abc import Collection
from typing import Any

from django.utils.module_loading import import_string

from missions.models import Mission

_further: list[str] = []
_before_starts: list[str] = []


def register_check(name: str) -> None:
    """The dotted name of a function of a mission, as loaded by selectors.mission_of_organisation, that lists reasons against it.

    It is loaded when a mission is first looked at: programs that approve nothing start without it.
    """
    if name not in _further:
        _further.append(name)


def further_reasons(mission: Mission) -> list[Any]:
    """What later apps have against approving a mission as it is planned."""
    return [reason for name in _further for reason in import_string(name)(mission)]


def register_start_check(name: str) -> None:
    """The dotted name of a function of a mission and ids of its UAVs that lists reasons against starting them."""
    if name not in _before_starts:
        _before_starts.append(name)


def reasons_against_starts(mission: Mission, uav_ids: Collection[int]) -> list[Any]:
    """What later apps have against starting these UAVs now."""
    return [reason for name in _before_starts for reason in import_string(name)(mission, uav_ids)]
