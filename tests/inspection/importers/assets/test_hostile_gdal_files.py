"""Hostile files of the formats that GDAL reads, and files that lead elsewhere: refused like every other, with their place."""

import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

from inspection.importers.assets.asset_file import RowFaults, opened_asset_file
from inspection.importers.rows import AssetFileError
from tests.inspection.importers.assets.gdal_files import dxf, gml, gml_member, gml_point, towers, translated
from tests.inspection.importers.assets.made_files import zipped
from tests.inspection.importers.assets.test_hostile_files import LAUGHS, XXE, first_fault, text_file
from tests.runaway import no_runaway

NOWHERE = "http://127.0.0.1:1/"


def changed(make: Callable[[Path], Path], change: Callable[[bytes], bytes]) -> Callable[[Path], Path]:
    def made(folder: Path) -> Path:
        path = make(folder)
        path.write_bytes(change(path.read_bytes()))
        return path

    return made


def flatgeobuf(folder: Path) -> Path:
    return translated(folder / "a.fgb", "FlatGeobuf", towers())


def gml_file(members: str, head: str = "") -> Callable[[Path], Path]:
    return lambda folder: gml(folder / "a.gml", members, head)


def bomb(folder: Path) -> Path:
    return zipped(folder / "a.gdb.zip", {"a.gdb/a00000001.gdbtable": b"\0" * 200_000_000})


def two_geodatabases(folder: Path) -> Path:
    return zipped(folder / "a.zip", {"a.gdb/a00000001.gdbtable": b"x", "b.gdb/a00000001.gdbtable": b"x"})


def hollow_geodatabase(folder: Path) -> Path:
    return zipped(folder / "a.zip", {f"a.gdb/a0000000{number}.gdbtable": bytes(range(256)) for number in range(1, 8)})


def many_tables(folder: Path) -> Path:
    return zipped(folder / "a.zip", {f"a.gdb/a{number:08x}.gdbtable": b"x" for number in range(1, 500)})


SURFACE = (
    '<gml:Polygon srsName="EPSG:4326"><gml:exterior><gml:LinearRing><gml:posList>{}</gml:posList></gml:LinearRing></gml:exterior>'
    "</gml:Polygon>"
)
VECTOR_VRT = "<OGRVRTDataSource><OGRVRTLayer><SrcDataSource>/etc/passwd</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>"
RASTER_VRT = "<VRTDataset><VRTRasterBand><SourceFilename>/etc/passwd</SourceFilename></VRTRasterBand></VRTDataset>"
NESTED = gml_member("<gml:MultiGeometry><gml:geometryMember>" * 20_000)
ENDLESS = gml_member(gml_point(), "").replace("</f:ref>", "a" * 20_000_000 + "</f:ref>")


def dxf_array(folder: Path) -> Path:
    """A block that stands in 30,000 columns and rows."""
    return dxf(folder / "a.dxf", "0 INSERT 2 MAST 10 8 20 47 70 30000 71 30000 44 1 45 1", "0 BLOCK 2 MAST 10 0 20 0 0 ENDBLK")


def dxf_point(folder: Path) -> Path:
    return dxf(folder / "a.dxf", "0 POINT 8 A 10 8 20 47")


HOSTILE: dict[str, tuple[Callable[[Path], Path], str]] = {
    "vrt": (text_file(VECTOR_VRT, "vrt"), "a VRT file"),
    "raster vrt": (text_file(RASTER_VRT, "gml"), "a VRT file"),
    "description of a wfs": (text_file(f"<OGRWFSDataSource><URL>{NOWHERE}</URL></OGRWFSDataSource>", "xml"), "a WFS file"),
    "capabilities of a wfs": (text_file('<wfs:WFS_Capabilities xmlns:wfs="http://www.opengis.net/wfs"/>', "xml"), "a WFS file"),
    "description of a wms": (text_file(f"<GDAL_WMS><Service><ServerUrl>{NOWHERE}</ServerUrl></Service></GDAL_WMS>", "xml"), "a WMS file"),
    "address of a wfs": (text_file(f"WFS:{NOWHERE}", "gml"), "line 1: the first line names no columns"),
    "gml with an external entity": (gml_file(gml_member("&x;"), XXE), "line 1: the GML declares a document type or entities"),
    "gml of a billion laughs": (gml_file(gml_member("&j;"), LAUGHS), "line 1: the GML declares a document type or entities"),
    "gml cut off": (changed(gml_file(gml_member(gml_point()) * 100), lambda data: data[:5_000]), "this is no GML: unclosed token"),
    "gml nested 20,000 deep": (gml_file(NESTED), "line 1: elements are nested more than 64 deep"),
    "gml of an endless text": (gml_file(ENDLESS), "line 1: a text is longer"),
    "gml of an endless attribute": (gml_file(gml_member(gml_point(), "a" * 20_000_000)), "line 1: a tag or comment does not end"),
    "gml with NaN": (gml_file(gml_member(gml_point("nan 47"))), "line 1: 'nan' is no number"),
    "gml with a word for a number": (gml_file("\n\n" + gml_member(gml_point("8 47,x"))), "line 3: 'x' is no number"),
    "gml bowtie": (gml_file(gml_member(SURFACE.format("8 47 9 48 9 47 8 48 8 47"))), "tower, row 1: self-intersection at 8.5, 47.5"),
    "gml swapped": (gml_file(gml_member(gml_point("47 118"))), "longitude comes first: are the two swapped?"),
    "gml in no known system": (gml_file(gml_member(gml_point(system="EPSG:99999999"))), "crs not found"),
    "flatgeobuf cut off": (changed(flatgeobuf, lambda data: data[:-30]), "GDAL does not read it"),
    "flatgeobuf of noise": (changed(flatgeobuf, lambda data: data[:8] + bytes(range(256)) * 40), "GDAL does not read it"),
    "flatgeobuf with a huge header": (changed(flatgeobuf, lambda data: data[:8] + b"\xff" * 3 + b"\x7f" + data[12:]), "GDAL does not read"),
    "dxf of an endless array of blocks": (dxf_array, "does not say in which reference system"),
    "dxf without a system": (dxf_point, "does not say in which reference system"),
    "dxf cut off": (changed(dxf_point, lambda data: data[:60]), "GDAL does not read it"),
    "geodatabase bomb": (bomb, "a.gdb/a00000001.gdbtable: the archive unpacks to more than 100 times its size"),
    "several geodatabases": (two_geodatabases, "the archive holds several geodatabases"),
    "geodatabase of noise": (hollow_geodatabase, "GDAL does not read it"),
    "geodatabase of 500 tables": (many_tables, "the geodatabase has"),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_it_is_refused_with_its_place_and_the_program_is_unharmed(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make, words = HOSTILE[name]
    folder, scratch = tmp_path / "uploads", tmp_path / "scratch"
    folder.mkdir()
    scratch.mkdir()
    path = make(folder)
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    left = sorted(folder.iterdir())
    open_files = len(list(Path("/proc/self/fd").iterdir()))
    with no_runaway():
        fault = first_fault(path)
    assert words in fault
    assert (sorted(folder.iterdir()), list(scratch.iterdir())) == (left, [])
    assert len(list(Path("/proc/self/fd").iterdir())) <= open_files


@pytest.mark.long
def test_a_block_in_endless_columns_and_rows_is_refused_when_it_is_read(tmp_path: Path) -> None:
    path = dxf_array(tmp_path)
    ended = "takes longer than 1 s|has more than 200000 rows"
    with pytest.raises(AssetFileError, match=ended), opened_asset_file(path, crs="EPSG:4326") as file:
        for _ in file.rows(RowFaults(leave_out=True)):
            pass
