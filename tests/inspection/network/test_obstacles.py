"""What cannot be flown over, joined with zones: made once for the two, and no longer kept than they are."""

import gc
from weakref import ref

import numpy as np
import pytest
from shapely import box

from inspection.network.build.obstacles import WALL, obstacle_index_of, with_obstacles
from inspection.network.zones.zone_index import ZoneIndex


def zone(west: float, name: str) -> ZoneIndex:
    return ZoneIndex([box(west, 50.0, west + 0.01, 50.01)], [7], [name], floor_agl_m=[30.0], ceiling_agl_m=[60.0])


def obstacles(west: float) -> ZoneIndex:
    return obstacle_index_of(np.array([box(west, 50.0, west + 0.001, 50.001)], dtype=object))


def no_obstacles() -> ZoneIndex:
    return obstacle_index_of(np.zeros(0, dtype=object))


def test_both_are_in_it_zones_first_with_their_heights() -> None:
    both = with_obstacles(zone(3.0, "Airport"), obstacles(4.0))
    assert both.names == ("Airport", WALL)
    assert both.ids.tolist() == [7, -1]
    assert [shape.bounds[0] for shape in both.polygons] == [3.0, 4.0]
    assert both.floor_agl_m[0] == 30.0
    assert both.ceiling_agl_m[0] == 60.0


def test_it_is_made_once_for_the_two() -> None:
    zones, others, tall = zone(3.0, "Airport"), zone(3.0, "Airport"), obstacles(4.0)
    assert with_obstacles(zones, tall) is with_obstacles(zones, tall)
    assert with_obstacles(others, tall) is not with_obstacles(zones, tall)
    assert with_obstacles(zones, obstacles(4.0)) is not with_obstacles(zones, tall)


def test_without_walls_it_is_the_zones() -> None:
    zones = zone(3.0, "Airport")
    assert with_obstacles(zones, no_obstacles()) is zones


@pytest.mark.parametrize("gone", ["zones", "obstacles"])
@pytest.mark.parametrize("is_tall", [True, False])
def test_zones_that_went_are_not_kept(gone: str, *, is_tall: bool) -> None:
    """Each change of the zones makes another set, and each is as large as all zones are."""
    pair = {"zones": zone(3.0, "Airport"), "obstacles": obstacles(4.0) if is_tall else no_obstacles()}
    kept = [ref(pair[gone]), *([ref(with_obstacles(**pair))] if is_tall else [])]
    del pair[gone]
    gc.collect()
    assert [one() for one in kept] == [None] * len(kept)
