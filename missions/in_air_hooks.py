"""What a later app knows of UAVs that are in the air while a mission is planned for them."""

from collections.abc import Collection

from django.utils.module_loading import import_string

_sources: list[str] = []


def register_source(name: str) -> None:
    """The dotted name of a function that returns those of the given UAVs, by their ids, that are reported to be in the air."""
    if name not in _sources:
        _sources.append(name)


def uavs_in_the_air(uav_ids: Collection[int]) -> set[int]:
    return {uav_id for name in _sources for uav_id in import_string(name)(uav_ids)} if uav_ids else set()
