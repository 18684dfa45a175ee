"""Row S5 of the target table for asset files: each refused within 2 s, with its place, without filling memory or disk."""

import io
import json
import struct
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
import shapely

from inspection.importers.assets.asset_file import RowFaults, opened_asset_file
from inspection.importers.rows import AssetFileError
from tests.inspection.importers.assets.made_files import (
    geojson,
    geopackage,
    gpkg_blob,
    kml,
    line,
    placemark,
    point,
    shapefile_members,
    zipped,
)
from tests.runaway import no_runaway

MAX_MEMORY_KIB = 64 * 1024


def text_file(text: str | bytes, ending: str = "geojson") -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        path = folder / f"hostile.{ending}"
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    return make


def collection(feature: str) -> Callable[[Path], Path]:
    return text_file('{"type": "FeatureCollection", "features": [' + feature + "]}")


def feature(geometry: str, properties: str = "{}") -> str:
    return f'{{"type": "Feature", "properties": {properties}, "geometry": {geometry}}}'


def many_vertices(folder: Path) -> Path:
    positions = [(8 + index * 1e-6, 47 + index % 2 * 1e-6) for index in range(100_000)]
    return geojson(folder / "a.geojson", ({}, point(8, 47)), ({}, line(*positions)))


def many_vertices_in_kml(folder: Path) -> Path:
    positions = " ".join(f"{8 + index * 1e-6:.6f},47" for index in range(100_000))
    return kml(folder / "a.kml", placemark("long", f"<LineString><coordinates>{positions}</coordinates></LineString>"))


def many_vertices_in_geopackage(folder: Path) -> Path:
    shape = shapely.LineString([(8 + index * 1e-6, 47) for index in range(100_000)])
    return geopackage(folder / "a.gpkg", [("long", gpkg_blob(shapely.to_wkb(shape)))])


def kml_file(body: str, head: str = "") -> Callable[[Path], Path]:
    return lambda folder: kml(folder / "a.kml", body, head)


LAUGHS = '<!DOCTYPE kml [<!ENTITY a "ha">' + "".join(
    f'<!ENTITY {chr(98 + level)} "{f"&{chr(97 + level)};" * 10}">' for level in range(9)
) + "]>"  # fmt: skip
XXE = '<!DOCTYPE kml [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
REMOTE = '<!DOCTYPE kml SYSTEM "http://127.0.0.1:1/evil.dtd">'


def zip_bomb(folder: Path) -> Path:
    return zipped(folder / "a.zip", shapefile_members(folder) | {"towers.shp": b"\0" * 200_000_000})


def kmz_bomb(folder: Path) -> Path:
    return zipped(folder / "a.kmz", {"doc.kml": b"<kml>" + b" " * 200_000_000})


def zip_with(name: str, content: bytes = b"x", **attributes: int) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        path = folder / "a.zip"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for member, data in shapefile_members(folder).items():
                archive.writestr(member, data)
            entry = zipfile.ZipInfo(name)
            for attribute, value in attributes.items():
                setattr(entry, attribute, value)
            archive.writestr(entry, content)
        return path

    return make


def zip_in_zip(folder: Path) -> Path:
    inner = zipped(folder / "inner.zip", shapefile_members(folder))
    content = inner.read_bytes()
    inner.unlink()
    return zipped(folder / "a.zip", {"inner.zip": content})


def million_entries(folder: Path) -> Path:
    """Written by hand: a directory of 10^6 entries, all of one empty file."""
    path = folder / "a.zip"
    local = struct.pack("<4s5H3L2H", b"PK\x03\x04", 20, 0, 0, 0, 0, 0, 0, 0, 1, 0) + b"a"
    entry = struct.pack("<4s6H3L5H2L", b"PK\x01\x02", 20, 20, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0) + b"a"
    directory = entry * 1_000_000
    end64 = struct.pack("<4sQ2H2L4Q", b"PK\x06\x06", 44, 45, 45, 0, 0, 10**6, 10**6, len(directory), len(local))
    locator = struct.pack("<4sLQL", b"PK\x06\x07", 0, len(local) + len(directory), 1)
    end = struct.pack("<4s4H2LH", b"PK\x05\x06", 0, 0, 0xFFFF, 0xFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0)
    path.write_bytes(local + directory + end64 + locator + end)
    return path


def encrypted(folder: Path) -> Path:
    path = zipped(folder / "a.zip", shapefile_members(folder))
    data = bytearray(path.read_bytes())
    for mark, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        at = data.find(mark)
        while at >= 0:
            data[at + offset] |= 1
            at = data.find(mark, at + 4)
    path.write_bytes(data)
    return path


def cut_off(folder: Path) -> Path:
    path = zipped(folder / "a.zip", shapefile_members(folder))
    path.write_bytes(path.read_bytes()[:-40])
    return path


def broken_checksum(folder: Path) -> Path:
    path = zipped(folder / "a.zip", shapefile_members(folder))
    data = bytearray(path.read_bytes())
    data[60] ^= 0xFF
    path.write_bytes(data)
    return path


def shp_with(change: Callable[[bytearray], None], member: str = "towers.shp") -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        members = shapefile_members(folder)
        data = bytearray(members[member])
        change(data)
        return zipped(folder / "a.zip", members | {member: bytes(data)})

    return make


def set_at(offset: int, form: str, *values: int) -> Callable[[bytearray], None]:
    return lambda data: struct.pack_into(form, data, offset, *values)


def polygon_record(parts: int, points: int) -> Callable[[bytearray], None]:
    """One record of a polygon whose counts are not true."""

    def change(data: bytearray) -> None:
        body = struct.pack("<i4d2i", 5, 8, 47, 9, 48, parts, points) + struct.pack("<i", 0) + struct.pack("<8d", *[8.0, 47.0] * 4)
        data[100:] = struct.pack(">2i", 1, len(body) // 2) + body

    return change


def overlapping_parts(data: bytearray) -> None:
    body = struct.pack("<i4d2i", 3, 8, 47, 9, 48, 500, 4) + struct.pack("<500i", *[0] * 500) + struct.pack("<8d", *[8.0, 47.0] * 4)
    data[100:] = (struct.pack(">2i", 1, len(body) // 2) + body) * 2  # the table has two rows
    struct.pack_into(">i", data, 24, len(data) // 2)


def gpkg_with(*statements: str) -> Callable[[Path], Path]:
    return lambda folder: geopackage(folder / "a.gpkg", statements=statements)


def gpkg_geometry(blob: bytes) -> Callable[[Path], Path]:
    return lambda folder: geopackage(folder / "a.gpkg", [("bad", blob)])


def gpkg_of_noise(folder: Path) -> Path:
    path = geopackage(folder / "a.gpkg")
    data = bytearray(path.read_bytes())
    for at in range(4096, len(data), 7):
        data[at] = at % 251
    path.write_bytes(data)
    return path


ENDLESS_VIEW = (
    "DELETE FROM gpkg_contents", "DROP TABLE towers",
    "CREATE VIEW towers AS WITH RECURSIVE n(fid) AS (SELECT 1 UNION ALL SELECT fid + 1 FROM n) SELECT fid, NULL AS geom, 'x' AS ref FROM n",
    "INSERT INTO gpkg_contents VALUES ('towers', 'features', 'towers', 4326)",
)  # fmt: skip
VIEW_FOR_THE_CONTENTS = (
    "DROP TABLE gpkg_contents",
    "CREATE VIEW gpkg_contents AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
    "SELECT 'towers' AS table_name, 'features' AS data_type, i AS identifier, 4326 AS srs_id FROM n",
)
NESTED_WKB = struct.pack("<BII", 1, 7, 1) * 20_000
COUNT_THAT_IS_NOT_THERE = struct.pack("<BII", 1, 2, 2**31 - 1) + b"\0" * 64
POINTS_IN_LINES = struct.pack("<BII", 1, 5, 1) * 20_000


def a_long_line(folder: Path) -> Path:
    path = folder / "a.csv"
    with path.open("wb") as file:
        file.write(b"ref,lon,lat\n")
        for _ in range(256):
            file.write(b"a" * 2**20)
    return path


# name: how to make it, and what the first fault says
HOSTILE: dict[str, tuple[Callable[[Path], Path], str]] = {
    "empty file": (text_file(" \n"), "the file is empty"),
    "geojson nested 20,000 deep": (
        collection(feature('{"type": "Polygon", "coordinates": ' + "[" * 20_000 + "]" * 20_000 + "}")),
        "features[0]: ",
    ),
    "geojson of properties nested 20,000 deep": (collection(feature("null", '{"a":' * 20_000 + "1" + "}" * 20_000)), "features[0]: "),
    "geojson nested 20,000 deep without features": (text_file('{"a":' * 20_000 + "1" + "}" * 20_000), "nested more than 64 deep"),
    "geojson with NaN": (collection(feature('{"type": "Point", "coordinates": [NaN, 47]}')), "features[0]: NaN is no number"),
    "geojson with a number beyond all": (collection(feature('{"type": "Point", "coordinates": [1e999, 47]}')), "features[0].geometry"),
    "geojson with a null character": (collection(feature("null", '{"a": "b\\u0000c"}')), "features[0].properties: a text has a null"),
    "geojson with half a character": (collection(feature("null", '{"a": "\\ud800"}')), "features[0].properties: a text has half"),
    "geojson of one endless feature": (
        collection(feature("null", '{"a": "' + "a" * 41_000_000)),
        "features[0]: the feature is damaged or longer",
    ),
    "geojson of 41 MB before its features": (text_file('{"a": "' + "a" * 41_000_000), "features"),
    "geojson of empty lists": (collection("{" + '"a":[' + "[]," * 10_000_000), "features[0]: "),
    "geojson cut off": (collection(feature('{"type": "Point", "coordinates": [8, 47]}') + "," + '{"type": "Fea'), "features[1]: "),
    "geojson with 300 columns": (
        collection(feature("null", json.dumps({f"c{n}": n for n in range(300)}))),
        "features[0]: the file has more than 200",
    ),
    "geojson in a system that is none": (
        text_file('{"crs": {"type": "name", "properties": {"name": "EPSG:99999999"}}, "features": []}'),
        "crs",
    ),
    "100,000 vertices": (many_vertices, "features[1].geometry.coordinates: there are 100000 vertices"),
    "100,000 vertices in kml": (many_vertices_in_kml, "placemark 1 (line 1): a text is longer"),
    "100,000 vertices in a geopackage": (many_vertices_in_geopackage, "towers, row 1: there are 100000 vertices"),
    "bowtie": (
        collection(feature('{"type": "Polygon", "coordinates": [[[8,47],[9,48],[9,47],[8,48],[8,47]]]}')),
        "self-intersection at 8.5, 47.5",
    ),
    "swapped axes": (collection(feature('{"type": "Point", "coordinates": [47, 118]}')), "longitude comes first: are the two swapped?"),
    "kml with an external entity": (kml_file(placemark("&x;", ""), XXE), "line 1: the KML declares a document type"),
    "kml with a remote document type": (kml_file("", REMOTE), "line 1: the KML declares a document type"),
    "kml of a billion laughs": (kml_file(placemark("&j;", ""), LAUGHS), "line 1: the KML declares a document type"),
    "kml nested 20,000 deep": (kml_file("<Folder>" * 20_000 + "</Folder>" * 20_000), "nested more than 64 deep"),
    "kml of an endless tag": (text_file("<kml " + "a" * 40_000_000, "kml"), "a tag or comment does not end"),
    "kml of an endless attribute": (text_file("<kml a='" + ">" * 40_000_000, "kml"), "a tag or comment does not end"),
    "kml of an endless comment": (text_file("<kml><!--" + "a " * 20_000_000, "kml"), "a tag or comment does not end"),
    "kml of an endless text": (kml_file(placemark("a" * 20_000_000, "")), "placemark 1 (line 1): a text is longer"),
    "kml of endless data": (
        kml_file(placemark("x", "", **{f"d{n}": "a" * 100_000 for n in range(30)})),
        "placemark 1 (line 1): a text is longer",
    ),
    "kml in no known encoding": (text_file('<?xml version="1.0" encoding="x-evil"?><kml/>', "kml"), "line 1: "),
    "kml with NaN": (kml_file(placemark("x", "<Point><coordinates>nan,47</coordinates></Point>")), "placemark 1 (line 1)"),
    "xml that is no kml": (text_file("<gpx><wpt/></gpx>", "kml"), "line 1: this XML is no KML"),
    "zip bomb 1000:1": (zip_bomb, "towers.shp: the archive unpacks to more than 100 times its size"),
    "kmz bomb": (kmz_bomb, "doc.kml: the archive unpacks to more than 100 times its size"),
    "zip in zip": (zip_in_zip, "inner.zip: there is an archive in the archive"),
    "zip slip": (zip_with("../../etc/cron.d/evil"), "../../etc/cron.d/evil: an entry's path leads out"),
    "zip slip, as Windows writes it": (zip_with("..\\..\\evil.shp"), "an entry's path leads out"),
    "zip with an absolute path": (zip_with("/etc/evil"), "/etc/evil: an entry's path leads out"),
    "zip with a symbolic link": (
        zip_with("link.prj", b"/etc/passwd", external_attr=0o120777 << 16, create_system=3),
        "link.prj: an entry is a symbolic",
    ),
    "zip packed with lzma": (zip_with("readme.txt", compress_type=zipfile.ZIP_LZMA), "readme.txt: an entry is packed with another method"),
    "zip of 10^6 entries": (million_entries, "the archive has far more than 1000 entries"),
    "zip with a password": (encrypted, "towers.shp: the archive is encrypted"),
    "zip cut off": (cut_off, "the archive is damaged or cut off"),
    "zip with a broken checksum": (broken_checksum, "towers.shp: it cannot be unpacked"),
    "zip without anything to read": (lambda folder: zipped(folder / "a.zip", {"readme.txt": b"x"}), "neither a shapefile nor a KML"),
    "shapefile record that leads back": (
        shp_with(set_at(104, ">i", -4)),
        "towers.shp, record 1: the record goes past the end of the file, or back",
    ),
    "shapefile record that leads out": (shp_with(set_at(104, ">i", 2**30)), "towers.shp, record 1: the record goes past"),
    "shapefile with 2^31 points": (shp_with(polygon_record(1, 2**31 - 1)), "towers.shp, record 1: the record holds fewer vertices"),
    "shapefile with negative counts": (shp_with(polygon_record(-5, -5)), "towers.shp, record 1: the record holds fewer vertices"),
    "shapefile with overlapping parts": (shp_with(overlapping_parts), "record 1: the parts of the geometry overlap"),
    "shapefile of an unknown type": (shp_with(set_at(108, "<i", 99)), "towers.shp, record 1: shapes of type 99"),
    "shapefile with NaN": (shp_with(set_at(112, "<Q", 0x7FF8000000000000)), "record 1: nan is not finite"),
    "table of 2^32 rows": (shp_with(set_at(4, "<L", 2**32 - 1), "towers.dbf"), "towers.dbf: the table has more than"),
    "table that is cut off": (shp_with(set_at(4, "<L", 1000), "towers.dbf"), "towers.dbf: the table is damaged or cut off"),
    "table with rows of no length": (shp_with(set_at(10, "<H", 0), "towers.dbf"), "towers.dbf: the table is damaged or cut off"),
    "table with fields of unknown type": (shp_with(set_at(43, "<B", 1), "towers.dbf"), "towers.shp: the head of the file is damaged"),
    "geopackage whose layer is an endless view": (gpkg_with(*ENDLESS_VIEW), "towers: this is a view or a virtual table"),
    "geopackage whose contents are an endless view": (
        gpkg_with(*VIEW_FOR_THE_CONTENTS),
        "gpkg_contents: this is a view or a virtual table",
    ),
    "geopackage with a layer that is not there": (gpkg_with("DROP TABLE towers"), "towers: the GeoPackage has no such table"),
    "geopackage with a virtual table": (
        gpkg_with("DROP TABLE towers", "CREATE VIRTUAL TABLE towers USING fts5(geom, ref)"),
        "towers: this is a view or a virtual table",
    ),
    "geopackage with a name that is SQL": (
        gpkg_with("UPDATE gpkg_geometry_columns SET column_name = 'geom\"; DROP TABLE towers; --'"),
        "has no column",
    ),
    "geopackage of noise": (gpkg_of_noise, "the GeoPackage is damaged"),
    "geopackage cut off": (
        lambda folder: text_file(geopackage(folder / "x.gpkg").read_bytes()[:5000], "gpkg")(folder),
        "the GeoPackage is damaged",
    ),
    "geometry that is none": (gpkg_geometry(b"\0" * 50), "towers, row 1: the geometry is none as GeoPackage has it"),
    "wkb cut off": (gpkg_geometry(gpkg_blob(shapely.to_wkb(shapely.Point(8, 47))[:-3])), "towers, row 1: the geometry (WKB) is damaged"),
    "wkb that goes on": (
        gpkg_geometry(gpkg_blob(shapely.to_wkb(shapely.Point(8, 47)) + b"x")),
        "towers, row 1: the geometry (WKB) goes on",
    ),
    "wkb of 2^31 points": (gpkg_geometry(gpkg_blob(COUNT_THAT_IS_NOT_THERE)), "towers, row 1: the geometry (WKB) is damaged"),
    "wkb nested 20,000 deep": (gpkg_geometry(gpkg_blob(NESTED_WKB)), "towers, row 1: the geometry is neither points"),
    "wkb of lines in lines": (gpkg_geometry(gpkg_blob(POINTS_IN_LINES)), "towers, row 1: the geometry is neither points"),
    "wkb of NaN": (gpkg_geometry(gpkg_blob(shapely.to_wkb(shapely.Point(float("nan"), 47)))), "towers, row 1: nan is not finite"),
    "csv with a null character": (text_file(b"ref,lon,lat\nT1,8,47\nT\x002,8,47\n", "csv"), "line 3: there is a null character"),
    "csv of a line without end": (a_long_line, "line 2: the line has more than"),
    "csv of a quote without end": (text_file('ref,lon,lat\n"' + "a\n" * 5_000_000, "csv"), "line 2: the row cannot be read"),
    "csv with NaN": (text_file("ref,lon,lat\nT1,nan,47\n", "csv"), "line 2, lon: 'nan' is no number"),
    "csv with infinity": (text_file("ref,lon,lat\nT1,8,inf\n", "csv"), "line 2, lat: 'inf' is no number"),
    "csv beyond the earth": (text_file("ref,lon,lat\nT1,500,95\n", "csv"), "line 2: latitude 95"),
    "csv with cells beyond its columns": (text_file("ref,lon,lat\nT1,8,47,9,9\n", "csv"), "line 2: the row has 5 cells"),
    "csv with 100,000 columns": (text_file(",".join(["a"] * 100_000) + "\n", "csv"), "line 1: the file has more than 200 columns"),
    "csv without a head": (text_file("1,8,47\n2,8,47\n", "csv"), "line 1: the first line has numbers"),
    "csv of wkt nested 20,000 deep": (
        text_file("ref,wkt\nA,POINT(8 47)\nB," + "GEOMETRYCOLLECTION(" * 20_000 + "\n", "csv"),
        "line 3, wkt: ",
    ),
    "csv of wkt with a million brackets": (text_file("ref,wkt\nA,POINT(8 47)\nB,POINT" + "(" * 1_000_000 + "\n", "csv"), "line 3, wkt: "),
    "noise": (text_file(bytes(range(256)) * 4_000, "bin"), "line "),
}


def memory_kib(name: str) -> int:
    found = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith(name))
    return int(found.split()[1])


def first_fault(path: Path) -> str:
    faults = RowFaults()
    try:
        with opened_asset_file(path) as file:
            for _ in file.rows(faults):
                pass
        faults.refuse_if_any()
    except AssetFileError as error:
        return str(error.faults[0])
    return "not refused"


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_with_its_place_and_bounded_memory(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make, words = HOSTILE[name]
    folder = tmp_path / "uploads"
    scratch = tmp_path / "scratch"
    folder.mkdir()
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    path = make(folder)
    left = sorted(folder.iterdir())
    open_files = len(list(Path("/proc/self/fd").iterdir()))
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # the peak counts from here
    before_kib = memory_kib("VmRSS")
    with no_runaway():
        fault = first_fault(path)
    grown_kib = memory_kib("VmHWM") - before_kib
    assert words in fault
    assert grown_kib < MAX_MEMORY_KIB
    assert (sorted(folder.iterdir()), list(scratch.iterdir())) == (left, [])
    assert len(list(Path("/proc/self/fd").iterdir())) <= open_files  # others may have closed theirs


def test_triggers_and_views_beside_an_honest_layer_do_not_run(tmp_path: Path) -> None:
    path = geopackage(
        tmp_path / "a.gpkg",
        statements=[
            "CREATE VIEW other AS SELECT load_extension('evil') AS x",
            "CREATE TRIGGER evil AFTER UPDATE ON towers BEGIN DELETE FROM towers; END",
        ],
    )
    before = path.read_bytes()
    with opened_asset_file(path) as file:
        assert len(list(file.rows(RowFaults()))) == 2
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_generated_columns_are_not_worked_out(tmp_path: Path) -> None:
    path = geopackage(tmp_path / "a.gpkg", statements=["ALTER TABLE towers ADD COLUMN large AS (hex(zeroblob(100000000)))"])
    with opened_asset_file(path) as file:
        assert set(next(file.rows(RowFaults())).properties) == {"fid", "ref"}


def test_an_honest_archive_with_a_readme_and_folders_passes(tmp_path: Path) -> None:
    members = shapefile_members(tmp_path) | {"doc/": b"", "doc/readme.txt": b"x", "towers.qix": b"x", "__MACOSX/._towers.shp": b"x"}
    with opened_asset_file(zipped(tmp_path / "a.zip", members)) as file:
        assert len(list(file.rows(RowFaults()))) == 2


def test_what_is_unpacked_has_no_name_on_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    with opened_asset_file(zipped(tmp_path / "a.zip", shapefile_members(tmp_path))) as file:
        assert len(list(file.rows(RowFaults()))) == 2
        assert list(scratch.iterdir()) == []


def test_files_cut_anywhere_are_refused_or_read_in_part(tmp_path: Path) -> None:
    """Never another error than the one that tells people."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, content in shapefile_members(tmp_path).items():
            archive.writestr(name, content)
    wholes = [buffer.getvalue(), geopackage(tmp_path / "a.gpkg").read_bytes(), kml(tmp_path / "a.kml", placemark("x", "")).read_bytes()]
    path = tmp_path / "cut"
    for whole in wholes:
        for length in range(1, len(whole), max(1, len(whole) // 60)):
            path.write_bytes(whole[:length])
            assert first_fault(path) != "not refused", (whole[:20], length)


def test_files_with_flipped_bytes_raise_nothing_that_is_not_told(tmp_path: Path) -> None:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, content in shapefile_members(tmp_path).items():
            archive.writestr(name, content)
    path = tmp_path / "flipped"
    for whole in (buffer.getvalue(), geopackage(tmp_path / "a.gpkg").read_bytes()):
        for at in range(0, len(whole), max(1, len(whole) // 200)):
            data = bytearray(whole)
            data[at] ^= 0x55
            path.write_bytes(data)
            try:
                with opened_asset_file(path) as file:
                    list(file.rows(RowFaults()))
            except AssetFileError:
                pass
