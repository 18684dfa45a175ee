"""Files of flown tracks: columns with units, elements in the order of their schemas, and nothing that grows with the flight."""

import csv
import json
import random
import tracemalloc
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from io import StringIO
from itertools import pairwise
from xml.etree import ElementTree

import pytest

from telemetry.exports.csv_file import COLUMNS, csv_of_records
from telemetry.exports.geojson_file import geojson_of_records
from telemetry.exports.gpx_file import NAMESPACE, OWN_NAMESPACE, gpx_pieces
from telemetry.exports.kml_file import GX_NAMESPACE, POINTS_A_PART, kml_pieces
from telemetry.exports.kml_file import NAMESPACE as KML_NAMESPACE
from telemetry.exports.logged_record import FLAGS, PLACES, REPORTED, LoggedRecord, Value
from telemetry.exports.thinning import for_files, rounded

START = datetime(2026, 11, 22, 12, tzinfo=UTC)
Pieces = Callable[[Iterable[LoggedRecord]], Iterator[str]]
KINDS: dict[str, Pieces] = {
    "csv": csv_of_records,
    "geojson": geojson_of_records,
    "gpx": lambda records: gpx_pieces(records, name="Bexley & co"),
    "kml": lambda records: kml_pieces(records, name="Bexley & co"),
}

# Children in the order of the schemas' sequences: gpx.xsd of GPX 1.1, ogckml22.xsd and kml22gx.xsd of KML 2.2.
GPX_ORDER = {
    "gpx": ["metadata", "wpt", "rte", "trk", "extensions"],
    "metadata": ["name", "desc", "author", "copyright", "link", "time", "keywords", "bounds", "extensions"],
    "trk": ["name", "cmt", "desc", "src", "link", "number", "type", "extensions", "trkseg"],
    "trkseg": ["trkpt", "extensions"],
    "trkpt": [
        "ele", "time", "magvar", "geoidheight", "name", "cmt", "desc", "src", "link", "sym", "type", "fix", "sat", "hdop", "vdop", "pdop",
        "ageofdgpsdata", "dgpsid", "extensions",
    ],
}  # fmt: skip
KML_ORDER = {
    "kml": ["NetworkLinkControl", "Document"],
    "Document": ["name", "visibility", "open", "description", "Style", "Schema", "Placemark"],
    "Schema": ["SimpleField", "SimpleArrayField"],
    "Placemark": ["name", "visibility", "open", "description", "TimeSpan", "styleUrl", "ExtendedData", "MultiTrack"],
    "MultiTrack": ["altitudeMode", "interpolate", "Track"],
    "Track": ["altitudeMode", "when", "coord", "angles", "Model", "ExtendedData"],
    "ExtendedData": ["SchemaData"],
    "SchemaData": ["SimpleData", "SimpleArrayData"],
    "SimpleArrayData": ["value"],
}


def logged(number: int = 0, *, position: tuple[float, float] | None = (10.0, 56.0), stream: str = "boot", **values: Value) -> LoggedRecord:
    """One a second."""
    measured_at = START + timedelta(seconds=number)
    reported: list[Value] = [None] * len(PLACES)
    for name, value in ({"is_from_future": False, "is_late": False, "mode": ""} | values).items():
        reported[PLACES[name]] = value
    received_at, stored_at = measured_at + timedelta(seconds=1), measured_at + timedelta(seconds=2)
    return LoggedRecord(number, 1, "Kite", None, stream, number, measured_at, received_at, stored_at, position, tuple(reported))


def text(kind: str, *records: LoggedRecord) -> str:
    return "".join(KINDS[kind](records))


def xml(kind: str, *records: LoggedRecord) -> ElementTree.Element:
    return ElementTree.fromstring(text(kind, *records))  # noqa: S314 - just written


def local(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2]


def faults_of_order(root: ElementTree.Element, order: dict[str, list[str]]) -> list[str]:
    """Elements whose children are unknown to the schema, or stand before one that must come first."""
    found = []
    for element in root.iter():
        if local(element) not in order:
            continue
        wanted = order[local(element)]
        children = [local(child) for child in element]
        if unknown := set(children) - set(wanted):
            found.append(f"{local(element)} has {unknown}")
        elif children != sorted(children, key=wanted.index):
            found.append(f"{local(element)} has {children}")
    return found


FULL = {
    "altitude_amsl_m": 120.5, "altitude_relative_m": 20.5, "gps_fix": 3, "satellites": 14, "hdop": 0.8, "battery_percent": 71.0,
    "is_armed": True, "mode": "Mission", "heading_deg": 90.0,
}  # fmt: skip


def test_columns_name_their_units_and_the_three_times() -> None:
    rows = list(csv.DictReader(StringIO(text("csv", logged(3, **FULL)))))
    assert list(rows[0]) == list(COLUMNS)
    first = rows[0]
    assert (first["measured_at"], first["received_at"], first["stored_at"]) == (
        "2026-11-22T12:00:03.000Z", "2026-11-22T12:00:04.000Z", "2026-11-22T12:00:05.000Z",
    )  # fmt: skip
    assert (first["longitude_deg"], first["latitude_deg"], first["altitude_amsl_m"], first["altitude_agl_m"]) == (
        "10.0",
        "56.0",
        "120.5",
        "",
    )
    assert (first["is_armed"], first["mode"], first["is_from_future"]) == ("true", "Mission", "false")
    assert set(REPORTED) | set(FLAGS) <= set(first)


@pytest.mark.parametrize("mode", ["=1+1", "+1", "-1", "@SUM(A1)", "\tx"])
def test_what_a_uav_says_is_no_formula_in_a_spreadsheet(mode: str) -> None:
    (row,) = csv.DictReader(StringIO(text("csv", logged(mode=mode, heading_deg=-0.5))))
    assert row["mode"] == f"'{mode}"
    assert row["heading_deg"] == "-0.5"


@pytest.mark.parametrize(
    ("mode", "shown"),
    [
        (" =1+1", "' =1+1"),
        ("\u00a0=1", "'\u00a0=1"),
        ("\uff1d1+1", "'\uff1d1+1"),
        ("\uff20SUM", "'\uff20SUM"),
        ("Hold;=1+1", "Hold;'=1+1"),
        ("Hold; +1", "Hold;' +1"),
        ("Hold; then 1+1", "Hold; then 1+1"),
        ("a=b", "a=b"),
    ],
)
def test_a_formula_behind_blanks_semicolons_or_in_full_width_is_none_either(mode: str, shown: str) -> None:
    (row,) = csv.DictReader(StringIO(text("csv", logged(mode=mode))))
    assert row["mode"] == shown


def test_geojson_has_every_record_also_those_without_a_place() -> None:
    read = json.loads(text("geojson", logged(0, **FULL), logged(1, position=None)))
    assert read["type"] == "FeatureCollection"
    assert [feature["geometry"] for feature in read["features"]] == [{"type": "Point", "coordinates": [10.0, 56.0]}, None]
    assert read["features"][0]["properties"]["altitude_relative_m"] == 20.5


def test_gpx_stands_in_the_order_of_its_schema() -> None:
    root = xml("gpx", logged(0, **FULL), logged(1), logged(2, stream="other", **FULL), replace(logged(3), uav=2, uav_name="Tern <2>"))
    assert faults_of_order(root, GPX_ORDER) == []
    assert (root.tag, root.get("version")) == (f"{{{NAMESPACE}}}gpx", "1.1")
    tracks = root.findall(f"{{{NAMESPACE}}}trk")
    assert [track[0].text for track in tracks] == ["Kite", "Tern <2>"]
    assert [len(track.findall(f"{{{NAMESPACE}}}trkseg")) for track in tracks] == [2, 1]
    point = next(root.iter(f"{{{NAMESPACE}}}trkpt"))
    assert (point.get("lat"), point.get("lon")) == ("56.0000000", "10.0000000")
    assert [(local(child), child.text) for child in point][:5] == [
        ("ele", "120.50"), ("time", "2026-11-22T12:00:00.000Z"), ("fix", "3d"), ("sat", "14"), ("hdop", "0.80"),
    ]  # fmt: skip
    own = {local(child): child.text for child in point.find(f"{{{NAMESPACE}}}extensions") or []}
    assert own["received_at"] == "2026-11-22T12:00:01.000Z"
    assert (own["stored_at"], own["altitude_relative_m"], own["is_armed"]) == ("2026-11-22T12:00:02.000Z", "20.5", "true")
    assert OWN_NAMESPACE in text("gpx", logged(0))


def test_kml_stands_in_the_order_of_its_schemas_with_as_many_times_as_places() -> None:
    records = [logged(number, **FULL) for number in range(POINTS_A_PART + 50)] + [logged(900), replace(logged(901), uav=2, uav_name="Tern")]
    root = xml("kml", *records)
    assert faults_of_order(root, KML_ORDER) == []
    tracks = list(root.iter(f"{{{GX_NAMESPACE}}}Track"))
    assert [len(track.findall(f"{{{KML_NAMESPACE}}}when")) for track in tracks] == [POINTS_A_PART, 50, 1, 1]
    for track in tracks:
        times = len(track.findall(f"{{{KML_NAMESPACE}}}when"))
        assert len(track.findall(f"{{{GX_NAMESPACE}}}coord")) == times
        assert {len(array) for array in track.iter(f"{{{GX_NAMESPACE}}}SimpleArrayData")} == {times}
    assert [track[0].text for track in tracks] == ["absolute", "absolute", "clampToGround", "clampToGround"]
    assert next(root.iter(f"{{{GX_NAMESPACE}}}coord")).text == "10.0000000 56.0000000 120.50"


def test_a_height_above_ground_is_said_to_be_one() -> None:
    (track,) = xml("kml", logged(altitude_agl_m=40.0)).iter(f"{{{GX_NAMESPACE}}}Track")
    assert (track[0].text, track.findtext(f"{{{GX_NAMESPACE}}}coord")) == ("relativeToGround", "10.0000000 56.0000000 40.00")


@pytest.mark.parametrize("kind", ["gpx", "kml"])
def test_a_track_leaves_out_what_has_no_place_and_what_is_from_the_future(kind: str) -> None:
    written = text(kind, logged(0), logged(1, position=None), logged(2, is_from_future=True), logged(3, is_late=True))
    assert [written.count(f"12:00:0{second}.000Z<") > 0 for second in (0, 3)] == [True, True]
    name = "time" if kind == "gpx" else "when"
    assert written.count(f"<{name}>") == 2


@pytest.mark.parametrize("kind", KINDS)
def test_a_flight_without_records_is_a_file_that_can_be_read(kind: str) -> None:
    written = text(kind)
    if kind == "csv":
        assert written.splitlines() == [",".join(COLUMNS)]
    elif kind == "geojson":
        assert json.loads(written) == {"type": "FeatureCollection", "features": []}
    else:
        ElementTree.fromstring(written)  # noqa: S314


@pytest.mark.parametrize("kind", ["gpx", "kml"])
def test_names_that_xml_cannot_hold_do_no_harm(kind: str) -> None:
    root = xml(kind, replace(logged(), uav_name="Kite \x01 <&> \ud800"))
    assert "Kite  <&> " in {element.text for element in root.iter()}


@pytest.mark.parametrize("number", [199, 200, 201, 400, 500, 501])
def test_geojson_and_csv_lose_nothing_where_pieces_meet(number: int) -> None:
    records = [logged(place) for place in range(number)]
    assert len(json.loads(text("geojson", *records))["features"]) == number
    assert len(text("csv", *records).splitlines()) == number + 1
    assert len(list(xml("gpx", *records).iter(f"{{{NAMESPACE}}}trkpt"))) == number


@pytest.mark.long
@pytest.mark.parametrize("number", [10_000, pytest.param(100_000, marks=pytest.mark.long)])
@pytest.mark.parametrize("kind", KINDS)
def test_many_records_take_no_more_memory_than_a_few(kind: str, number: int) -> None:
    reported = logged(0, **FULL)

    def peak_bytes(count: int) -> int:
        tracemalloc.start()
        written = sum(len(piece) for piece in KINDS[kind](replace(reported, sequence=place) for place in range(count)))
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert written > count * 100
        return peak

    few = peak_bytes(2_000)
    assert peak_bytes(number) < few * 1.2 + 50_000


# --- what is left out --------------------------------------------------------------------------------------------------------------


def at(second: float, **values: Value) -> LoggedRecord:
    return replace(logged(**values), measured_at=START + timedelta(seconds=second))


def seconds_of(records: Iterable[LoggedRecord]) -> list[float]:
    return [round((record.measured_at - START).total_seconds(), 2) for record in records]


@pytest.mark.parametrize("kind", [*KINDS])
def test_no_file_has_digits_below_the_resolution_of_a_sensor(kind: str) -> None:
    noisy = {name: 2.4046354241136214e-08 for name in REPORTED if name.endswith(("_mps", "_deg", "_m", "_v", "_a", "_percent"))}
    record = replace(logged(**noisy, hdop=0.8000000119), position=(10.123456789012, -56.987654321098))
    written = text(kind, *for_files([record]))
    assert "e-" not in written.replace("urn:spanwise:telemetry", "")
    assert "0.8000" not in written
    assert "10.1234568" in written
    assert "-56.9876543" in written
    assert "-0.0" not in text(kind, *for_files([at(0, velocity_north_mps=-1e-9, altitude_amsl_m=1.0)]))


def test_values_keep_what_their_sensor_can_tell() -> None:
    reported = rounded(
        logged(altitude_amsl_m=123.456, velocity_down_mps=-1.234, heading_deg=359.96, battery_v=22.246, mode="AUTO", satellites=11)
    )
    wanted = {
        "altitude_amsl_m": 123.46,
        "velocity_down_mps": -1.23,
        "heading_deg": 0.0,
        "battery_v": 22.25,
        "mode": "AUTO",
        "satellites": 11,
    }
    assert {name: reported.value(name) for name in wanted} == wanted


def test_one_record_a_second_is_left_of_ten() -> None:
    ten_a_second = [at(number / 10) for number in range(601)]
    kept = seconds_of(for_files(ten_a_second))
    assert 60 <= len(kept) <= 62
    assert all(0.7 <= after - before <= 1.3 for before, after in pairwise(kept))
    assert len(list(for_files(ten_a_second, every_s=0.0))) == 601
    assert len(list(for_files(ten_a_second, every_s=10.0))) == 7


def test_reports_of_one_a_second_are_all_kept_though_they_do_not_come_on_the_second() -> None:
    draw = random.Random(4)
    assert len(list(for_files([at(number + draw.uniform(-0.12, 0.12)) for number in range(300)]))) == 300


def test_a_record_with_which_something_begins_is_never_left_out() -> None:
    records = [at(number / 10, mode="AUTO" if number < 14 else "RTL", is_in_air=number < 27) for number in range(40)]
    kept = seconds_of(for_files(records))
    assert {1.4, 2.7} <= set(kept)


def test_streams_and_uavs_are_thinned_each_for_itself_and_gaps_do_not_matter() -> None:
    at_once = [at(number / 10) for number in range(20)]
    mixed = [one for record in at_once for one in (record, replace(record, uav=2), replace(record, stream="next"))]
    assert len(list(for_files(mixed))) == 3 * len(list(for_files(at_once)))
    assert seconds_of(for_files([at(0), at(0.5), at(100.3), at(100.9), at(101.3), at(5.0)])) == [0.0, 100.3, 101.3, 5.0]
