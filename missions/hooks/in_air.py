"""Registries for what a later app knows of UAVs: in the air and where, on the ground, down off plan, or never connected."""

from collections import defaultdict
from collections.abc import Collection

from django.utils.module_loading import import_string

from inspection.geodesy import LonLat

_IN_THE_AIR, _ON_THE_GROUND, _NEVER_RECEIVED, _DOWN = "in the air", "on the ground", "never heard", "down off its plan"
_sources: dict[str, list[str]] = defaultdict(list)


def register_source(name: str) -> None:
    """Register a function by its dotted name. It takes UAV ids and returns those reported in the air, each with its last position.

    The position is None where none was reported.
    """
    _register(_IN_THE_AIR, name)


def register_ground_source(name: str) -> None:
    """Register a function that returns the UAVs reported on the ground that cannot have taken off since."""
    _register(_ON_THE_GROUND, name)


def register_never_connected_source(name: str) -> None:
    """Register a function that returns the UAVs from which no message was ever received."""
    _register(_NEVER_RECEIVED, name)


def register_down_source(name: str) -> None:
    """Register a function that returns the UAVs that crashed or are down off plan, until a user has recorded the outcome."""
    _register(_DOWN, name)


def uavs_in_the_air(uav_ids: Collection[int]) -> set[int]:
    return _asked(_IN_THE_AIR, uav_ids)


def places_in_the_air(uav_ids: Collection[int]) -> dict[int, LonLat | None]:
    """Return the last position of each of these UAVs that is in the air; None where no position was reported."""
    return {uav_id: place for name in _sources[_IN_THE_AIR] for uav_id, place in import_string(name)(uav_ids).items()} if uav_ids else {}


def uavs_on_the_ground(uav_ids: Collection[int]) -> set[int]:
    """Return those of these UAVs that are reported on the ground. A UAV whose whereabouts are unknown is neither here nor in the air."""
    return _asked(_ON_THE_GROUND, uav_ids)


def uavs_never_connected(uav_ids: Collection[int]) -> set[int]:
    return _asked(_NEVER_RECEIVED, uav_ids)


def uavs_down_off_plan(uav_ids: Collection[int]) -> set[int]:
    return _asked(_DOWN, uav_ids)


def _register(about: str, name: str) -> None:
    if name not in _sources[about]:
        _sources[about].append(name)


def _asked(about: str, uav_ids: Collection[int]) -> set[int]:
    return {uav_id for name in _sources[about] for uav_id in import_string(name)(uav_ids)} if uav_ids else set()
