"""What columns mean: guessed from their names and content, checked as people state it, and applied row by row."""

from pathlib import Path
from typing import Any

import pytest

from inspection.importers.assets.asset_file import RowFaults, opened_asset_file
from inspection.importers.assets.delimited import number_of
from inspection.importers.assets.mapping import AssetRecord, Tally, checked_mapping, records_of
from inspection.importers.assets.survey import AssetFileSurvey, suggested_mapping, survey_of
from inspection.importers.rows import AssetFileError
from tests.inspection.importers.assets.made_files import geojson, line, point

AREA = {"type": "Polygon", "coordinates": [[[8, 47], [8.1, 47], [8.1, 47.1], [8, 47]]]}


def survey(path: Path) -> AssetFileSurvey:
    with opened_asset_file(path) as file:
        return survey_of(file.rows(RowFaults()), file.source.columns)


def records(path: Path, tally: Tally | None = None, **parameters: Any) -> list[AssetRecord]:
    faults = RowFaults()
    with opened_asset_file(path) as file:
        columns = survey_of(file.rows(RowFaults()), file.source.columns).columns
        found = list(records_of(file.rows(faults), checked_mapping(parameters, columns), faults, tally or Tally()))
    faults.refuse_if_any()
    return found


def one(folder: Path, properties: dict[str, Any], geometry: dict[str, Any] | None = None, **parameters: Any) -> AssetRecord:
    return records(geojson(folder / "a.geojson", (properties, geometry or point(8, 47))), **{"kind": "by_geometry"} | parameters)[0]


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("8.54", 8.54), ("8,54", 8.54), ("-8", -8), ("2'600'000.5", 2600000.5), ("1 200 000", 1200000), ("1.200.000,5", 1200000.5),
        ("1,200,000.5", 1200000.5), ("1e3", 1000), ("nan", None), ("inf", None), ("", None), ("8°32'", None), ("1,2,3", None), ("١", None),
    ],
)  # fmt: skip
def test_numbers_as_people_write_them(text: str, number: float | None) -> None:
    assert number_of(text) == number


def test_columns_are_told_with_type_and_samples(tmp_path: Path) -> None:
    rows = [({"n": index, "w": "1,5", "d": "2024-05-01", "b": True, "e": "", "t": f"x{index % 2}"}, point(8, 47)) for index in range(9)]
    found = survey(geojson(tmp_path / "a.geojson", *rows, ({}, None)))
    assert {name: column.type for name, column in found.columns.items()} == {
        "n": "whole number", "w": "number", "d": "date", "b": "yes or no", "e": "empty", "t": "text",
    }  # fmt: skip
    assert found.columns["n"].samples == [0, 1, 2, 3, 4]
    assert found.columns["t"].values == {"x0": 5, "x1": 4}
    assert (found.rows, found.without_geometry, dict(found.geometries)) == (10, 1, {"points": 9})
    assert len(found.preview) == 9


def test_the_preview_is_bounded(tmp_path: Path) -> None:
    found = survey(geojson(tmp_path / "a.geojson", *[({}, point(8, 47)) for _ in range(700)]))
    assert (found.rows, len(found.preview)) == (700, 500)
    long = line(*[(8 + index * 1e-5, 47) for index in range(9_000)])
    assert len(survey(geojson(tmp_path / "b.geojson", *[({}, long) for _ in range(20)])).preview) == 3


def test_a_mapping_is_guessed_from_names_in_several_languages(tmp_path: Path) -> None:
    rows = [
        ({"OBJECTID": n, "Mast-Nr": f"M{n}", "Höhe": 30 + n, "Spannung_kV": "110", "Eigentümer": "Werk"}, point(8, 47)) for n in range(3)
    ]
    assert suggested_mapping(survey(geojson(tmp_path / "a.geojson", *rows))) == {
        "kind": "tower",
        "columns": {"key": "OBJECTID", "ref": "Mast-Nr", "operator": "Eigentümer", "voltage": "Spannung_kV", "height": "Höhe"},
        "units": {"voltage": "kV", "height": "m"},
    }


def test_units_are_guessed_from_names_and_sizes(tmp_path: Path) -> None:
    volts = survey(geojson(tmp_path / "a.geojson", ({"voltage": 110000, "height_ft": 90}, line((8, 47), (8.1, 47)))))
    assert suggested_mapping(volts)["units"] == {"voltage": "V", "height": "ft"}
    assert suggested_mapping(survey(geojson(tmp_path / "a.geojson", ({"voltage": "345"}, point(8, 47)))))["units"] == {"voltage": "kV"}


def test_a_column_with_a_value_twice_is_no_key(tmp_path: Path) -> None:
    found = survey(geojson(tmp_path / "a.geojson", ({"id": "A"}, point(8, 47)), ({"id": "A"}, point(9, 47))))
    assert "key" not in suggested_mapping(found)["columns"]


@pytest.mark.parametrize(
    ("geometry", "name", "kind"),
    [
        (point(8, 47), "poles", "tower"), (line((8, 47), (8.1, 47)), "netz", "line"), (line((8, 47), (8.1, 47)), "Bahnstrecken", "railway"),
        (AREA, "x", "bridge"),
    ],
)  # fmt: skip
def test_the_kind_is_guessed_from_the_geometry_and_the_files_name(tmp_path: Path, geometry: dict[str, Any], name: str, kind: str) -> None:
    assert suggested_mapping(survey(geojson(tmp_path / "a.geojson", ({}, geometry))), file_name=name)["kind"] == kind


def test_a_column_that_tells_the_kinds_is_found(tmp_path: Path) -> None:
    rows = [({"Typ": "Mast"}, point(8, 47)), ({"Typ": "Freileitung"}, line((8, 47), (8.1, 47))), ({"Typ": "Kabine"}, point(8, 47))]
    assert suggested_mapping(survey(geojson(tmp_path / "a.geojson", *rows)))["kind"] == {
        "column": "Typ", "values": {"Mast": "tower", "Freileitung": "line"},
    }  # fmt: skip


@pytest.mark.parametrize(
    ("value", "unit", "volts"),
    [
        ("110", "kV", (110_000,)), (110.0, "kV", (110_000,)), ("110/20", "kV", (110_000, 20_000)), ("110 kV", "V", (110_000,)),
        ("380000;220000", "V", (380_000, 220_000)), ("1150", "kV", (1_150_000,)), ("about 110", "kV", ()), (None, "kV", ()),
    ],
)  # fmt: skip
def test_voltages_come_out_in_volts(tmp_path: Path, value: Any, unit: str, volts: tuple[int, ...]) -> None:
    record = one(tmp_path, {"u": value}, line((8, 47), (8.1, 47)), columns={"voltage": "u"}, units={"voltage": unit})
    assert record.voltages_v == volts


@pytest.mark.parametrize(
    ("value", "unit", "metres"),
    [
        (45.5, "m", 45.5),
        ("45,5", "m", 45.5),
        (100, "ft", 30.48),
        ("100 ft", "m", 30.48),
        ("tall", "m", None),
        (-3, "m", None),
        (5_000, "m", None),
    ],
)
def test_heights_come_out_in_metres(tmp_path: Path, value: Any, unit: str, metres: float | None) -> None:
    record = one(tmp_path, {"h": value}, columns={"height": "h"}, units={"height": unit})
    assert record.height_m == (None if metres is None else pytest.approx(metres))


def test_values_that_are_none_are_counted(tmp_path: Path) -> None:
    tally = Tally()
    path = geojson(tmp_path / "a.geojson", ({"u": "?", "h": "?", "c": "?"}, point(8, 47)))
    records(path, tally, kind="tower", columns={"voltage": "u", "height": "h", "circuits": "c"})
    assert dict(tally.unread) == {"voltage": 1, "height": 1, "circuits": 1}


def test_the_whole_row_is_kept_as_tags(tmp_path: Path) -> None:
    record = one(tmp_path, {"id": 7, "ok": True, "x": 1.0, "none": None, "empty": ""}, columns={"key": "id"})
    assert (record.source_key, record.tags) == ("7", {"id": "7", "ok": "yes", "x": "1"})


def test_a_row_of_the_wrong_geometry_is_a_fault_with_its_place(tmp_path: Path) -> None:
    path = geojson(tmp_path / "a.geojson", ({}, point(8, 47)), ({}, AREA))
    with pytest.raises(AssetFileError, match=r"features\[1\]: a tower is drawn as a point, not as an area"):
        records(path, kind="tower")


def test_a_key_that_stands_twice_is_a_fault_with_both_places(tmp_path: Path) -> None:
    path = geojson(tmp_path / "a.geojson", ({"k": "A"}, point(8, 47)), ({"k": "A"}, point(9, 47)))
    with pytest.raises(AssetFileError, match=r"features\[1\]: the key 'A' stands at features\[0\] already"):
        records(path, kind="tower", columns={"key": "k"})


def test_an_empty_key_is_a_fault(tmp_path: Path) -> None:
    with pytest.raises(AssetFileError, match="which tells the assets apart, is empty"):
        one(tmp_path, {"k": ""}, columns={"key": "k"})


def test_without_a_key_column_the_geometry_tells_assets_apart(tmp_path: Path) -> None:
    path = geojson(tmp_path / "a.geojson", ({}, point(8, 47)), ({}, point(8, 47)), ({}, point(8.0000001, 47)))
    again = geojson(tmp_path / "b.geojson", ({"name": "moved up"}, point(8.0000001, 47)), ({}, point(8, 47)))
    keys, others = ([record.source_key for record in records(file, kind="tower")] for file in (path, again))
    assert len(set(keys)) == 3
    assert set(others) < set(keys)


def test_a_line_in_parts_becomes_several_assets_of_one_key(tmp_path: Path) -> None:
    parts = {"type": "MultiLineString", "coordinates": [[[8.0, 47], [8.1, 47]], [[8.5, 47], [8.6, 47]]]}
    found = records(geojson(tmp_path / "a.geojson", ({"k": "L"}, parts)), kind="line", columns={"key": "k"})
    assert [record.source_key for record in found] == ["L", "L/2"]
    assert all(record.length_m == pytest.approx(7_600, rel=0.01) for record in found)


def test_rows_of_a_value_that_nobody_explained_are_told_and_those_not_wanted_are_left_out(tmp_path: Path) -> None:
    path = geojson(tmp_path / "a.geojson", *[({"t": kind}, point(8, 47)) for kind in ("mast", "hut", "hut", "tree")], ({"t": "mast"}, None))
    tally = Tally()
    found = records(path, tally, kind={"column": "t", "values": {"mast": "tower", "tree": ""}})
    assert len(found) == 1
    assert tally.unknown_kinds == {"hut": 2}
    assert tally.left_out == {"of a kind that is not wanted": 1, "no geometry": 1}


def test_cables_and_disused_tracks_are_not_for_flying(tmp_path: Path) -> None:
    path = line((8, 47), (8.1, 47))
    assert one(tmp_path, {"t": "line"}, path, columns={"subtype": "t"}).is_flyable
    assert not one(tmp_path, {"t": "Cable"}, path, columns={"subtype": "t"}).is_flyable
    assert not one(tmp_path, {"t": "disused"}, path, kind="railway", columns={"subtype": "t"}).is_flyable


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"kind": "castle"}, "kind: 'castle' is none of"),
        ({"kind": {"column": "gone", "values": {}}}, "kind.column: the file has no column 'gone'"),
        ({"kind": {"column": "a", "values": {"x": "castle"}}}, "kind.values.x: 'castle' is none of"),
        ({"columns": {"name": "gone"}}, "columns.name: the file has no column 'gone'"),
        ({"columns": {"colour": "a"}}, "columns.colour: there is no such meaning"),
        ({"columns": ["a"]}, "columns: an object is expected"),
        ({"units": {"height": "yards"}}, "units.height: 'yards' is no unit"),
        ({"kind": {"column": ["a"]}}, "kind.column: the file has no column"),
        ({"kind": ["tower"]}, "kind: "),
    ],
)
def test_a_mapping_that_cannot_be_meant_is_refused_with_its_place(parameters: dict[str, Any], words: str) -> None:
    with pytest.raises(AssetFileError) as refusal:
        checked_mapping(parameters, ["a", "b"])
    assert words in str(refusal.value)
