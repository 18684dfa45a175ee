"""Every format comes out as the same rows: plain values and a checked geometry in WGS84."""

import json
from pathlib import Path
from typing import Any

import pytest
import shapefile
import shapely

from inspection.importers.assets.asset_file import Row, RowFaults, opened_asset_file
from inspection.importers.rows import AssetFileError
from tests.inspection.importers.assets.made_files import (
    TOWERS,
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

LV95_TOWERS = [("T1", 45.5, (2600000.0, 1200000.0)), ("T2", 38.0, (2600300.0, 1200000.0))]


def rows_of(path: Path, **options: Any) -> list[Row]:
    faults = RowFaults()
    with opened_asset_file(path, **options) as file:
        rows = list(file.rows(faults))
    faults.refuse_if_any()
    return rows


def refs_and_positions(rows: list[Row]) -> list[tuple[Any, tuple[float, float]]]:
    return [(row.properties["ref"], row.geometry.coords[0]) for row in rows]


def first_fault(path: Path, **options: Any) -> str:
    with pytest.raises(AssetFileError) as refusal:
        rows_of(path, **options)
    return str(refusal.value.faults[0])


WANTED = [(ref, position) for ref, _, position in TOWERS]


def test_geojson_rows(tmp_path: Path) -> None:
    rows = rows_of(geojson(tmp_path / "a.geojson", *[({"ref": ref}, point(*position)) for ref, position in WANTED]))
    assert refs_and_positions(rows) == WANTED


def test_a_single_geojson_feature_and_a_bare_geometry_are_read(tmp_path: Path) -> None:
    path = tmp_path / "a.geojson"
    path.write_text(json.dumps({"type": "Feature", "id": 7, "properties": None, "geometry": point(8, 47)}))
    assert rows_of(path)[0].properties == {"id": 7}
    path.write_text(json.dumps(line((8, 47), (8.1, 47))))
    assert rows_of(path)[0].geometry.length == pytest.approx(0.1)


def test_the_system_that_older_geojson_names_is_used(tmp_path: Path) -> None:
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::2056"}}
    rows = rows_of(geojson(tmp_path / "a.geojson", ({}, point(2600000, 1200000)), crs=crs))
    assert rows[0].geometry.coords[0] == pytest.approx((7.438632, 46.951083), abs=2e-6)  # swisstopo: 7°26'19.08", 46°57'03.9"


def test_kml_and_kmz_rows_with_their_data_and_folders(tmp_path: Path) -> None:
    body = "<Folder><name>North</name>" + "".join(
        placemark("x", f"<Point><coordinates>{lon},{lat},410</coordinates></Point>", ref=ref) for ref, (lon, lat) in WANTED
    )  # fmt: skip
    path = kml(tmp_path / "a.kml", body + "</Folder>")
    rows = rows_of(path)
    assert refs_and_positions(rows) == WANTED
    assert rows[0].properties == {"name": "x", "ref": "T1", "folder": "North"}
    assert refs_and_positions(rows_of(zipped(tmp_path / "a.kmz", {"doc.kml": path.read_bytes(), "icon.png": b"png"}))) == WANTED


def test_a_kml_polygon_keeps_its_hole_and_a_multigeometry_of_lines_is_one_row(tmp_path: Path) -> None:
    def ring(*positions: tuple[float, float]) -> str:
        return f"<LinearRing><coordinates>{' '.join(f'{lon},{lat}' for lon, lat in positions)}</coordinates></LinearRing>"

    polygon = (
        f"<Polygon><outerBoundaryIs>{ring((8, 47), (9, 47), (9, 48), (8, 48), (8, 47))}</outerBoundaryIs>"
        f"<innerBoundaryIs>{ring((8.4, 47.4), (8.6, 47.4), (8.6, 47.6), (8.4, 47.4))}</innerBoundaryIs></Polygon>"
    )
    lines = (
        "<MultiGeometry><LineString><coordinates>8,47 8.1,47</coordinates></LineString>"
        "<LineString><coordinates>8.1,47 8.2,47.1</coordinates></LineString></MultiGeometry>"
    )
    rows = rows_of(kml(tmp_path / "a.kml", placemark("area", polygon) + placemark("line", lines)))
    assert rows[0].geometry.area == pytest.approx(1 - 0.02)
    assert rows[1].geometry.geom_type == "LineString"
    assert len(rows[1].geometry.coords) == 3


@pytest.mark.parametrize("folder", ["", "data/"])
def test_shapefile_rows_in_wgs84_by_its_prj(tmp_path: Path, folder: str) -> None:
    members = shapefile_members(tmp_path, LV95_TOWERS, crs="EPSG:2056")
    rows = rows_of(zipped(tmp_path / "a.zip", {folder + name: content for name, content in members.items()}))
    assert [row.properties for row in rows] == [{"ref": "T1", "hoehe": 45.5}, {"ref": "T2", "hoehe": 38.0}]
    assert rows[0].geometry.coords[0] == pytest.approx((7.438632, 46.951083), abs=2e-6)


@pytest.mark.parametrize(("encoding", "cpg"), [("utf-8", None), ("cp1252", None), ("cp1252", b"1252"), ("cp1252", b"ANSI 1252")])
def test_a_shapefiles_umlauts_are_read_with_and_without_its_cpg(tmp_path: Path, encoding: str, cpg: bytes | None) -> None:
    members = shapefile_members(tmp_path, [("Höhe Süd", 1.0, (8, 47))], encoding=encoding)
    if cpg is not None:
        members["towers.cpg"] = cpg
    assert rows_of(zipped(tmp_path / "a.zip", members))[0].properties["ref"] == "Höhe Süd"


def test_a_shapefile_without_prj_is_refused_with_what_to_do_or_read_in_the_system_that_the_user_names(tmp_path: Path) -> None:
    path = zipped(tmp_path / "a.zip", shapefile_members(tmp_path, LV95_TOWERS, crs=None))
    assert "towers.shp: the .prj file is missing" in first_fault(path)
    assert rows_of(path, crs="EPSG:2056")[0].geometry.x == pytest.approx(7.438632, abs=2e-6)


def test_a_shapefiles_polygon_keeps_its_hole(tmp_path: Path) -> None:
    with shapefile.Writer(str(tmp_path / "b"), shapeType=shapefile.POLYGON) as writer:
        writer.field("name", "C", 20)
        writer.poly([[[8, 47], [8, 48], [9, 48], [9, 47], [8, 47]], [[8.4, 47.4], [8.6, 47.4], [8.6, 47.6], [8.4, 47.4]]])
        writer.record("B")
    members = {f"b.{ending}": (tmp_path / f"b.{ending}").read_bytes() for ending in ("shp", "dbf")}
    assert rows_of(zipped(tmp_path / "a.zip", members), crs="EPSG:4326")[0].geometry.area == pytest.approx(0.98)


def test_geopackage_rows(tmp_path: Path) -> None:
    rows = rows_of(geopackage(tmp_path / "a.gpkg"))
    assert refs_and_positions(rows) == WANTED
    assert rows[0].properties == {"fid": 1, "ref": "T1"}


def test_a_geopackage_in_another_system_is_brought_to_wgs84(tmp_path: Path) -> None:
    blobs = [(ref, gpkg_blob(shapely.to_wkb(shapely.Point(position)), 2056)) for ref, _, position in LV95_TOWERS]
    path = geopackage(tmp_path / "a.gpkg", blobs, system=2056)
    assert rows_of(path)[0].geometry.coords[0] == pytest.approx((7.438632, 46.951083), abs=2e-6)
    with opened_asset_file(path) as file:
        assert file.crs_name == "CH1903+ / LV95 (EPSG:2056)"


def test_a_geopackage_without_system_is_refused_or_read_in_the_one_that_the_user_names(tmp_path: Path) -> None:
    path = geopackage(tmp_path / "a.gpkg", system=-1)
    assert "does not say in which reference system" in first_fault(path)
    assert refs_and_positions(rows_of(path, crs="EPSG:4326")) == WANTED


@pytest.mark.parametrize(
    "shape",
    [
        shapely.Point(8, 47),
        shapely.LineString([(8, 47, 400), (8.1, 47, 410)]),
        shapely.Polygon([(8, 47), (9, 47), (9, 48), (8, 47)], [[(8.6, 47.2), (8.8, 47.2), (8.8, 47.4), (8.6, 47.2)]]),
        shapely.MultiLineString([[(8, 47), (8.1, 47)], [(9, 47), (9.1, 47)]]),
        shapely.MultiPolygon([shapely.box(8, 47, 8.1, 47.1), shapely.box(9, 47, 9.1, 47.1)]),
    ],
    ids=lambda shape: shape.geom_type,
)
@pytest.mark.parametrize("flavor", ["iso", "extended"])
@pytest.mark.parametrize("byte_order", [0, 1])
def test_well_known_binary_of_each_kind_and_flavor(tmp_path: Path, shape: Any, flavor: str, byte_order: int) -> None:
    wkb = shapely.to_wkb(shape, flavor=flavor, byte_order=byte_order)
    read = rows_of(geopackage(tmp_path / "a.gpkg", [("A", gpkg_blob(wkb))]))[0].geometry
    assert read.equals(shapely.force_2d(shape))


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ("ref,lon,lat\nT1,7.4386,46.9511\nT2,7.4426,46.9511\n", "utf-8"),
        ("ref;lon;lat\r\nT1;7,4386;46,9511\r\nT2;7,4426;46,9511\r\n", "utf-8-sig"),
        ("ref\tLongitude\tLatitude\nT1\t7.4386\t46.9511\n\nT2\t7.4426\t46.9511", "utf-16"),
        ('ref|wkt\nT1|POINT(7.4386 46.9511)\nT2|"POINT Z (7.4426 46.9511 400)"\n', "ascii"),
        ("Länge;Breite;ref;Höhe\n7.4386;46.9511;T1;ü\n7.4426;46.9511;T2;ö\n", "cp1252"),
    ],
)
def test_csv_rows_whatever_their_delimiter_encoding_and_decimal_sign(tmp_path: Path, text: str, encoding: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(text.encode(encoding))
    assert refs_and_positions(rows_of(path)) == WANTED


def test_csv_in_metres_is_refused_until_its_system_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("ref;x;y\nT1;2'600'000.0;1'200'000.0\n")
    assert "line 2: 2600000, 1200000 are no degrees: name the reference system" in first_fault(path)
    assert rows_of(path, crs="EPSG:2056")[0].geometry.x == pytest.approx(7.438632, abs=2e-6)


def test_csv_columns_for_the_geometry_can_be_named(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("a,b,c\n1,47,8\n")
    assert rows_of(path)[0].geometry is None
    assert rows_of(path, geometry_columns={"lon": "c", "lat": "b"})[0].geometry.coords[0] == (8, 47)
    assert "no column 'd'" in first_fault(path, geometry_columns={"lon": "d", "lat": "b"})


def test_positions_far_from_where_a_system_is_used_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("ref;x;y\nT1;1200000;2600000\n")
    assert "nowhere near where CH1903+ / LV95 is used" in first_fault(path, crs="EPSG:2056")


def test_lines_in_parts_that_meet_are_joined_and_others_stay_parts(tmp_path: Path) -> None:
    meeting = {"type": "MultiLineString", "coordinates": [[[8.1, 47], [8.2, 47]], [[8.0, 47], [8.1, 47]]]}
    apart = {"type": "MultiLineString", "coordinates": [[[8.0, 47], [8.1, 47]], [[8.5, 47], [8.6, 47]]]}
    rows = rows_of(geojson(tmp_path / "a.geojson", ({}, meeting), ({}, apart)))
    assert [row.geometry.geom_type for row in rows] == ["LineString", "MultiLineString"]


def test_rows_can_be_read_twice(tmp_path: Path) -> None:
    paths = [
        geojson(tmp_path / "a.geojson", ({"ref": "T1"}, point(8, 47))),
        kml(tmp_path / "a.kml", placemark("x", "<Point><coordinates>8,47</coordinates></Point>")),
        zipped(tmp_path / "a.zip", shapefile_members(tmp_path)),
        geopackage(tmp_path / "a.gpkg"),
    ]
    for path in paths:
        with opened_asset_file(path) as file:
            assert list(file.rows(RowFaults())) == list(file.rows(RowFaults())) != []


def test_faulty_rows_are_all_told_or_left_out_if_somebody_says_so(tmp_path: Path) -> None:
    path = geojson(tmp_path / "a.geojson", ({}, point(500, 95)), ({}, point(8, 47)), ({}, line((8, 47), (8, 47))))
    with pytest.raises(AssetFileError) as refusal:
        rows_of(path)
    assert [fault.place for fault in refusal.value.faults] == ["features[0].geometry.coordinates", "features[2].geometry.coordinates"]
    faults = RowFaults(leave_out=True)
    with opened_asset_file(path) as file:
        assert len(list(file.rows(faults))) == 1
    assert faults.number == 2
