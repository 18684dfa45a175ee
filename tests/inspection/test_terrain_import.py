"""Importing terrain and asking for heights."""

import json
import math
from io import StringIO

import numpy as np
import pytest
from django.contrib.gis.gdal import GDALRaster
from django.core.management import call_command
from django.core.management.base import CommandError

from inspection.models import DataImport, TerrainTile
from inspection.selectors import ground_heights_m, has_terrain
from inspection.services import import_terrain

pytestmark = pytest.mark.django_db
STEP = 0.001


def plane(width=600, height=300, base=300.0):
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    return (base + 0.5 * x + 0.25 * y).astype(np.float32)


def geotiff(path, heights, srid=4326, origin=(9.0, 47.0), void=-9999.0):
    rows, columns = heights.shape
    raster = GDALRaster(
        {"driver": "GTiff", "name": str(path), "srid": srid, "width": columns, "height": rows, "origin": origin, "scale": (STEP, -STEP),
         "datatype": 6, "bands": [{"data": heights.tobytes(), "nodata_value": void}]}
    )  # fmt: skip
    raster._flush()
    return path


def post(column, row):
    """Position of a post: GeoTIFF's origin is the corner of the first cell."""
    return (9.0 + (column + 0.5) * STEP, 47.0 - (row + 0.5) * STEP)


def test_heights_of_a_geotiff_are_found_again_across_blocks(tmp_path):
    assert not has_terrain()
    data_import = import_terrain(path=geotiff(tmp_path / "plane.tif", plane()))
    assert has_terrain()
    assert data_import.counts["blocks"] == TerrainTile.objects.count() == 6
    cells = [(0, 0), (599, 299), (255, 255), (255.5, 255.25), (509.9, 12.3), (100.25, 200.75)]
    heights = ground_heights_m(np.array([post(*cell) for cell in cells]))
    assert heights == pytest.approx([300 + 0.5 * column + 0.25 * row for column, row in cells], abs=1e-3)


def test_outside_and_in_voids_the_height_is_unknown(tmp_path):
    heights = plane()
    heights[10, 10] = -9999.0
    import_terrain(path=geotiff(tmp_path / "plane.tif", heights))
    found = ground_heights_m(np.array([post(10, 10), post(10.5, 10.5), post(12, 12), (8.0, 47.0), (9.1, 50.0)]))
    assert np.isnan(found).tolist() == [True, True, False, True, True]
    assert ground_heights_m(np.zeros((0, 2))).shape == (0,)


def test_a_newer_model_counts_and_an_older_one_fills_its_voids(tmp_path):
    import_terrain(path=geotiff(tmp_path / "old.tif", plane(base=100.0)))
    newer = plane(base=700.0)
    newer[5:20, 5:20] = -9999.0
    import_terrain(path=geotiff(tmp_path / "new.tif", newer))
    assert ground_heights_m(np.array([post(0, 0), post(10, 10)])) == pytest.approx([700.0, 100 + 5 + 2.5], abs=1e-3)


def test_the_same_file_again_changes_nothing_and_a_changed_one_replaces_it(tmp_path):
    path = geotiff(tmp_path / "plane.tif", plane())
    first = import_terrain(path=path)
    keys = list(TerrainTile.objects.values_list("pk", flat=True))
    assert import_terrain(path=path).pk == first.pk
    assert list(TerrainTile.objects.values_list("pk", flat=True)) == keys
    path.unlink()
    import_terrain(path=geotiff(path, plane(base=900.0)))
    assert TerrainTile.objects.count() == len(keys)
    assert ground_heights_m(np.array([post(0, 0)])) == pytest.approx([900.0], abs=1e-3)


def test_an_hgt_file_is_read(tmp_path):
    heights = np.full((1201, 1201), 250, dtype=">i2")
    heights[600, 600] = 300
    path = tmp_path / "N46E009.hgt"
    path.write_bytes(heights.tobytes())
    out = StringIO()
    call_command("import_terrain", str(path), "--json", stdout=out)
    assert json.loads(out.getvalue())["highest_m"] == 300.0
    assert ground_heights_m(np.array([(9.5, 46.5), (9.1, 46.9)])) == pytest.approx([300.0, 250.0])


def test_files_that_are_no_terrain_are_refused(tmp_path):
    flat = plane(4, 4)
    cases = {
        "utm.tif": (lambda path: geotiff(path, flat, srid=32632, origin=(500_000, 5_000_000)), "EPSG:4326"),
        "cut.tif": (lambda path: path.write_bytes(geotiff(tmp_path / "whole.tif", plane()).read_bytes()[:3_000]), "GeoTIFF|damaged"),
        "voids.tif": (lambda path: geotiff(path, np.full((4, 4), -9999.0, dtype=np.float32)), "only voids"),
        "nan.tif": (lambda path: geotiff(path, np.full((4, 4), math.nan, dtype=np.float32)), "only voids"),
        "text.tif": (lambda path: path.write_text("II*, but no"), "neither|cannot be read"),
        "map.vrt": (lambda path: path.write_text("<VRTDataset rasterXSize='2' rasterYSize='2'/>"), "neither"),
        "far.tif": (lambda path: geotiff(path, flat, origin=(500.0, 95.0)), "beyond"),
    }
    for name, (make, message) in cases.items():
        make(tmp_path / name)
        with pytest.raises(CommandError, match=message):
            call_command("import_terrain", str(tmp_path / name))
    assert (TerrainTile.objects.count(), DataImport.objects.count()) == (0, 0)
