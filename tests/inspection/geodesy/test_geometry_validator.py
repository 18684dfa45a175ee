"""Row S6 of the target table: a verdict for every odd geometry, within a second, and never a repair."""

import json
import math
import random

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import Point, Polygon

from inspection.geodesy.geometry_validator import (
    MAX_POLYGON_VERTICES,
    GeometryFault,
    VertexBudget,
    checked_area,
    checked_geometry,
    checked_line,
    checked_position,
)
from inspection.importers.strict_json import JsonFault, parse_strict_json
from tests.runaway import no_runaway


def polygon(*rings):
    return {"type": "Polygon", "coordinates": [[list(position) for position in ring] for ring in rings]}


def ring_of(number, radius=1.0):
    corners = [[9 + radius * math.cos(2 * math.pi * k / number), 47 + radius * math.sin(2 * math.pi * k / number)] for k in range(number)]
    return [*corners, corners[0]]


def random_ring(number):
    source = random.Random(7)
    corners = [[9 + source.random(), 47 + source.random()] for _ in range(number)]
    return [*corners, corners[0]]


SQUARE = [[9, 47], [10, 47], [10, 48], [9, 48], [9, 47]]
BOWTIE = [[9, 47], [10, 48], [10, 47], [9, 48], [9, 47]]

REFUSED = {
    "bowtie": (polygon(BOWTIE), "geometry.coordinates", "self-intersection", (9.5, 47.5)),
    "random ring of 2,000 points": (polygon(random_ring(2_000)), "geometry.coordinates", "self-intersection", None),
    "unclosed": (polygon(SQUARE[:-1]), "geometry.coordinates[0][3]", "not closed", (9, 48)),
    "all points the same": (polygon([[9, 47]] * 5), "geometry.coordinates[0]", "fewer than three different", (9, 47)),
    "hole outside": (polygon(SQUARE, [[11, 47], [12, 47], [12, 48], [11, 47]]), "geometry.coordinates", "hole lies outside shell", None),
    "hole across the shell": (polygon(SQUARE, [[9.5, 47.5], [11, 47.5], [11, 47.6], [9.5, 47.5]]), "geometry.coordinates", "", None),
    "zero area": (polygon([[9, 47], [10, 47], [11, 47], [9, 47]]), "geometry.coordinates", "", None),
    "spike": (
        polygon([[9, 47], [10, 47], [10, 48], [10, 50], [10, 48], [9, 48], [9, 47]]), "geometry.coordinates", "self-intersection", None,
    ),
    "off the earth": (polygon([[500, 95], [501, 95], [501, 96], [500, 95]]), "geometry.coordinates[0][0]", "latitude 95", None),
    "longitude off the earth": (polygon([[500, 5], [501, 5], [501, 6], [500, 5]]), "geometry.coordinates[0][0]", "longitude 500", None),
    "swapped": (polygon([[47, 139], [47, 140], [48, 140], [47, 139]]), "geometry.coordinates[0][0]", "swapped", None),
    "empty polygon": ({"type": "Polygon", "coordinates": []}, "geometry.coordinates", "empty", None),
    "empty ring": (polygon([]), "geometry.coordinates[0]", "empty", None),
    "empty multipolygon": ({"type": "MultiPolygon", "coordinates": []}, "geometry.coordinates", "empty", None),
    "no coordinates": ({"type": "Polygon"}, "geometry.coordinates", "empty", None),
    "NaN": (polygon([[9, 47], [math.nan, 47], [10, 48], [9, 47]]), "geometry.coordinates[0][1]", "not finite", None),
    "infinity": (polygon([[9, 47], [math.inf, 47], [10, 48], [9, 47]]), "geometry.coordinates[0][1]", "not finite", None),
    "height that is NaN": (polygon([[9, 47], [10, 47, math.nan], [10, 48], [9, 47]]), "geometry.coordinates[0][1]", "not finite", None),
    "integer of 400 digits": (
        polygon([[9, 47], [10**400, 47], [10, 48], [9, 47]]), "geometry.coordinates[0][1]", "more than 40 digits", None,
    ),
    "text for a number": (polygon([[9, 47], ["10", 47], [10, 48], [9, 47]]), "geometry.coordinates[0][1]", "no number", None),
    "true for a number": (polygon([[9, 47], [True, 47], [10, 48], [9, 47]]), "geometry.coordinates[0][1]", "no number", None),
    "one number": (polygon([[9, 47], [10], [10, 48], [9, 47]]), "geometry.coordinates[0][1]", "not 1 numbers", None),
    "pole inside": (polygon([[0, 80], [90, 80], [180, 80], [-90, 80], [0, 80]]), "geometry.coordinates", "pole", None),
    "half-turn that is ambiguous": (
        polygon([[-180, -80], [180, -80], [180, 80], [-180, 80], [-180, -80]]), "geometry.coordinates", "whole way round", None,
    ),
    "100,000 vertices": (polygon(ring_of(100_000)), "geometry.coordinates", f"at most {MAX_POLYGON_VERTICES}", None),
    "overlapping parts": (
        {"type": "MultiPolygon", "coordinates": [[SQUARE], [[[9.5, 47.5], [11, 47.5], [11, 49], [9.5, 47.5]]]]},
        "geometry.coordinates", "self-intersection", None,
    ),
    "a line for an area": ({"type": "LineString", "coordinates": SQUARE}, "geometry", "no area", None),
    "no type": ({"coordinates": [SQUARE]}, "geometry", "no area", None),
    "a list": ([SQUARE], "geometry", "object", None),
    "nothing": (None, "geometry", "no geometry", None),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_an_odd_area_is_refused_with_the_place_of_its_fault(name):
    value, place, message, position = REFUSED[name]
    with no_runaway(), pytest.raises(GeometryFault) as refusal:
        checked_area(value)
    assert refusal.value.place == place
    assert message in refusal.value.message
    if position is not None:
        assert refusal.value.position == pytest.approx(position)


ACCEPTED = {
    "square": (polygon(SQUARE), 1.0),
    "clockwise square": (polygon(SQUARE[::-1]), 1.0),
    "repeated points, as in the Swiss test document": (polygon([SQUARE[0], *SQUARE]), 1.0),
    "square with a hole": (polygon(SQUARE, [[9.2, 47.2], [9.4, 47.2], [9.4, 47.4], [9.2, 47.4], [9.2, 47.2]]), 0.96),
    "heights beside the positions": (polygon([[*position, 400.0] for position in SQUARE]), 1.0),
    "two parts": ({"type": "MultiPolygon", "coordinates": [[SQUARE], [[[11, 47], [12, 47], [12, 48], [11, 47]]]]}, 1.5),
    "as many vertices as are taken": (polygon(ring_of(MAX_POLYGON_VERTICES - 1)), math.pi),
    "touching 180": (polygon([[179, 0], [180, 0], [180, 1], [179, 1], [179, 0]]), 1.0),
    "touching the pole": (polygon([[0, 89], [90, 89], [90, 90], [0, 90], [0, 89]]), 90.0),
}


@pytest.mark.parametrize("name", ACCEPTED)
def test_a_sound_area_is_taken_as_it_was_sent(name):
    value, area = ACCEPTED[name]
    taken = checked_area(value)
    assert taken.is_valid
    assert taken.area == pytest.approx(area, rel=1e-4)
    sent = value["coordinates"] if value["type"] == "Polygon" else value["coordinates"][0]
    assert [list(position) for position in taken.geoms[0].exterior.coords] == [list(position[:2]) for position in sent[0]]


def test_an_area_over_the_antimeridian_is_cut_there():
    taken = checked_area(polygon([[179, 0], [-179, 0], [-179, 1], [179, 1], [179, 0]]))
    assert taken.is_valid
    assert taken.area == pytest.approx(2.0)
    assert taken.covers(Point(179.5, 0.5))
    assert taken.covers(Point(-179.5, 0.5))
    assert not taken.covers(Point(0.0, 0.5))


def test_a_hole_over_the_antimeridian_is_cut_with_its_shell():
    shell = [[178, 0], [-178, 0], [-178, 4], [178, 4], [178, 0]]
    taken = checked_area(
        polygon(shell, [[179, 1], [-179, 1], [-179, 3], [179, 3], [179, 1]], [[-178.8, 3.2], [-178.4, 3.2], [-178.4, 3.6], [-178.8, 3.2]])
    )
    assert taken.area == pytest.approx(16 - 4 - 0.08)
    assert not taken.covers(Point(179.9, 2.0))
    assert taken.covers(Point(178.5, 2.0))


def test_a_bowtie_over_the_antimeridian_is_refused_where_it_crosses():
    with pytest.raises(GeometryFault) as refusal:
        checked_area(polygon([[179, 0], [-179, 1], [-179, 0], [179, 1], [179, 0]]))
    assert abs(refusal.value.position.lon) == pytest.approx(180.0)


def test_the_document_as_a_whole_has_a_limit():
    budget = VertexBudget(vertices=12)
    checked_area(polygon(SQUARE), "a", budget)
    checked_area(polygon(SQUARE), "b", budget)
    with pytest.raises(GeometryFault, match="more than 12 vertices"):
        checked_area(polygon(SQUARE), "c", budget)


def test_a_line_across_the_antimeridian_or_without_length_is_refused():
    with pytest.raises(GeometryFault, match="antimeridian"):
        checked_line([[179, 0], [-179, 0]], "line")
    with pytest.raises(GeometryFault, match="no length"):
        checked_line([[9, 47], [9, 47]], "line")


def test_points_lines_and_areas_come_through_one_door():
    assert checked_geometry({"type": "Point", "coordinates": [9, 47]}).equals(Point(9, 47))
    assert checked_geometry({"type": "LineString", "coordinates": [[9, 47], [10, 47]]}).length == 1.0
    assert checked_geometry(polygon(SQUARE)).geom_type == "MultiPolygon"
    with pytest.raises(GeometryFault, match="is not one of"):
        checked_geometry({"type": "MultiPoint", "coordinates": [[9, 47]]})


def test_a_position_tells_when_longitude_and_latitude_look_swapped():
    with pytest.raises(GeometryFault, match="swapped"):
        checked_position([39.9, -120.0], "uavs[0].position")


numbers = st.one_of(st.floats(), st.integers(), st.booleans(), st.none(), st.text(max_size=3), st.sampled_from([180, -180, 90.0, 1e308]))


@given(st.lists(numbers, max_size=5))
def test_no_position_off_the_earth_comes_through(value):
    try:
        lon, lat = checked_position(value)
    except GeometryFault:
        return
    assert -180 <= lon <= 180
    assert -90 <= lat <= 90


coordinates = st.one_of(st.floats(min_value=-200, max_value=200), st.sampled_from([-180, 180, -179, 179, 0, math.nan, math.inf]))
rings = st.lists(st.tuples(coordinates, coordinates).map(list), min_size=1, max_size=8).map(lambda ring: [*ring, ring[0]])


@given(st.lists(rings, min_size=1, max_size=3))
def test_whatever_area_comes_through_is_finite_on_earth_and_valid(sent):
    try:
        taken = checked_area({"type": "Polygon", "coordinates": sent})
    except GeometryFault:
        return
    points = shapely.get_coordinates(taken)
    assert np.isfinite(points).all()
    assert (np.abs(points) <= (180.0, 90.0)).all()
    assert taken.is_valid
    assert taken.area > 0.0


@given(st.lists(st.tuples(st.floats(170, 190), st.floats(-80, 80)), min_size=3, max_size=7))
def test_cutting_at_the_antimeridian_keeps_the_area(corners):
    whole = Polygon(corners)
    wrapped = [[lon - 360.0 if lon > 180.0 else lon, lat] for lon, lat in corners]
    try:
        taken = checked_area(polygon([*wrapped, wrapped[0]]))
    except GeometryFault:
        return
    assert taken.area == pytest.approx(whole.area, rel=1e-6, abs=1e-9)


def test_json_refuses_what_is_no_json():
    for text in (
        '{"a": NaN}',
        '{"a": -Infinity}',
        '{"a": 1e999}',
        '{"a": -1e999}',
        '{"a": 1',
        "",
        b"\xff\xfe",
        "[" * 20_000 + "]" * 20_000,
    ):
        with no_runaway(), pytest.raises(JsonFault):
            parse_strict_json(text, max_bytes=1_000_000)


def test_json_has_limits_of_size_and_depth_and_takes_a_byte_order_mark():
    with pytest.raises(JsonFault, match="at most"):
        parse_strict_json("[" + "1," * 1_000 + "1]", max_bytes=1_000)
    with pytest.raises(JsonFault, match="more than 3 deep"):
        parse_strict_json("[[[[]]]]", max_bytes=1_000, max_depth=3)
    assert parse_strict_json("[[[1]]]", max_bytes=1_000, max_depth=3) == [[[1]]]
    assert parse_strict_json(b"\xef\xbb\xbf" + json.dumps({"a": "ü"}).encode(), max_bytes=1_000) == {"a": "ü"}
