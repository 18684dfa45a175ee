"""Checks that later apps add before a mission is approved, and before its UAVs are started together."""

from collections.abc import Collection
from typing import Any

from django.utils.module_loading import import_string

from missions.models import Mission

_further: list[str] = []
_before_starts: list[str] = []


def register_check(name: str) -> None:
    """Register a function by its dotted name. It lists reasons against a mission, loaded by selectors.mission_of_organisation.

    The function is imported on first use, so that programs that approve nothing start without it.
    """
    if name not in _further:
        _further.append(name)


def further_reasons(mission: Mission) -> list[Any]:
    """Return the reasons of later apps against approving a mission as it is planned."""
    return [reason for name in _further for reason in import_string(name)(mission)]


def register_start_check(name: str) -> None:
    """Register a function by its dotted name. It takes a mission and ids of its UAVs and lists reasons against starting them."""
    if name not in _before_starts:
        _before_starts.append(name)


def reasons_against_starts(mission: Mission, uav_ids: Collection[int]) -> list[Any]:
    """Return the reasons of later apps against starting these UAVs now."""
    return [reason for name in _before_starts for reason in import_string(name)(mission, uav_ids)]
