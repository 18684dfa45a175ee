"""Importing terrain and asking for heights."""

import json
import math
from io import StringIO

import numpy as np
import pytest
from django.core.management import call_command
from django.core.management.base import CommandError

from inspection.models import DataImport, TerrainTile
from inspection.selectors import ground_heights_m, has_terrain
from inspection.selectors.terrain import ground_truth
from inspection.services import TerrainFileError, import_terrain
from tests.inspection.importers.terrain.tiffs import write_geotiff, write_hgt

pytestmark = pytest.mark.django_db
STEP = 0.001


def plane(width=600, height=300, base=300.0):
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    return (base + 0.5 * x + 0.25 * y).astype(np.float32)


def geotiff(path, heights, srid=9707, **options):
    """With its vertical datum, EGM96, stated."""
    return write_geotiff(path, heights, srid=srid, **options)


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
    path = write_hgt(tmp_path / "N46E009.hgt", heights)
    out = StringIO()
    call_command("import_terrain", str(path), "--json", stdout=out)
    assert json.loads(out.getvalue())["highest_m"] == 300.0
    assert ground_heights_m(np.array([(9.5, 46.5), (9.1, 46.9)])) == pytest.approx([300.0, 250.0])


def test_files_that_are_no_terrain_are_refused(tmp_path):
    flat = plane(4, 4)
    cases = {
        "silent.tif": (lambda path: geotiff(path, flat, srid=4326), "does not say from where"),
        "cut.tif": (lambda path: path.write_bytes(geotiff(tmp_path / "whole.tif", plane()).read_bytes()[:3_000]), "cut off"),
        "voids.tif": (lambda path: geotiff(path, np.full((4, 4), -9999.0, dtype=np.float32)), "only voids"),
        "nan.tif": (lambda path: geotiff(path, np.full((4, 4), math.nan, dtype=np.float32)), "only voids"),
        "text.tif": (lambda path: path.write_text("II*, but no"), "neither"),
        "map.vrt": (lambda path: path.write_text("<VRTDataset rasterXSize='2' rasterYSize='2'/>"), "a VRT file"),
        "far.tif": (lambda path: geotiff(path, flat, origin=(500.0, 95.0)), "beyond"),
    }
    for name, (make, message) in cases.items():
        make(tmp_path / name)
        with pytest.raises(CommandError, match=message):
            call_command("import_terrain", str(tmp_path / name))
    assert (TerrainTile.objects.count(), DataImport.objects.count()) == (0, 0)


def test_a_file_that_states_no_datum_is_taken_with_the_one_that_is_said(tmp_path):
    path = geotiff(tmp_path / "silent.tif", plane(4, 4), srid=4326)
    first = import_terrain(path=path, vertical_datum="EGM2008")
    assert import_terrain(path=path, vertical_datum="EGM2008").pk == first.pk
    other = import_terrain(path=path, vertical_datum="EGM96")
    assert set(TerrainTile.objects.values_list("data_import", "vertical_datum")) == {(other.pk, "EGM96")}


def test_between_files_that_stand_side_by_side_is_no_gap(tmp_path):
    """GeoTIFF tiles of whole degrees share no posts: between the last of one and the first of the next lies a step."""
    whole = plane(600, 300)
    for name, rows, columns in (
        ("a", slice(0, 150), slice(0, 300)),
        ("b", slice(0, 150), slice(300, 600)),
        ("c", slice(150, 300), slice(0, 300)),
    ):
        corner = (9.0 + columns.start * STEP, 47.0 - rows.start * STEP)
        import_terrain(path=geotiff(tmp_path / f"{name}.tif", whole[rows, columns], origin=corner))
    cells = [(299.5, 40.25), (299.1, 100.0), (120.3, 149.7), (299.0, 149.5)]
    found = ground_heights_m(np.array([post(*cell) for cell in cells]))
    assert found == pytest.approx([300 + 0.5 * column + 0.25 * row for column, row in cells], abs=1e-3)
    beyond = ground_heights_m(np.array([post(299.5, 149.5), post(450, 149.5), post(600.2, 10), post(299.5, -0.5)]))
    assert np.isnan(beyond).all()  # one of the four posts is in no file


def test_a_void_at_the_seam_of_two_files_stays_one(tmp_path):
    left, right = plane(300, 150), plane(300, 150)
    left[70, 299] = -9999.0
    import_terrain(path=geotiff(tmp_path / "left.tif", left))
    import_terrain(path=geotiff(tmp_path / "right.tif", right, origin=(9.3, 47.0)))
    assert np.isnan(ground_heights_m(np.array([post(299.5, 70.2)]))).all()
    assert np.isfinite(ground_heights_m(np.array([post(299.5, 72.0)]))).all()


def test_each_height_is_told_with_the_model_that_it_is_from(tmp_path):
    older = import_terrain(path=geotiff(tmp_path / "older.tif", plane(base=100.0)))
    newer = plane(base=700.0)
    newer[5:20, 5:20] = -9999.0
    top = import_terrain(path=geotiff(tmp_path / "newer.tif", newer))
    truth = ground_truth(np.array([post(0, 0), post(10, 10), (8.0, 47.0)]))
    assert truth.imports.tolist() == [top.pk, older.pk, -1]


def test_many_places_are_answered_as_each_by_itself(tmp_path):
    rough = plane() + np.random.default_rng(5).normal(0, 40, (300, 600)).astype(np.float32)
    rough[100:120, 200:300] = -9999.0
    import_terrain(path=geotiff(tmp_path / "older.tif", plane(400, 200, base=100.0)))
    import_terrain(path=geotiff(tmp_path / "rough.tif", rough, origin=(9.1, 46.95)))
    places = np.random.default_rng(6).uniform([8.9, 46.6], [9.8, 47.1], (300, 2))
    together = ground_heights_m(places)
    assert np.isnan(together).any()
    assert np.allclose(together, [ground_heights_m(place[None])[0] for place in places], equal_nan=True)


def test_a_damaged_file_brings_nothing_in_and_takes_nothing_away(tmp_path):
    path = geotiff(tmp_path / "plane.tif", plane(), compress="deflate")
    import_terrain(path=path)
    whole = path.read_bytes()
    place = len(whole) // 2  # in the middle of packed heights
    path.write_bytes(whole[:place] + bytes(64) + whole[place + 64 :])
    with pytest.raises(TerrainFileError, match="damaged"):
        import_terrain(path=path)
    assert (TerrainTile.objects.count(), DataImport.objects.count()) == (6, 1)
