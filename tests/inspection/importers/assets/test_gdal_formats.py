"""GML, FlatGeobuf, DXF and File Geodatabases come out as the same rows as every other format."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from inspection.importers.assets.asset_file import RowFaults, opened_asset_file
from tests.inspection.importers.assets.gdal_files import (
    BERN,
    dxf,
    feature,
    geodatabase,
    gml,
    gml_member,
    gml_point,
    towers,
    translated,
)
from tests.inspection.importers.assets.test_formats import first_fault, rows_of

LATITUDE_FIRST = "urn:ogc:def:crs:EPSG::4326"
MAKERS: dict[str, Callable[[Path], Path]] = {
    "gml": lambda folder: translated(folder / "a.gml", "GML", towers()),
    "flatgeobuf": lambda folder: translated(folder / "a.fgb", "FlatGeobuf", towers()),
    "filegdb": lambda folder: geodatabase(folder / "a.gdb.zip", towers()),
}


@pytest.mark.parametrize("file_format", MAKERS)
def test_rows_have_their_values_and_stand_in_wgs84(tmp_path: Path, file_format: str) -> None:
    path = MAKERS[file_format](tmp_path)
    rows = sorted(rows_of(path), key=lambda row: str(row.properties["ref"]))
    assert [{name: row.properties[name] for name in ("ref", "hoehe", "n")} for row in rows] == [
        {"ref": "T1", "hoehe": 45.5, "n": 1},
        {"ref": "Tü2", "hoehe": 38.0, "n": 2},
    ]
    assert str(rows[0].properties["built"]).startswith("2024-02-03")
    assert rows[0].geometry.coords[0] == pytest.approx(BERN, abs=2e-6)
    with opened_asset_file(path) as file:
        assert (file.source.file_format, file.crs_name, file.source.layer) == (file_format, "CH1903+ / LV95 (EPSG:2056)", "towers")
        assert list(file.rows(RowFaults())) == list(file.rows(RowFaults()))


@pytest.mark.parametrize("file_format", ["flatgeobuf", "filegdb"])
def test_a_layer_that_states_no_system_is_refused_or_read_in_the_one_that_the_user_names(tmp_path: Path, file_format: str) -> None:
    made = {
        "flatgeobuf": lambda: translated(tmp_path / "a.fgb", "FlatGeobuf", towers(), system=""),
        "filegdb": lambda: geodatabase(tmp_path / "a.zip", towers(), system=""),
    }[file_format]()
    assert "does not say in which reference system" in first_fault(made)
    assert rows_of(made, crs="EPSG:2056")[0].geometry.y == pytest.approx(BERN[1], abs=1e-4)


def test_gml_in_latitude_and_longitude_is_turned_as_its_system_says(tmp_path: Path) -> None:
    path = gml(tmp_path / "a.gml", gml_member(gml_point("47 8", LATITUDE_FIRST)))
    assert rows_of(path)[0].geometry.coords[0] == (8, 47)


def test_gml_without_a_system_is_refused(tmp_path: Path) -> None:
    path = gml(tmp_path / "a.gml", gml_member("<gml:Point><gml:pos>8 47</gml:pos></gml:Point>"))
    assert "does not say in which reference system" in first_fault(path)


def test_gml_of_two_systems_names_the_row(tmp_path: Path) -> None:
    path = gml(tmp_path / "a.gml", gml_member(gml_point()) + gml_member(gml_point("2600000 1200000", "EPSG:2056"), "T2"))
    assert "reference system" in first_fault(path)


def test_surfaces_of_polygons_are_areas_and_arcs_are_refused_with_their_row(tmp_path: Path) -> None:
    ring = "<gml:LinearRing><gml:posList>8 47 9 47 9 48 8 48 8 47</gml:posList></gml:LinearRing>"
    surface = (
        '<gml:MultiSurface srsName="http://www.opengis.net/def/crs/OGC/1.3/CRS84"><gml:surfaceMember><gml:Surface><gml:patches>'
        f"<gml:PolygonPatch><gml:exterior>{ring}</gml:exterior></gml:PolygonPatch></gml:patches></gml:Surface></gml:surfaceMember>"
        "</gml:MultiSurface>"
    )
    assert rows_of(gml(tmp_path / "a.gml", gml_member(surface)))[0].geometry.area == pytest.approx(1)
    arc = (
        '<gml:Curve srsName="http://www.opengis.net/def/crs/OGC/1.3/CRS84"><gml:segments><gml:Arc><gml:posList>8 47 8.1 47.1 8.2 47'
        "</gml:posList></gml:Arc></gml:segments></gml:Curve>"
    )
    path = gml(tmp_path / "b.gml", gml_member(arc))
    assert first_fault(path) == "tower, row 1: the geometry is neither points, lines nor polygons (curves and collections are not read)"


def test_dxf_is_read_in_the_system_that_the_user_names(tmp_path: Path) -> None:
    """A line, a full circle, and a block that stands for a tower."""
    path = dxf(
        tmp_path / "a.dxf",
        "0 LINE 8 LINES 10 2600000 20 1200000 11 2600300 21 1200000 0 CIRCLE 8 LINES 10 2600000 20 1200000 40 50 "
        "0 INSERT 8 TOWERS 2 MAST 10 2600000 20 1200000",
        "0 BLOCK 8 0 2 MAST 10 0 20 0 0 LINE 8 0 10 0 20 0 11 1 21 1 0 ENDBLK 8 0",
    )
    assert "does not say in which reference system" in first_fault(path)
    line, circle, mast = rows_of(path, crs="EPSG:2056")
    assert line.geometry.coords[0] == pytest.approx(BERN, abs=2e-6)
    assert circle.geometry.geom_type == "LineString"
    assert circle.geometry.is_ring
    assert (mast.properties["Layer"], mast.properties["BlockName"]) == ("TOWERS", "MAST")
    assert mast.geometry.coords[0] == pytest.approx(BERN, abs=2e-6)


@pytest.mark.parametrize("folder", ["", "grid.gdb/", "data/2025/Grid.GDB/"])
def test_a_geodatabase_is_found_wherever_it_stands_in_the_archive(tmp_path: Path, folder: str) -> None:
    assert len(rows_of(geodatabase(tmp_path / "a.zip", towers(), folder=folder))) == 2


def test_a_layer_is_chosen_by_its_name(tmp_path: Path) -> None:
    path = gml(tmp_path / "a.gml", gml_member(gml_point()) + gml_member(gml_point("9 47"), "L1").replace("f:tower", "f:pole"))
    with opened_asset_file(path, layer="pole") as file:
        assert (file.source.layer, file.source.layers) == ("pole", ("tower", "pole"))
        assert [row.geometry.x for row in file.rows(RowFaults())] == [9]


def test_values_of_each_type_are_kept(tmp_path: Path) -> None:
    values: dict[str, Any] = {"whole": 2**40, "number": 0.5, "text": "ü", "yes": True, "nothing": None}
    path = translated(tmp_path / "a.fgb", "FlatGeobuf", [feature({"type": "Point", "coordinates": (8, 47)}, **values)], system="EPSG:4326")
    assert rows_of(path)[0].properties == values
    lists = dxf(
        tmp_path / "a.dxf", "0 INSERT 8 TOWERS 2 MAST 10 8 20 47", "0 BLOCK 8 0 2 MAST 10 0 20 0 0 POINT 8 0 10 0 20 0 0 ENDBLK 8 0"
    )
    assert rows_of(lists, crs="EPSG:4326")[0].properties["BlockScale"] == "1,1,1"
