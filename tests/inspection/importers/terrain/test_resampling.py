"""Terrain in other systems than longitude and latitude."""

from pathlib import Path

import numpy as np
import pytest
from pyproj import Transformer

from inspection.importers.terrain.raster import PostKind, PostSurvey, TerrainFileError, blocks_of
from inspection.importers.terrain.terrain_file import opened_terrain
from tests.inspection.importers.terrain.tiffs import write_geotiff


def slope(columns: int = 200, rows: int = 160) -> np.ndarray:
    """Rises 0.5 m a post to the east and 0.25 m to the south: between posts a plane is exact."""
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    return (300 + 0.5 * x + 0.25 * y).astype("f4")


@pytest.mark.parametrize(("srid", "origin", "step"), [(2056, (2_600_000, 1_200_000), 25.0), (32632, (600_000, 5_200_000), 30.0)])
def test_heights_of_a_projected_file_stand_where_they_stood(tmp_path: Path, srid: int, origin: tuple[float, float], step: float) -> None:
    path = write_geotiff(tmp_path / "grid.tif", slope(), srid=srid, origin=origin, step=step)
    with opened_terrain(path) as file:
        (raster,) = file.rasters
        assert "sampled anew" in file.notes[0]
        grids = [block.grid for block in blocks_of(raster) if block.grid is not None]
    at = np.random.default_rng(7).uniform([5, 5], [190, 150], (400, 2))
    lon, lat = Transformer.from_crs(srid, 4326, always_xy=True).transform(
        origin[0] + (at[:, 0] + 0.5) * step, origin[1] - (at[:, 1] + 0.5) * step
    )
    found = np.nanmax([grid.sample(np.column_stack([lon, lat])) for grid in grids], axis=0)
    assert found == pytest.approx(300 + 0.5 * at[:, 0] + 0.25 * at[:, 1], abs=0.01)


def test_it_is_sampled_as_finely_as_it_is_on_the_ground(tmp_path: Path) -> None:
    """A metre of web Mercator at 47 degrees north is 0.68 m."""
    with opened_terrain(write_geotiff(tmp_path / "web.tif", slope(), srid=3857, origin=(1e6, 5.942e6), step=30.0)) as file:
        assert file.resolution_m == pytest.approx(30 * np.cos(np.radians(47)), rel=0.01)
        assert file.rasters[0].width >= 200


def test_voids_stay_voids_and_the_corners_of_an_askew_file_are_none(tmp_path: Path) -> None:
    heights = slope()
    heights[50:60, 70:90] = -9999.0
    heights[100, 100] = 99_999.0
    with opened_terrain(write_geotiff(tmp_path / "askew.tif", heights, srid=32632, origin=(700_000, 5_200_000), step=30.0)) as file:
        survey = PostSurvey()
        whole = file.rasters[0].window(0, 0, file.rasters[0].height, file.rasters[0].width)
        for block in blocks_of(file.rasters[0]):
            survey.add(block)
    assert (whole.kinds == PostKind.OUTSIDE).any()
    assert survey.posts == int((whole.kinds != PostKind.OUTSIDE).sum())
    assert 200 <= survey.voids <= 330  # 200 posts, and those beside them that would be mixed with a void
    assert survey.undeclared_voids >= 1
    assert survey.highest_m < 500


@pytest.mark.parametrize("srid", [4258, 4269])
def test_a_system_that_is_as_good_as_wgs_84_is_taken_as_it_stands(tmp_path: Path, srid: int) -> None:
    with opened_terrain(write_geotiff(tmp_path / "near.tif", slope(), srid=srid)) as file:
        assert (file.rasters[0].west_deg, file.rasters[0].north_deg) == pytest.approx((9.0005, 46.9995), abs=1e-9)
        assert "less than 2 m" in file.notes[0]


def test_a_system_of_another_shape_of_the_earth_is_not(tmp_path: Path) -> None:
    """DHDN lies some 100 m away."""
    with opened_terrain(write_geotiff(tmp_path / "dhdn.tif", slope(), srid=4314)) as file:
        assert abs(file.rasters[0].west_deg - 9.0005) > 5e-4
        assert "sampled anew" in file.notes[0]


@pytest.mark.parametrize(
    ("srid", "origin", "step"), [(4326, (500.0, 95.0), 0.001), (32632, (9e7, 5e6), 30.0), (4326, (179.99, 47.0), 0.01)]
)
def test_what_reaches_beyond_the_earth_is_refused(tmp_path: Path, srid: int, origin: tuple[float, float], step: float) -> None:
    with pytest.raises(TerrainFileError), opened_terrain(write_geotiff(tmp_path / "far.tif", slope(), srid=srid, origin=origin, step=step)):
        pass
