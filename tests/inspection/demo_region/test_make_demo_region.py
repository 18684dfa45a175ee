"""manage.py make_demo_region writes three files, the same each time."""

import hashlib
import json
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from django.contrib.gis.gdal import GDALRaster
from django.core.management import call_command

from inspection.demo_region import BASES, make_quillmoor, make_region, write_osm_file
from inspection.importers.terrain.terrain_file import opened_terrain
from inspection.selectors import ground_heights_m
from inspection.services import import_terrain

NAMES = ["demo-terrain.tif", "demo-zones.json", "demo.osm.pbf"]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    directory = tmp_path_factory.mktemp("demo")
    output = StringIO()
    call_command("make_demo_region", str(directory), stdout=output)
    return directory, output.getvalue()


def test_it_writes_three_files_and_prints_their_paths(written: tuple[Path, str]) -> None:
    directory, output = written
    assert sorted(path.name for path in directory.iterdir()) == NAMES
    assert all(str(directory / name) in output for name in NAMES)
    assert "synthetic" in output


@pytest.mark.long
def test_two_runs_write_the_same_bytes(written: tuple[Path, str], tmp_path: Path) -> None:
    call_command("make_demo_region", str(tmp_path / "made" / "on the way"), stdout=StringIO())
    for name in NAMES:
        first, second = written[0] / name, tmp_path / "made" / "on the way" / name
        assert hashlib.sha256(first.read_bytes()).digest() == hashlib.sha256(second.read_bytes()).digest(), name


def test_the_second_region_is_written_on_request(tmp_path: Path) -> None:
    output = StringIO()
    call_command("make_demo_region", str(tmp_path / "files"), "--region", "quillmoor", "--seed", "3", stdout=output)
    (path,) = (tmp_path / "files").iterdir()
    write_osm_file(tmp_path / "expected.osm.pbf", make_quillmoor(seed=3))
    assert path.name == "quillmoor.osm.pbf"
    assert path.read_bytes() == (tmp_path / "expected.osm.pbf").read_bytes()
    assert output.getvalue().startswith("Quillmoor (synthetic, seed 3): ") and str(path) in output.getvalue()


def test_the_zone_file_is_an_ed269_document_that_says_synthetic(written: tuple[Path, str]) -> None:
    document = json.loads((written[0] / "demo-zones.json").read_text())
    assert "synthetic" in document["title"]
    assert len({feature["identifier"] for feature in document["features"]}) == 8
    assert all(len(feature["identifier"]) == 7 for feature in document["features"])
    assert sum("schedule" in feature["applicability"][0] for feature in document["features"]) == 1


def test_the_terrain_file_holds_the_drawn_heights_where_they_were_drawn(written: tuple[Path, str]) -> None:
    raster = GDALRaster(str(written[0] / "demo-terrain.tif"))
    terrain = make_region().terrain
    assert (raster.origin.x, raster.origin.y) == pytest.approx((terrain.west_deg, terrain.north_deg), abs=1e-12)
    assert (raster.scale.x, raster.scale.y) == pytest.approx((terrain.step_deg, -terrain.step_deg), abs=1e-15)
    assert np.array_equal(raster.bands[0].data(), terrain.heights_amsl_m)
    with opened_terrain(written[0] / "demo-terrain.tif") as file:
        assert (file.reference_systems, file.vertical_datum) == (["WGS 84"], "EGM96")


@pytest.mark.long
@pytest.mark.django_db
def test_the_imported_terrain_gives_the_drawn_heights_at_the_bases(written: tuple[Path, str]) -> None:
    import_terrain(path=written[0] / "demo-terrain.tif", is_synthetic=True)
    terrain = make_region().terrain
    positions = np.array([base.position for base in BASES])
    columns = ((positions[:, 0] - terrain.west_deg) / terrain.step_deg).astype(int)
    rows = ((terrain.north_deg - positions[:, 1]) / terrain.step_deg).astype(int)
    assert ground_heights_m(positions) == pytest.approx(terrain.heights_amsl_m[rows, columns], abs=5.0)
