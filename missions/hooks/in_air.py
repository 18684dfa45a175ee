"""What a later app knows of UAVs: which are in the air and where, on the ground, down off their plans, or never connected."""

from collections import defaultdict
from collections.abc import Collection

from django.utils.module_loading import import_string

from inspection.geodesy import LonLat

_IN_THE_AIR, _ON_THE_GROUND, _NEVER_RECEIVED, _DOWN = "in the air", "on the ground", "never heard", "down off its plan"
_sources: dict[str, list[str]] = defaultdict(list)


def register_source(name: str) -> None:
    """The dotted name of a function that returns those of the given UAVs, by their ids, that are reported to be in the air.

    With where each was last, None where it has told no place.
    """
    _register(_IN_THE_AIR, name)


def register_ground_source(name: str) -> None:
    """Of a function that returns those that are reported to stand on the ground and may not have taken off since."""
    _register(_ON_THE_GROUND, name)


def register_never_connected_source(name: str) -> None:
    """Of a function that returns those of which nothing was ever received."""
    _register(_NEVER_RECEIVED, name)


def register_down_source(name: str) -> None:
    """Of a function that returns those that crashed, or are down away from their plans, until a person has said what became of them."""
    _register(_DOWN, name)


def uavs_in_the_air(uav_ids: Collection[int]) -> set[int]:
    return _asked(_IN_THE_AIR, uav_ids)


def places_in_the_air(uav_ids: Collection[int]) -> dict[int, LonLat | None]:
    """Where those of these UAVs that are in the air were last."""
    return {uav_id: place for name in _sources[_IN_THE_AIR] for uav_id, place in import_string(name)(uav_ids).items()} if uav_ids else {}


def uavs_on_the_ground(uav_ids: Collection[int]) -> set[int]:
    """One of which nobody knows where it is, is in neither set."""
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
