"""What a later app knows of UAVs that are in the air while a mission is planned for them or another UAV is started."""

from collections.abc import Collection

from django.utils.module_loading import import_string

from inspection.geodesy import LonLat

_sources: list[str] = []


def register_source(name: str) -> None:
    """The dotted name of a function that returns those of the given UAVs, by their ids, that are reported to be in the air.

    With where each was last, None where it has told no place.
    """
    if name not in _sources:
        _sources.append(name)


def uavs_in_the_air(uav_ids: Collection[int]) -> set[int]:
    return set(places_in_the_air(uav_ids))


def places_in_the_air(uav_ids: Collection[int]) -> dict[int, LonLat | None]:
    """Where those of these UAVs that are in the air were last."""
    return {uav_id: place for name in _sources for uav_id, place in import_string(name)(uav_ids).items()} if uav_ids else {}
