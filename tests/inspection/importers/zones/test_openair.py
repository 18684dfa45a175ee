"""OpenAir: records, arcs, heights as pilots write them; all or nothing, each fault with its line."""

import random
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import WGS84
from inspection.importers.zones.openair import (
    MAX_DISTANCE_M,
    NAUTICAL_MILE_M,
    arc,
    arc_between,
    area_of_all_loops,
    circle_ring,
    height_of,
    length_m_of,
    position_of,
)
from inspection.importers.zones.zone_file import ZoneFile, ZoneFileError, read_zones

CENTRE = LonLat(14.5, 50.1)
CZECH_CLASSES = {"R": 85, "GS": 76, "Q": 45, "D": 41, "P": 11, "C": 9, "E": 3}
TRIANGLE = "DP 50:00:00 N 014:00:00 E\nDP 50:10:00 N 014:00:00 E\nDP 50:10:00 N 014:20:00 E\n"


def read(text: str) -> ZoneFile:
    return read_zones(text.encode())


def refusal(text: str) -> str:
    with pytest.raises(ZoneFileError) as refused:
        read(text)
    return str(refused.value)


@pytest.mark.parametrize(
    ("name", "classes", "pens", "circles", "box", "crossing"),
    [
        ("openair.txt", {"Q": 1, "R": 1, "D": 1, "CTR": 1, "C": 1, "P": 1, "GS": 1}, 2, 2, (26.3, 25.4, 26.9, 26.0), "ELP3 SALTBECK"),
        ("czechia-2026-openair.txt", CZECH_CLASSES, 18, 71, (11.0, 47.5, 20.0, 52.0), "LKR1 SUMAVA"),
    ],
)
def test_a_file_is_read_whole(
    name: str, classes: dict[str, int], pens: int, circles: int, box: tuple[float, ...], crossing: str, zone_file: Callable[[str], Path]
) -> None:
    data = zone_file(name).read_bytes()
    found = read_zones(data)
    assert (found.source_format, int(found.notes[0].split()[0])) == ("OpenAir", pens)
    assert len(found.zones) + pens == sum(line.startswith(b"AC ") for line in data.splitlines())
    assert Counter(zone.properties["class"] for zone in found.zones) == classes
    assert all(zone.geometry.is_valid and zone.geometry.area > 0 for zone in found.zones)
    west, south, east, north = shapely.total_bounds([zone.geometry for zone in found.zones])
    assert box[0] < west < east < box[2] and box[1] < south < north < box[3]
    assert sum(zone.circle is not None for zone in found.zones) == circles
    assert crossing in found.notes[1]


@pytest.mark.parametrize(
    ("file", "name", "centre"),
    [
        ("openair.txt", "Tarnfold 119.655", (26.49, 25.76)),
        ("czechia-2026-openair.txt", "Breclav 119.655", (16.8925, 48.790833)),
    ],
)
def test_heights_names_and_facts_are_kept_as_stated(
    file: str, name: str, centre: tuple[float, float], zone_file: Callable[[str], Path]
) -> None:
    found = read_zones(zone_file(file).read_bytes())
    dropzone = next(zone for zone in found.zones if zone.name == f"DROPZONE {name}")
    assert (dropzone.restriction, dropzone.properties["frequency"], dropzone.properties["station"]) == (
        "Danger",
        "119.655",
        f"{name.split()[0]} RADIO",
    )
    band = dropzone.band
    assert (band.lower_limit_m, band.lower_reference, band.upper_limit_m, band.upper_reference) == (
        0.0,
        "AGL",
        pytest.approx(2895.6),
        "STD",
    )
    assert band.as_stated == {"lower": "0 AGL", "upper": "FL 95"}
    assert dropzone.circle == {"centre": [pytest.approx(part) for part in centre], "radius_m": 2 * NAUTICAL_MILE_M}


def test_arcs_of_a_file_bulge_to_their_side(zone_file: Callable[[str], Path]) -> None:
    """A DA counter-clockwise over the west, and a DB clockwise over the east, of 3 and 5 nautical miles."""
    areas = {zone.name: zone.geometry for zone in read_zones(zone_file("openair.txt").read_bytes()).zones}
    for name, centre, side_deg, radius_nm in (
        ("ELD2 Wickenfell Training Area", LonLat(26 + 44 / 60, 25 + 46 / 60), 270.0, 3.0),
        ("CTR Elmsgard", LonLat(26 + 32 / 60, 25.7), 90.0, 5.0),
    ):
        inside, outside = (
            shapely.Point(WGS84.fwd(*centre, side_deg, (radius_nm + more_nm) * NAUTICAL_MILE_M)[:2]) for more_nm in (-0.05, 0.05)
        )
        assert areas[name].contains(inside) and not areas[name].contains(outside), name
    assert not areas["ELD2 Wickenfell Training Area"].contains(shapely.Point(26.75, 25.7667)), "open to the east"


def test_line_ends_a_byte_order_mark_and_latin_letters_change_nothing(zone_file: Callable[[str], Path]) -> None:
    text = zone_file("openair.txt").read_text().replace("Tarnfold", "Tårnfäld")
    plain = read(text)
    windows = read_zones(text.replace("\n", "\r\n").encode("cp1252"))
    assert windows.zones == read_zones(text.encode("utf-8-sig")).zones == plain.zones
    assert windows.notes == ("The text is not UTF-8 and was read as Windows-1252.", *plain.notes)
    assert "DROPZONE Tårnfäld 119.655" in {zone.name for zone in windows.zones}


@pytest.mark.parametrize("radius_m", [50.0, 1_852.0, 18_520.0, 120_000.0])
@pytest.mark.parametrize("is_clockwise", [True, False])
def test_sides_of_an_arc_keep_to_the_exact_curve(radius_m: float, is_clockwise: bool) -> None:
    path = arc(CENTRE, radius_m, 30.0, 250.0, is_clockwise, "line 1")
    assert _farthest_from_circle_m(path, radius_m) <= MAX_DISTANCE_M + 0.02 <= 1.0
    first = WGS84.inv(*CENTRE, *path[0])[0] % 360
    last = WGS84.inv(*CENTRE, *path[-1])[0] % 360
    assert (first, last) == (pytest.approx(30.0, abs=1e-6), pytest.approx(250.0, abs=1e-6))
    middle = WGS84.inv(*CENTRE, *path[len(path) // 2])[0] % 360
    assert (30 < middle < 250) is is_clockwise


def test_a_circle_is_held_whole_and_not_a_metre_more() -> None:
    for radius_m in (200.0, 5_556.0, 92_600.0):
        ring = circle_ring(CENTRE, radius_m, "line 1")
        polygon = shapely.Polygon(ring)
        bearings = np.linspace(0, 360, 4_000, endpoint=False)
        lon, lat, _ = WGS84.fwd(np.full(4_000, CENTRE.lon), np.full(4_000, CENTRE.lat), bearings, np.full(4_000, radius_m - 0.02))
        assert shapely.contains_xy(polygon, lon, lat).all()
        assert _farthest_from_circle_m(ring, radius_m) <= 1.0


def test_an_arc_between_two_positions_ends_in_them() -> None:
    start, end = LonLat(14.6, 50.1), LonLat(14.5, 50.165)
    path = arc_between(CENTRE, start, end, False, "line 1")
    assert (tuple(path[0]), tuple(path[-1])) == (start, end)
    assert len(path) < 200


def _farthest_from_circle_m(path: np.ndarray, radius_m: float) -> float:
    share = np.linspace(0, 1, 9)[None, :, None]
    points = (path[:-1, None] * (1 - share) + path[1:, None] * share).reshape(-1, 2)
    number = len(points)
    _, _, distance = WGS84.inv(np.full(number, CENTRE.lon), np.full(number, CENTRE.lat), points[:, 0], points[:, 1])
    return float(np.abs(np.asarray(distance) - radius_m).max())


@pytest.mark.parametrize(
    ("text", "metres", "reference"),
    [
        ("GND", 0.0, "AGL"), ("SFC", 0.0, "AGL"), ("0 AGL", 0.0, "AGL"), ("1000ft AGL", 304.8, "AGL"), ("2500 MSL", 762.0, "AMSL"),
        ("300m AMSL", 300.0, "AMSL"), ("4000", 1219.2, "AMSL"), ("FL 95", 2895.6, "STD"), ("FL195", 5943.6, "STD"), ("UNL", None, ""),
        ("", None, ""),
    ],
)  # fmt: skip
def test_heights_are_metres_with_a_reference(text: str, metres: float | None, reference: str) -> None:
    assert height_of(text, "line 1") == (None if metres is None else pytest.approx(metres), reference)


def test_positions_in_their_three_ways() -> None:
    assert position_of("48:47:27 N 016:53:33 E", "x") == (pytest.approx(16.8925), pytest.approx(48.790833))
    assert position_of("33:30.5 S 70:40.25W", "x") == (pytest.approx(-70.670833), pytest.approx(-33.508333))
    assert position_of("51.5 N, 0.25 W", "x") == (pytest.approx(-0.25), pytest.approx(51.5))
    assert length_m_of("2.5", "x") == pytest.approx(4_630.0)


def test_a_polygon_is_closed_by_the_format_and_comments_are_no_part_of_it() -> None:
    zones = read(f"* a comment\nAC R *class\nAN Yard *the name\nAH 1000 AGL\nAL GND\n{TRIANGLE}").zones
    assert [(zone.name, zone.restriction, len(zone.geometry.geoms[0].exterior.coords)) for zone in zones] == [("Yard", "Restricted", 4)]


def test_a_slip_that_makes_a_border_cross_itself_is_read_on_the_safe_side() -> None:
    ring = np.array([(0, 0), (4, 0), (4, 4), (2, 4), (2.2, 4.2), (2, 4.2), (2.2, 4), (0, 4), (0, 0)], dtype=float)
    area = shapely.unary_union(area_of_all_loops(ring))
    assert area.contains(shapely.box(0.1, 0.1, 3.9, 3.9))
    assert area.contains(shapely.Point(2.1, 4.15))
    noise = np.random.default_rng(1).random((2_000, 2))
    assert area_of_all_loops(np.vstack([noise, noise[:1]])) is None


@pytest.mark.parametrize(
    ("text", "place"),
    [
        (f"DP 50:00:00 N 014:00:00 E\nAC R\n{TRIANGLE}", "line 1: 'DP' stands before the first AC"),
        ("AC R\nAN a\nDP 50:00:00 N 014:00:00 E\n", "line 1: the airspace 'a' has no area"),
        (f"AC R\nAN a\n{TRIANGLE}DC 2\n", "line 6: a circle cannot be joined with points"),
        ("AC R\nAN a\nDC 2\n", "line 3: there is no centre"),
        ("AC R\nV X=50:00:00 N 014:00:00 E\nDC nan\n", "line 3: 'nan' is no radius"),
        ("AC R\nV X=50:00:00 N 014:00:00 E\nDC 99999\n", "line 3: a radius is a number of metres above 0"),
        ("AC R\nV X=89:59:00 N 014:00:00 E\nDC 20\n", "line 3: the arc comes too near to a pole"),
        ("AC R\nDP 50:61:00 N 014:00:00 E\n", "line 2: minutes and seconds are at most 60"),
        ("AC R\nDP 95:00:00 N 014:00:00 E\n", "line 2: latitude 95.0 is beyond"),
        ("AC R\nAH high\n", "line 2: 'high' is no height"),
        (f"AC R\nAL 5000 MSL\nAH 1000 MSL\n{TRIANGLE}", "line 1: the upper limit 1000 MSL"),
        ("AC R\nDY 5\n", "line 2: the command 'DY' is not known"),
        ("AC R\nV X=50:00:00 N 014:00:00 E\nDB 50:10:00 N 014:00:00 E, 52:00:00 N 014:00:00 E\n", "line 3: the ends of the arc are"),
        ("AC R\nAN " + "x" * 3_000 + "\n", "line 2: the line has 3003 characters"),
    ],
)
def test_a_fault_is_told_with_its_line(text: str, place: str) -> None:
    assert place in refusal(text)


def test_a_random_ring_is_refused_at_once() -> None:
    rng = random.Random(3)
    points = "".join(f"DP {rng.uniform(40, 60):.5f} N {rng.uniform(0, 20):.5f} E\n" for _ in range(2_000))
    assert "self-intersection" in refusal(f"AC R\nAN a\n{points}")


@pytest.mark.parametrize("name", ["openair.txt", "czechia-2026-openair.txt"])
def test_mutated_files_raise_nothing_but_the_named_error(name: str, zone_file: Callable[[str], Path]) -> None:
    lines = zone_file(name).read_text().splitlines()
    rng = random.Random(7)
    for _ in range(400):
        start = rng.randrange(len(lines) - 60)
        part = lines[start : start + 60]
        for _ in range(rng.randrange(1, 6)):
            row = rng.randrange(len(part))
            text = list(part[row] or " ")
            text[rng.randrange(len(text))] = rng.choice("0123456789:NEW.,-=* \x00é")
            part[row] = "".join(text)
        try:
            zones = read_zones("\n".join(["AC R", *part]).encode()).zones
        except ZoneFileError:
            continue
        assert all(zone.geometry.is_valid for zone in zones)


# --- coordinates of 60, and records with faults ------------------------------------------------------------------------------------


def test_seconds_and_minutes_of_60_are_carried_over_with_a_note() -> None:
    found = read("AC R\nAN Carried\n" + TRIANGLE.replace("50:10:00 N 014:20:00", "50:09:60.0 N 013:79:60").replace("013:79", "014:60"))
    assert shapely.get_coordinates(found.zones[0].geometry).max(axis=0).tolist() == pytest.approx([15 + 1 / 60, 50 + 10 / 60])
    assert [str(note) for note in found.notes] == ["Minutes or seconds of 60 were read as the next degree or minute: line 5."]


@pytest.mark.parametrize("text", ["50:60.1 N 014:00 E", "50:00:60.01 N 014:00:00 E", "50:00:61 N 014:00:00 E"])
def test_more_than_60_is_no_position(text: str) -> None:
    assert "minutes and seconds are at most 60" in refusal(f"AC R\nDP {text}\n")


FAULTY = "AC R\nAN Broken\nAL GND\nDP 50:00:00 N 014:00:00 E\nDP 50:99:00 N 014:00:00 E\nDP 50:10:00 N 014:20:00 E\n"


def without_faulty(text: str) -> ZoneFile:
    return read_zones(text.encode(), leave_out_faulty=True)


def test_a_file_with_a_faulty_record_is_read_without_it_where_that_is_asked_for() -> None:
    text = f"AC D\nAN Sound\n{TRIANGLE}{FAULTY}AC R\nAN Other\nV X=50:00:00 N 014:30:00 E\nDC 2\n"
    assert "line 10: minutes and seconds are at most 60" in refusal(text)
    found = without_faulty(text)
    assert [zone.name for zone in found.zones] == ["Sound", "Other"]
    (unread,) = found.unread
    assert (unread.name, unread.identifier, unread.fault.place) == ("Broken", "Broken", "line 10")
    assert unread.bbox == pytest.approx((14.0, 50.0, 14 + 20 / 60, 50 + 10 / 60))


def test_what_is_too_much_for_one_file_is_refused_whatever_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inspection.importers.zones.openair.MAX_POLYGONS", 2)
    with pytest.raises(ZoneFileError, match="more than 2 records"):
        without_faulty(FAULTY + f"AC D\nAN Sound\n{TRIANGLE}" * 4)
    with pytest.raises(ZoneFileError, match="characters"):
        without_faulty(f"AC D\nAN Sound\n{TRIANGLE}AC R\nDP {'9' * 3_000} N\n")


def test_a_file_of_faults_alone_and_one_with_too_many_are_refused() -> None:
    with pytest.raises(ZoneFileError, match="no zones"):
        without_faulty(FAULTY)
    with pytest.raises(ZoneFileError):
        without_faulty(f"AC D\nAN Sound\n{TRIANGLE}" + FAULTY * 60)


def test_a_fault_outside_of_all_records_refuses_the_file() -> None:
    with pytest.raises(ZoneFileError, match="stands before the first AC"):
        without_faulty(f"DP 50:00 N 014:00 E\nAC D\nAN Sound\n{TRIANGLE}")


def test_a_crossing_ring_is_left_out_with_the_box_around_it() -> None:
    rng = random.Random(3)
    points = "".join(f"DP {rng.uniform(40, 41):.5f} N {rng.uniform(9, 10):.5f} E\n" for _ in range(400))
    found = without_faulty(f"AC D\nAN Sound\n{TRIANGLE}AC R\nAN Tangle\n{points}")
    (unread,) = found.unread
    assert unread.name == "Tangle"
    assert unread.bbox is not None
    assert 9.0 <= unread.bbox[0] < unread.bbox[2] <= 10.0
