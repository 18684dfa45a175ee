"""The table of zones of the ground, with their bands over real terrain tiles."""

import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from inspection.models import NoFlyZone
from inspection.selectors.terrain import ground_heights_m
from inspection.selectors.zone_table import ground_range_m, zone_table
from inspection.services import import_terrain, mark_ground_changed
from tests.inspection import ground
from tests.inspection.importers.terrain.tiffs import write_geotiff

pytestmark = pytest.mark.django_db

ABOVE_SEA = {"lower_limit_m": 400.0, "lower_reference": "AMSL", "upper_limit_m": 1_000.0, "upper_reference": "AMSL"}


def hills(path: Path, heights_m: np.ndarray | None = None) -> None:
    """300 by 300 posts from 9.9 E 56.15 N, 0.001 degrees apart; rising from 100 m to 399 m eastwards unless told otherwise."""
    if heights_m is None:
        heights_m = np.tile(100 + np.arange(300, dtype="f4"), (300, 1))
    import_terrain(path=write_geotiff(path, heights_m, srid=9707, origin=(9.9, 56.15)))


def only_zone() -> tuple[float, float]:
    mark_ground_changed()
    table = zone_table()
    return table.floor_agl_m[-1], table.ceiling_agl_m[-1]


def test_rows_are_as_the_zones_state_them() -> None:
    schedule = [{"startDateTime": None, "endDateTime": "2030-01-01T00:00:00Z", "schedule": []}]
    first = ground.zone(name="Airport", lower_limit_m=30.0, lower_reference="AGL", schedule=schedule)
    second = ground.zone((11.0, 56.0), name="Prison")
    mark_ground_changed()
    table = zone_table()
    assert table.ids.tolist() == [first.pk, second.pk]
    assert table.names == ("Airport", "Prison")
    assert table.schedules == (schedule, None)
    assert table.floor_agl_m.tolist() == [30.0, -math.inf]
    assert table.ceiling_agl_m.tolist() == [math.inf, math.inf]
    assert table.box[1].tolist() == pytest.approx([10.99, 55.99, 11.01, 56.01])
    assert zone_table() is table


def test_without_zones_the_table_is_empty() -> None:
    NoFlyZone.objects.all().delete()
    mark_ground_changed()
    table = zone_table()
    assert len(table) == 0
    assert table.active_within(0.0, 1.0).tolist() == []
    assert table.reaching(0.0, 1.0).tolist() == []


def test_limits_above_sea_level_count_from_the_lowest_and_highest_ground_under_the_zone(tmp_path: Path) -> None:
    """Posts stand in the middle of their cells: around 10.0 to 10.02 E they are from 199 m to 220 m high."""
    hills(tmp_path / "hills.tif")
    ground.zone((10.01, 56.0), 0.01, **ABOVE_SEA)
    floor_m, ceiling_m = only_zone()
    assert floor_m == pytest.approx(400 - 220, abs=1.01)
    assert ceiling_m == pytest.approx(1_000 - 199, abs=1.01)


def test_without_terrain_or_beyond_its_edge_they_cannot_be_compared(tmp_path: Path) -> None:
    ground.zone((10.01, 56.0), 0.01, **ABOVE_SEA)
    assert only_zone() == (-math.inf, math.inf)
    hills(tmp_path / "hills.tif")
    assert only_zone()[0] > 0
    ground.zone((10.2, 56.0), 0.01, **ABOVE_SEA)
    assert only_zone() == (-math.inf, math.inf)


def test_a_hole_in_the_terrain_under_the_zone_is_unknown_and_one_beside_it_is_not(tmp_path: Path) -> None:
    heights = np.full((300, 300), 100.0, dtype="f4")
    heights[150, 110] = np.nan  # at 10.0105 E 55.9995 N
    hills(tmp_path / "holed.tif", heights)
    ground.zone((10.01, 56.0), 0.01, **ABOVE_SEA)
    assert only_zone() == (-math.inf, math.inf)
    ground.zone((10.05, 56.0), 0.01, **ABOVE_SEA)
    assert only_zone() == (300.0, 900.0)


def test_a_zone_over_several_tiles_sees_the_one_peak(tmp_path: Path) -> None:
    heights = np.full((300, 300), 50.0, dtype="f4")
    heights[280, 290] = 777.0  # the tiles are of 256 posts
    hills(tmp_path / "peak.tif", heights)
    ground.zone((10.1, 55.95), 0.09, **ABOVE_SEA)
    assert only_zone() == (400.0 - 777.0, 950.0)


def test_no_sample_under_a_zone_is_outside_its_range(tmp_path: Path) -> None:
    draw = np.random.default_rng(3)
    hills(tmp_path / "rough.tif", draw.uniform(0, 500, (300, 300)).astype("f4"))
    for _ in range(10):
        lon, lat = draw.uniform(9.93, 10.15), draw.uniform(55.88, 56.11)
        polygon = shapely.MultiPolygon([shapely.Point(lon, lat).buffer(draw.uniform(0.0002, 0.02))])
        lowest, highest = ground_range_m(polygon)
        west, south, east, north = polygon.bounds
        samples = np.column_stack([draw.uniform(west, east, 2_000), draw.uniform(south, north, 2_000)])
        heights = ground_heights_m(samples[shapely.intersects_xy(polygon, samples)])
        assert lowest <= heights.min()
        assert heights.max() <= highest
