"""HGT files and archives of terrain."""

import gzip
import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from inspection.importers.terrain.raster import DatumFault, TerrainFileError, datum_named
from inspection.importers.terrain.terrain_file import HgtRaster, datum_of, opened_terrain
from tests.inspection.importers.terrain.tiffs import write_geotiff, write_hgt

SIZE = 1201 * 1201 * 2


def test_an_hgt_file_stands_where_its_name_says(tmp_path: Path) -> None:
    heights = np.zeros((1201, 1201), dtype=">i2")
    heights[0, 0], heights[1200, 1200], heights[0, 1] = 700, 300, -32768
    with opened_terrain(write_hgt(tmp_path / "S12W078.hgt", heights)) as file:
        (raster,) = file.rasters
        assert (raster.west_deg, raster.north_deg, raster.step_lon_deg) == (-78.0, -11.0, 1 / 1200)
        window = raster.window(0, 0, 1201, 1201)
        assert (window.heights_m[0, 0], window.heights_m[1200, 1200]) == (700.0, 300.0)
        assert np.isnan(window.heights_m[0, 1])
        assert raster.window(1200, 1200, 1, 1).heights_m[0, 0] == 300.0
        assert datum_of(file, "") == "EGM96"


@pytest.mark.parametrize(("name", "size"), [("N47E009.hgt", 100), ("somewhere.hgt", SIZE), ("N95E009.hgt", SIZE), ("N47E200.hgt", SIZE)])
def test_a_file_that_is_no_hgt_is_refused(name: str, size: int) -> None:
    with pytest.raises(TerrainFileError):
        HgtRaster(io.BytesIO(b"\0" * size), name)


def zipped(path: Path, **members: bytes) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def refusal(path: Path) -> str:
    with pytest.raises(TerrainFileError) as refused, opened_terrain(path) as file:
        datum_of(file, "")
    return str(refused.value)


def test_a_zip_of_several_tiles_is_one_model(tmp_path: Path) -> None:
    tile = write_hgt(tmp_path / "N46E009.hgt", 250).read_bytes()
    path = zipped(tmp_path / "tiles.zip", **{"tiles/N46E009.hgt": tile, "tiles/N46E010.SRTMGL3.hgt": tile, "readme.txt": b"tiles"})
    with opened_terrain(path) as file:
        assert [raster.west_deg for raster in file.rasters] == [9.0, 10.0]
        assert [float(raster.window(5, 5, 1, 1).heights_m[0, 0]) for raster in file.rasters] == [250.0, 250.0]


def test_the_files_of_a_zip_count_from_the_same_place(tmp_path: Path) -> None:
    heights = np.full((4, 4), 9, dtype="f4")
    parts = {f"{srid}.tif": write_geotiff(tmp_path / f"{srid}.tif", heights, srid=srid).read_bytes() for srid in (9707, 9518)}
    assert "EGM2008" in refusal(zipped(tmp_path / "mixed.zip", **parts))


def test_a_gzipped_hgt_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "N46E009.hgt.gz"
    path.write_bytes(gzip.compress(write_hgt(tmp_path / "N46E009.hgt", 250).read_bytes()))
    with opened_terrain(path) as file:
        assert file.rasters[0].window(600, 600, 1, 1).heights_m[0, 0] == 250.0


def test_hostile_archives_are_refused(tmp_path: Path) -> None:
    tile = b"\0" * SIZE
    assert "leads out" in refusal(zipped(tmp_path / "slip.zip", **{"../../N46E009.hgt": tile}))
    assert "archive in the archive" in refusal(zipped(tmp_path / "nested.zip", **{"tiles.zip": b"PK"}))
    assert "bomb" in refusal(zipped(tmp_path / "bomb.zip", **{"heights.tif": b"\0" * 200_000_000}))
    assert "1201 or 3601" in refusal(zipped(tmp_path / "large.zip", **{"N46E009.hgt": b"\0" * 200_000_000}))
    assert "no GeoTIFF or HGT" in refusal(zipped(tmp_path / "else.zip", **{"photo.jpg": b"", "program.exe": b""}))
    cut = zipped(tmp_path / "cut.zip", **{"N46E009.hgt": np.random.default_rng(1).bytes(SIZE)}).read_bytes()
    (tmp_path / "cut.zip").write_bytes(cut[: len(cut) // 2])
    assert "damaged or cut off" in refusal(tmp_path / "cut.zip")
    (tmp_path / "N46E009.hgt.gz").write_bytes(gzip.compress(b"\0" * 60_000_000))
    assert "3601 posts" in refusal(tmp_path / "N46E009.hgt.gz")


@pytest.mark.long
def test_a_zip_that_is_more_than_a_worker_takes_is_refused_before_it_is_unpacked(tmp_path: Path) -> None:
    tile = b"\0" * (3601 * 3601 * 2)
    path = zipped(tmp_path / "many.zip", **{f"N46E{degrees:03}.hgt": tile for degrees in range(21)})
    assert "more than 512 MiB" in refusal(path)


@pytest.mark.parametrize(("stated", "stored"), [("egm96", "EGM96"), ("  EGM2008 ", "EGM2008"), ("Local   gauge 1912", "Local gauge 1912")])
def test_a_datum_is_stored_by_its_name(stated: str, stored: str) -> None:
    assert datum_named(stated) == stored


@pytest.mark.parametrize("stated", ["", "x" * 51, "a\0b", "WGS84", "WGS 84 ellipsoid", "EPSG:4979", "HAE"])
def test_what_is_no_datum_or_the_ellipsoid_is_refused(stated: str) -> None:
    with pytest.raises(DatumFault):
        datum_named(stated)


def test_the_rasters_of_a_zip_can_be_read_by_turns(tmp_path: Path) -> None:
    paths = [write_geotiff(tmp_path / f"{number}.tif", np.full((4, 4), number, dtype="f4")) for number in (1, 2)]
    with zipfile.ZipFile(tmp_path / "a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for path in paths:
            archive.write(path, path.name)
    with opened_terrain(tmp_path / "a.zip") as file:
        found = [float(file.rasters[number].window(0, 0, 4, 4).heights_m[0, 0]) for number in (0, 1, 0)]
    assert found == [1, 2, 1]
