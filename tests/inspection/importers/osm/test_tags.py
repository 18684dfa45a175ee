"""What OSM tags mean."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.importers.osm import tags


@pytest.mark.parametrize(
    ("text", "volts"),
    [
        ("138000;69000", (138_000, 69_000)),
        ("69000;138000", (138_000, 69_000)),
        ("110 kV", (110_000,)),
        ("110kv", (110_000,)),
        ("110/20 kV", (110_000, 20_000)),
        ("400 kV;220 kV", (400_000, 220_000)),
        ("220000-400000", (400_000, 220_000)),
        ("138,000", (138_000,)),
        ("138000,69000", (138_000, 69_000)),
        ("16700", (16_700,)),
        ("400", (400,)),
        ("110000;110000", (110_000,)),
        ("x;110000", (110_000,)),
        ("110000;", (110_000,)),
    ],
)
def test_voltage_lists_become_volts_highest_first(text, volts):
    assert tags.voltages_v(text) == volts


@pytest.mark.parametrize(
    "text", [None, "", ";", "medium", "unknown", "0", "-5", "1e5", "NaN", "²", "9999999999", "110000000000000000000000000"]
)
def test_a_voltage_that_cannot_be_read_is_not_stated(text):
    assert tags.voltages_v(text) == ()


@given(st.text(max_size=60) | st.text(alphabet="0123456789;,/-. kKvV|", max_size=60))
def test_the_voltage_parser_never_raises_and_stays_in_bounds(text):
    volts = tags.voltages_v(text)
    assert list(volts) == sorted(set(volts), reverse=True)
    assert all(0 < value <= tags.MAX_VOLTAGE_V for value in volts)


@pytest.mark.parametrize(
    ("text", "metres"),
    [
        ("45", 45.0),
        ("45.5 m", 45.5),
        ("45,5", 45.5),
        ("~45", 45.0),
        ("148 ft", 45.1104),
        ("148'", 45.1104),
        ("12'6\"", 3.81),
        ("5 ft 3 in", 1.6002),
    ],
)
def test_heights_with_units_become_metres(text, metres):
    assert tags.length_m(text, maximum_m=1_000.0) == pytest.approx(metres)


@pytest.mark.parametrize("text", [None, "", "tall", "-3", "0", "99999", "inf", "nan", "45 furlongs"])
def test_a_height_that_cannot_be_read_is_not_stated(text):
    assert tags.length_m(text, maximum_m=1_000.0) is None


@given(st.text(max_size=40) | st.text(alphabet="0123456789.,'\" ftinmc~", max_size=40))
def test_the_height_parser_never_raises_and_stays_in_bounds(text):
    metres = tags.length_m(text, maximum_m=1_000.0)
    assert metres is None or 0.0 < metres <= 1_000.0


@pytest.mark.parametrize(
    "more",
    [
        {"power": "cable"},
        {"power": "minor_cable"},
        {"power": "line", "line": "busbar"},
        {"power": "line", "line": "bay"},
        {"power": "line", "location": "underground"},
        {"power": "line", "tunnel": "yes"},
        {"power": "line", "disused": "yes"},
        {"power": "line", "abandoned": "yes"},
    ],
)
def test_lines_that_no_uav_can_follow_are_not_flyable(more):
    assert not tags.is_flyable_line(more)


def test_an_overhead_line_is_flyable_also_if_a_tag_denies_being_disused():
    assert tags.is_flyable_line({"power": "line", "disused": "no", "tunnel": "no"})
    assert tags.is_flyable_line({"power": "minor_line"})


@pytest.mark.parametrize(
    ("more", "is_flyable"),
    [
        ({"railway": "rail"}, True),
        ({"railway": "tram"}, True),
        ({"railway": "rail", "tunnel": "yes"}, False),
        ({"railway": "rail", "tunnel": "building_passage"}, False),
        ({"railway": "disused"}, False),
        ({"railway": "abandoned"}, False),
        ({"railway": "construction"}, False),
        ({"railway": "rail", "disused": "yes"}, False),
    ],
)
def test_only_tracks_in_use_and_in_the_open_are_flyable(more, is_flyable):
    assert tags.is_flyable_railway(more) is is_flyable


def test_platforms_and_stations_are_no_railway_track():
    assert [tags.railway_kind({"railway": kind}) for kind in ("platform", "station", "proposed", "switch")] == [None] * 4


@pytest.mark.parametrize(
    ("value", "is_bridge"), [("yes", True), ("viaduct", True), ("movable", True), ("no", False), ("", False), (None, False)]
)
def test_a_bridge_tag_that_is_not_no_makes_a_bridge(value, is_bridge):
    assert tags.is_bridge({} if value is None else {"bridge": value}) is is_bridge


@pytest.mark.parametrize(
    ("more", "metres"),
    [
        ({"highway": "motorway", "width": "14.5"}, 14.5),
        ({"highway": "primary", "lanes": "4"}, 16.0),
        ({"railway": "rail", "tracks": "2"}, 12.0),
        ({"railway": "rail"}, 6.0),
        ({"highway": "footway"}, 2.5),
        ({}, 5.0),
        ({"highway": "primary", "width": "wide"}, 10.0),
    ],
)
def test_a_bridge_is_as_wide_as_tagged_or_usual_for_its_kind(more, metres):
    assert tags.bridge_width_m(more) == metres
