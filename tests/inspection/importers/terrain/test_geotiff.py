"""GeoTIFFs as GDAL writes them, read by our own reader; what it states of its heights; and files that are none."""

import struct
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inspection.importers.terrain.geotiff import MAX_PART_BYTES
from inspection.importers.terrain.raster import PostKind, TerrainFileError
from inspection.importers.terrain.terrain_file import datum_of, opened_terrain
from tests.inspection.importers.terrain.tiffs import opened_tiff, write_geotiff

MIB = 1024 * 1024


def hills(dtype: str = "f4", shape: tuple[int, int] = (107, 171)) -> np.ndarray:
    y, x = np.mgrid[: shape[0], : shape[1]]
    heights = 120 + 90 * np.sin(x / 17) + np.random.default_rng(2).normal(0, 4, shape) + y / 9
    return np.clip(heights, 0, 250).astype(dtype)


PACKINGS = [
    (dtype, packing)
    for dtype in ("u1", "i2", "u2", "i4", "u4", "f4", "f8")
    for packing in (
        {}, {"tiled": "yes", "blockxsize": 64, "blockysize": 48}, {"endianness": "big"}, {"bigtiff": "yes"}, {"compress": "packbits"},
        {"compress": "lzw"}, {"compress": "deflate", "tiled": "yes", "blockxsize": 32, "blockysize": 16, "bigtiff": "yes"},
        {"compress": "lzw", "predictor": 2, "endianness": "big"}, {"compress": "deflate", "predictor": 2, "tiled": "yes"},
        {"compress": "deflate", "predictor": 3}, {"compress": "lzw", "predictor": 3, "tiled": "yes"},
    )
    if not (packing.get("predictor") == 3 and dtype not in ("f4", "f8")) and not (packing.get("predictor") == 2 and dtype == "f8")
]  # fmt: skip


@pytest.mark.parametrize(("dtype", "packing"), PACKINGS)
def test_heights_are_those_that_gdal_wrote(tmp_path: Path, dtype: str, packing: dict[str, str]) -> None:
    heights = hills(dtype)
    with opened_tiff(write_geotiff(tmp_path / "hills.tif", heights, void=None, **packing)) as tiff:
        assert (tiff.width, tiff.height) == (171, 107)
        for row, column, rows, columns in ((0, 0, 107, 171), (31, 60, 40, 70), (106, 170, 1, 1)):
            window = tiff.window(row, column, rows, columns)
            assert np.array_equal(window.heights_m, heights[row : row + rows, column : column + columns].astype(np.float32))


def test_a_part_that_a_sparse_file_leaves_out_is_void(tmp_path: Path) -> None:
    heights = np.full((64, 64), 50, dtype="f4")
    heights[:32, :32] = -9999.0
    options = {"sparse_ok": "true", "tiled": "yes", "blockxsize": 32, "blockysize": 32}
    with opened_tiff(write_geotiff(tmp_path / "sparse.tif", heights, **options)) as tiff:
        kinds = tiff.window(0, 0, 64, 64).kinds
    assert (kinds[:32, :32] == PostKind.DECLARED_VOID).all()
    assert (kinds[32:] == PostKind.HEIGHT).all()


def test_posts_stand_in_the_middle_of_cells_or_on_the_corner_as_the_file_says(tmp_path: Path) -> None:
    path = write_geotiff(tmp_path / "area.tif", hills())
    with opened_tiff(path) as tiff:
        assert (tiff.x, tiff.y) == pytest.approx((9.0005, 46.9995), abs=1e-9)
    as_points = bytes(path.read_bytes()).replace(struct.pack("<4H", 1025, 0, 1, 1), struct.pack("<4H", 1025, 0, 1, 2))
    path.write_bytes(as_points)
    with opened_tiff(path) as tiff:
        assert (tiff.x, tiff.y) == pytest.approx((9.0, 47.0), abs=1e-9)


@pytest.mark.parametrize(("srid", "datum"), [(4326, None), (9707, "EGM96"), (9518, "EGM2008"), (5972, "NN2000"), (7405, "ODN")])
def test_the_vertical_datum_is_read_where_the_file_states_it(tmp_path: Path, srid: int, datum: str | None) -> None:
    with opened_terrain(write_geotiff(tmp_path / "stated.tif", hills(), srid=srid, **_around(srid))) as file:
        assert file.vertical_datum == datum
        assert datum_of(file, "EVRF2007") == (datum or "EVRF2007")  # what the file states wins


def _around(srid: int) -> dict[str, object]:
    return {"origin": (400_000, 200_000), "step": 30.0} if srid in (5972, 7405) else {}


def test_a_height_that_counts_from_nowhere_is_refused(tmp_path: Path) -> None:
    with opened_terrain(write_geotiff(tmp_path / "silent.tif", hills())) as file, pytest.raises(TerrainFileError, match="does not say"):
        datum_of(file, " ")


def replaced(path: Path, old: tuple[int, ...], new: tuple[int, ...]) -> Path:
    """Other geo keys, of 16 bits each; GDAL leaves older copies of them behind."""
    data = path.read_bytes()
    before, after = struct.pack(f"<{len(old)}H", *old), struct.pack(f"<{len(new)}H", *new)
    assert before in data
    path.write_bytes(data.replace(before, after))
    return path


@pytest.mark.parametrize(
    ("srid", "old", "new"),
    [
        (4326, (2048, 0, 1, 4326), (2048, 0, 1, 4979)),  # a geographic system with an axis of its own for heights
        (9707, (4096, 0, 1, 5773), (4096, 0, 1, 5030)),  # GeoTIFF 1.0: WGS 84 ellipsoid
    ],
)
def test_heights_above_the_ellipsoid_are_refused(tmp_path: Path, srid: int, old: tuple[int, ...], new: tuple[int, ...]) -> None:
    path = replaced(write_geotiff(tmp_path / "ellipsoid.tif", hills(), srid=srid), old, new)
    with pytest.raises(TerrainFileError, match="ellipsoid"), opened_terrain(path):
        pass


def test_feet_become_metres(tmp_path: Path) -> None:
    """The vertical system of EPSG:6360 is NAVD88 in US survey feet."""
    path = write_geotiff(tmp_path / "feet.tif", np.full((4, 4), 1_000, dtype="i2"), srid=9707)
    replaced(path, (4096, 0, 1, 5773), (4096, 0, 1, 6360))
    with opened_terrain(path) as file:
        assert file.rasters[0].window(0, 0, 4, 4).heights_m == pytest.approx(304.8006, abs=1e-3)
        assert file.vertical_datum == "NAVD88"


def test_a_system_that_is_not_known_is_refused(tmp_path: Path) -> None:
    path = replaced(write_geotiff(tmp_path / "none.tif", hills()), (2048, 0, 1, 4326), (2048, 0, 1, 9999))
    with pytest.raises(TerrainFileError, match=r"that is not known.*gdalwarp"), opened_terrain(path):
        pass


def test_scales_and_units_become_metres_and_others_are_refused(tmp_path: Path) -> None:
    heights = np.full((4, 4), 1_000, dtype="i2")
    path = write_geotiff(tmp_path / "scaled.tif", heights, scale=0.125, unit="ft")
    with opened_tiff(path) as tiff:
        assert tiff.window(0, 0, 4, 4).heights_m == pytest.approx(125 * 0.3048)
    path.write_bytes(path.read_bytes().replace(b"0.125", b"words"))
    with pytest.raises(TerrainFileError, match="scaled by what is no number"), opened_terrain(path):
        pass
    path = write_geotiff(tmp_path / "furlongs.tif", heights, unit="furlong")
    with pytest.raises(TerrainFileError, match="'furlong', a unit that is not known"), opened_terrain(path):
        pass


def test_what_states_no_code_of_its_system_is_refused_with_a_way_out(tmp_path: Path) -> None:
    path = replaced(write_geotiff(tmp_path / "own.tif", hills()), (2048, 0, 1, 4326), (2048, 0, 1, 32767))
    with pytest.raises(TerrainFileError, match=r"in its own words.*gdalwarp"), opened_terrain(path):
        pass


# Hostile files


def tiff_of(data: bytes, *, width: int, height: int, rows_per_strip: int, strips: int = 1, compression: int = 8, bits: int = 32) -> bytes:
    """A classic TIFF in EPSG:4326; each of its strips is `data`."""
    keys = struct.pack("<12H", 1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326)
    place = struct.pack("<3d", 1e-4, 1e-4, 0), struct.pack("<6d", 0, 0, 0, 9, 47, 0)
    first = 8
    parts = [data, struct.pack(f"<{strips}I", *[first] * strips), struct.pack(f"<{strips}I", *[len(data)] * strips), keys, *place]
    starts = np.cumsum([first, *map(len, parts)]).tolist()
    offsets, counts = (first, len(data)) if strips == 1 else starts[1:3]
    entries = [
        (256, 4, 1, width), (257, 4, 1, height), (258, 3, 1, bits), (259, 3, 1, compression), (273, 4, strips, offsets),
        (277, 3, 1, 1), (278, 4, 1, rows_per_strip), (279, 4, strips, counts), (339, 3, 1, 3),
        (33550, 12, 3, starts[4]), (33922, 12, 6, starts[5]), (34735, 3, 12, starts[3]),
    ]  # fmt: skip
    directory = struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *entry) for entry in entries) + struct.pack("<I", 0)
    return struct.pack("<2sHI", b"II", 42, starts[-1]) + b"".join(parts) + directory


ZEROS = zlib.compress(bytes(4_000_000), 9)  # 1000 : 1
CUT_OFF_BLOCK = zlib.compress(np.full(10_000, 300, dtype="<f4").tobytes(), 9)[:-8]

HOSTILE = [
    (tiff_of(ZEROS, width=40_000, height=4_000, rows_per_strip=4_000), f"at most {MAX_PART_BYTES // MIB} MiB"),
    (tiff_of(ZEROS, width=2_000_000, height=2_000_000, rows_per_strip=1), "at most 200000000"),
    (tiff_of(ZEROS, width=3, height=60_000_000, rows_per_strip=1), "at most 1000000"),
    (tiff_of(CUT_OFF_BLOCK, width=100, height=100, rows_per_strip=100), "damaged or cut off"),
    (tiff_of(b"not packed at all", width=100, height=100, rows_per_strip=100), "damaged or cut off"),
    (tiff_of(b"\xff" * 500, width=100, height=100, rows_per_strip=100, compression=5), "damaged or cut off"),
    (tiff_of(b"", width=100, height=100, rows_per_strip=100, compression=7), "JPEG"),
    (tiff_of(ZEROS, width=100, height=100, rows_per_strip=0), "RowsPerStrip"),
    (tiff_of(ZEROS, width=100, height=100, rows_per_strip=100, bits=128), "BitsPerSample=128"),
    (b"II*\0\xff\xff\xff\x7f", "cut off"),
    (b"II*\0", "cut off"),
    (b"II*\0\x08\0\0\0\xff\xff", "damaged"),
    (b"II+\0\x08\0\0\0" + b"\xff" * 8, "cut off"),
    (b'<VRTDataset rasterXSize="9"><SourceFilename>/etc/passwd</SourceFilename></VRTDataset>', "a VRT file"),
    (b"<GDAL_WMS><Service name='WMS'><ServerUrl>http://127.0.0.1:1/</ServerUrl></Service></GDAL_WMS>", "a WMS file"),
    (b"", "neither"),
]


def test_parts_that_a_file_does_not_list_are_void(tmp_path: Path) -> None:
    path = tmp_path / "heights.tif"
    path.write_bytes(tiff_of(zlib.compress(np.full(100, 300, dtype="<f4").tobytes()), width=100, height=100, rows_per_strip=1))
    with opened_tiff(path) as tiff:
        window = tiff.window(0, 0, 100, 100)
    assert (window.kinds[0] == PostKind.HEIGHT).all()
    assert (window.kinds[1:] == PostKind.DECLARED_VOID).all()
    assert np.isnan(window.heights_m[1:]).all()


def test_a_hand_made_tiff_is_otherwise_as_it_should_be(tmp_path: Path) -> None:
    """What the hostile ones are refused for is what is hostile in them."""
    path = tmp_path / "heights.tif"
    path.write_bytes(
        tiff_of(zlib.compress(np.full(10_000, 300, dtype="<f4").tobytes()), width=100, height=200, rows_per_strip=100, strips=2)
    )
    with opened_terrain(path) as file:
        assert (file.rasters[0].window(0, 0, 200, 100).heights_m == 300.0).all()


@pytest.mark.parametrize(("content", "words"), HOSTILE)
def test_a_hostile_file_is_refused_with_little_memory(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "heights.tif"
    path.write_bytes(content)
    tracemalloc.start()
    try:
        with pytest.raises(TerrainFileError, match=words), opened_terrain(path) as file:
            file.rasters[0].window(0, 0, 64, 64)
        assert tracemalloc.get_traced_memory()[1] < 64 * MIB
    finally:
        tracemalloc.stop()
    assert [found.name for found in tmp_path.iterdir()] == ["heights.tif"]


@pytest.mark.long
@pytest.mark.parametrize("packing", [{}, {"tiled": "yes", "blockxsize": 64, "blockysize": 64, "predictor": 3}])
def test_damage_anywhere_in_deflated_heights_is_refused(tmp_path: Path, packing: dict[str, str]) -> None:
    """GDAL does not look at their checksums: it reads 39 of 40 such files, with other heights."""
    heights = hills("f4", (150, 150))
    path = write_geotiff(tmp_path / "whole.tif", heights, compress="deflate", **packing)
    whole = path.read_bytes()
    for at in range(len(whole) // 10, len(whole) * 9 // 10, len(whole) // 10):
        path.write_bytes(whole[:at] + bytes(32) + whole[at + 32 :])
        with pytest.raises(TerrainFileError, match="damaged or cut off"), opened_tiff(path) as tiff:
            tiff.window(0, 0, 150, 150)


@settings(max_examples=25)
@given(st.data())
def test_a_file_with_any_bytes_changed_is_read_or_refused_and_nothing_else(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    packing = data.draw(
        st.sampled_from([{"compress": "lzw", "predictor": 2}, {"compress": "deflate", "tiled": "yes"}, {"compress": "packbits"}])
    )
    folder = tmp_path_factory.mktemp("mangled")
    whole = bytearray(write_geotiff(folder / "whole.tif", hills("i2", (40, 50)), srid=9707, **packing).read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    path = folder / "mangled.tif"
    path.write_bytes(whole[: data.draw(st.integers(4, len(whole)))])
    try:
        with opened_terrain(path) as file:
            raster = file.rasters[0]
            raster.window(0, 0, min(raster.height, 40), min(raster.width, 50))
    except TerrainFileError:
        return
