"""The last look at zones in space, height and time."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import distance_m
from planning.clearance.zone_clearance import TAKE_OFF, Breach, FlownRoute, Limits, Margins, ZoneFacts, breaches

EVERYWHERE: Limits = (None, "", None, "")
BOX = shapely.box(10.010, 56.000, 10.012, 56.001)  # the second leg of EAST goes through it
PLACES = np.array([[10.000, 56.0005], [10.005, 56.0005], [10.015, 56.0005], [10.020, 56.0005]])


def east(*agl_m: float, ground_m: float | None = None, **facts: Any) -> FlownRoute:
    """A --- B --x-- C --- D along 56.0005 N; the zone is at x."""
    heights = np.array(agl_m or (60.0, 60.0, 60.0, 60.0))
    return FlownRoute(PLACES[: len(heights)], heights, None if ground_m is None else heights + ground_m, **facts)


def zones(*rows: tuple[Any, Limits, Any]) -> ZoneFacts:
    return ZoneFacts.of([row[0] for row in rows], [row[1] for row in rows], [row[2] for row in rows])


def met(route: FlownRoute, *rows: tuple[Any, Limits, Any], **margins: float) -> list[tuple[int, int]]:
    return [(breach.leg, breach.zone) for breach in breaches(route, zones(*rows), Margins(**margins))]


@pytest.mark.parametrize(
    ("limits", "is_met"),
    [  # flown between 60 m and 80 m above ground that is 100 m above the sea
        (EVERYWHERE, True),
        ((0.0, "AGL", 59.0, "AGL"), False),
        ((0.0, "AGL", 60.0, "AGL"), True),
        ((80.0, "AGL", None, ""), True),
        ((81.0, "AGL", None, ""), False),
        ((None, "", 159.0, "AMSL"), False),
        ((None, "", 160.0, "AMSL"), True),
        ((180.0, "AMSL", 500.0, "AMSL"), True),
        ((181.0, "AMSL", 500.0, "AMSL"), False),
        ((70.0, "AGL", 150.0, "AMSL"), False),
        ((3_000.0, "STD", None, ""), True),
        ((3_000.0, "WGS84", 4_000.0, "WGS84"), True),
        ((3_000.0, "", None, ""), True),
    ],
)
def test_a_leg_is_between_the_heights_of_its_ends(limits: Limits, is_met: bool) -> None:
    assert met(east(60.0, 80.0, 60.0, 60.0, ground_m=100.0), (BOX, limits, None)) == ([(1, 0)] if is_met else [])


def test_above_ground_that_is_not_known_a_limit_above_the_sea_reaches() -> None:
    assert met(east(), (BOX, (3_000.0, "AMSL", None, ""), None)) == [(1, 0)]
    gap = FlownRoute(PLACES, np.full(4, 60.0), np.array([160.0, np.nan, 160.0, 160.0]))
    assert met(gap, (BOX, (3_000.0, "AMSL", None, ""), None)) == [(1, 0)]


def test_margin_and_terrain_tolerance_add_up_below_and_above() -> None:
    for limits in ((100.0, "AGL", None, ""), (None, "", 20.0, "AGL")):
        assert met(east(), (BOX, limits, None), height_m=30.0, terrain_tolerance_m=9.0) == []
        assert met(east(), (BOX, limits, None), height_m=30.0, terrain_tolerance_m=10.0) == [(1, 0)]


def test_the_columns_at_start_and_landing_count() -> None:
    low_at_start, low_at_end = shapely.Point(10.0, 56.0005).buffer(0.001), shapely.Point(10.02, 56.0005).buffer(0.001)
    low: Limits = (0.0, "AGL", 30.0, "AGL")
    assert met(east(), (low_at_start, low, None), (low_at_end, low, None)) == [(TAKE_OFF, 0)]
    assert met(east(lands=True), (low_at_start, low, None), (low_at_end, low, None)) == [(TAKE_OFF, 0), (3, 1)]
    sea_level: Limits = (None, "", 110.0, "AMSL")
    assert met(east(lands=True, ground_m=100.0), (low_at_start, sea_level, None), (low_at_end, sea_level, None)) == [(TAKE_OFF, 0), (3, 1)]


def test_a_descent_to_a_target_counts() -> None:
    places = PLACES[[0, 1, 1, 2]]
    route = FlownRoute(places, np.array([60.0, 60.0, 25.0, 60.0]))
    around_target = shapely.Point(10.005, 56.0005).buffer(0.0001)
    assert met(route, (around_target, (0.0, "AGL", 30.0, "AGL"), None)) == [(1, 0), (2, 0)]


def test_a_leg_counts_at_its_time() -> None:
    """The second leg is flown from 100 s to 150 s."""
    route = east(arrival_s=np.array([20.0, 100.0, 150.0, 200.0]), departs_s=0.0, ends_s=220.0)
    for spans, is_met in (
        (None, True),
        ((), False),
        (((0.0, 100.0),), False),
        (((0.0, 100.1),), True),
        (((150.0, 300.0),), True),
        (((150.1, 300.0),), False),
        (((0.0, 50.0), (120.0, 121.0)), True),
    ):
        assert met(route, (BOX, EVERYWHERE, spans)) == ([(1, 0)] if is_met else [])
    assert met(route, (BOX, EVERYWHERE, ((0.0, 90.0),)), time_s=9.0) == []
    assert met(route, (BOX, EVERYWHERE, ((0.0, 90.0),)), time_s=11.0) == [(1, 0)]


def test_what_is_not_known_of_the_time_is_any_time() -> None:
    assert met(east(), (BOX, EVERYWHERE, ())) == [(1, 0)]
    route = east(arrival_s=np.array([20.0, np.nan, 150.0, 200.0]))
    assert met(route, (BOX, EVERYWHERE, ((10.0, 15.0),))) == [(1, 0)]
    at_start = shapely.Point(10.0, 56.0005).buffer(0.001)
    known = east(arrival_s=np.array([20.0, 100.0, 150.0, 200.0]))  # but not when it takes off
    assert met(known, (at_start, EVERYWHERE, ((5.0, 6.0),))) == [(TAKE_OFF, 0)]
    assert met(known, (at_start, EVERYWHERE, ((300.0, 400.0),))) == []


def test_a_breach_says_where_when_and_how_high() -> None:
    route = east(60.0, 80.0, 60.0, 60.0, arrival_s=np.array([20.0, 100.0, 150.0, 200.0]), departs_s=0.0, ends_s=220.0)
    found = breaches(route, zones((BOX, EVERYWHERE, ((120.0, 130.0), (140.0, 999.0)))), Margins(time_s=2.0, terrain_tolerance_m=10.0))
    assert found == [Breach(1, 0, 50.0, 90.0, 0.0, 118.0, 132.0), Breach(1, 0, 50.0, 90.0, 0.0, 138.0, 150.0)]


def test_passing_too_near_is_meeting() -> None:
    """The route passes 0.0005 degrees, 55.68 m (WGS84), north of the box."""
    below = shapely.box(10.010, 55.999, 10.012, 56.000)
    assert met(east(), (below, EVERYWHERE, None), lateral_m=55.6) == []
    (found,) = breaches(east(), zones((below, EVERYWHERE, None)), Margins(lateral_m=55.8))
    assert found.distance_m == pytest.approx(55.68, abs=0.01)


def test_a_hole_in_a_zone_is_free_but_for_the_clearance() -> None:
    ring = shapely.box(9.9, 55.9, 10.1, 56.1).difference(shapely.box(9.99, 55.99, 10.03, 56.01))
    assert met(east(), (ring, EVERYWHERE, None)) == []
    assert met(east(), (ring, EVERYWHERE, None), lateral_m=700.0) == [(TAKE_OFF, 0), (0, 0), (2, 0), (3, 0)]


lon, lat = st.floats(9.99, 10.03), st.floats(55.99, 56.01)
height = st.floats(0, 120)


@st.composite
def routes(draw: Any) -> FlownRoute:
    count = draw(st.integers(1, 4))
    position = np.array(draw(st.lists(st.tuples(lon, lat), min_size=count, max_size=count)))
    agl_m = np.array(draw(st.lists(height, min_size=count, max_size=count)))
    ground_m = np.array(draw(st.lists(st.floats(0, 50), min_size=count, max_size=count)))
    took_s = np.array(draw(st.lists(st.floats(0, 300), min_size=count + 2, max_size=count + 2))).cumsum()
    return FlownRoute(position, agl_m, agl_m + ground_m, took_s[1:-1], took_s[0], took_s[-1], draw(st.booleans()))


limit = st.one_of(st.none(), st.floats(0, 200))
reference = st.sampled_from(["AGL", "AMSL"])
spans_of_zone = st.one_of(
    st.none(), st.lists(st.tuples(st.floats(0, 1_500), st.floats(0, 600)).map(lambda at: (at[0], at[0] + at[1])), max_size=2)
)
polygons = st.tuples(lon, lat, st.floats(0.0005, 0.01), st.integers(3, 8)).map(
    lambda at: shapely.Point(at[0], at[1]).buffer(at[2], quad_segs=at[3])
)
rows = st.lists(st.tuples(polygons, st.tuples(limit, reference, limit, reference), spans_of_zone), min_size=1, max_size=3)


def _states(route: FlownRoute) -> list[tuple[int, float, float, float, float, float]]:
    """(leg, lon, lat, AGL, AMSL, time) of samples all along the route, from the ground at its start on."""
    assert route.amsl_m is not None
    assert route.arrival_s is not None
    at = [
        (*place, agl, amsl, when) for place, agl, amsl, when in zip(route.position, route.agl_m, route.amsl_m, route.arrival_s, strict=True)
    ]
    first, last = at[0], at[-1]
    ground, end_ground = first[3] - first[2], last[3] - last[2]
    path = [(*first[:2], 0.0, ground, route.departs_s), *at]
    path.append((*last[:2], 0.0 if route.lands else last[2], end_ground if route.lands else last[3], route.ends_s))
    states = []
    for leg, (start, end) in enumerate(pairwise(path)):
        for share in np.linspace(0, 1, 41):
            states.append((leg - 1, *(a + share * (b - a) for a, b in zip(start, end, strict=True))))
    return states


@given(route=routes(), facts=rows)
def test_no_moment_of_a_flight_in_a_zone_is_overlooked(route: FlownRoute, facts: list[tuple[Any, Limits, Any]]) -> None:
    found = {(breach.leg, breach.zone) for breach in breaches(route, zones(*facts), Margins())}
    for leg, east_deg, north_deg, agl, amsl, when in _states(route):
        for number, (polygon, (low, low_from, high, high_from), spans) in enumerate(facts):
            own_low, own_high = (agl if low_from == "AGL" else amsl), (agl if high_from == "AGL" else amsl)
            inside = polygon.buffer(-1e-9).contains(shapely.Point(east_deg, north_deg))
            in_band = (low is None or own_low > low + 1e-6) and (high is None or own_high < high - 1e-6)
            in_time = spans is None or any(start + 1e-6 < when < end - 1e-6 for start, end in spans)
            if inside and in_band and in_time:
                assert (leg, number) in found


@given(route=routes(), facts=rows, more=st.tuples(st.floats(0, 100), st.floats(0, 50), st.floats(0, 300), st.floats(0, 20)))
def test_wider_margins_find_no_less(route: FlownRoute, facts: list[tuple[Any, Limits, Any]], more: tuple[float, ...]) -> None:
    narrow = {(breach.leg, breach.zone) for breach in breaches(route, zones(*facts), Margins())}
    wide = {(breach.leg, breach.zone) for breach in breaches(route, zones(*facts), Margins(*more))}
    assert narrow <= wide


@given(route=routes(), facts=rows, lateral_m=st.floats(1, 500))
def test_a_leg_named_for_its_nearness_is_as_near_as_said(route: FlownRoute, facts: list[tuple[Any, Limits, Any]], lateral_m: float) -> None:
    for breach in breaches(route, zones(*facts), Margins(lateral_m=lateral_m)):
        assert breach.distance_m <= lateral_m
        if breach.distance_m > 0.01:
            ends = route.position[[max(breach.leg, 0), min(breach.leg + 1, len(route.position) - 1)]]
            share = np.linspace(0, 1, 2_000)[:, None]
            on_leg = ends[0] + share * (ends[1] - ends[0])
            polygon = facts[breach.zone][0]
            border = np.array(
                [polygon.exterior.interpolate(polygon.exterior.project(shapely.Point(place))).coords[0] for place in on_leg[::50]]
            )
            nearest_m = distance_m(on_leg[::50], border).min()
            assert breach.distance_m <= nearest_m * 1.001 + 0.01


def test_three_hundred_zones_and_a_long_route_agree_with_pair_by_pair_shapely() -> None:
    draw = np.random.default_rng(5)
    steps = draw.normal(0, 0.002, (1_500, 2))
    route = FlownRoute(np.array([10.0, 56.0]) + steps.cumsum(axis=0), draw.uniform(20, 120, 1_500))
    centres = route.position[draw.integers(0, 1_500, 300)] + draw.normal(0, 0.01, (300, 2))
    shapes = [shapely.Point(place).buffer(draw.uniform(0.0005, 0.004), quad_segs=4) for place in centres]
    limits: list[Limits] = [(low, "AGL", low + 40.0, "AGL") for low in draw.uniform(0, 150, 300).tolist()]
    found = {(breach.leg, breach.zone) for breach in breaches(route, ZoneFacts.of(shapes, limits, [None] * 300), Margins())}
    expected = set()
    for leg in range(1_499):
        low, high = sorted(route.agl_m[leg : leg + 2])
        line = shapely.LineString(route.position[leg : leg + 2])
        for zone in range(300):
            if high >= limits[zone][0] and low <= limits[zone][2] and line.intersects(shapes[zone]):  # type: ignore[operator]
                expected.add((leg, zone))
    assert {pair for pair in found if 0 <= pair[0] < 1_499} == expected
    assert len(expected) > 100


def test_nothing_is_met_by_nothing() -> None:
    nowhere = FlownRoute(np.zeros((0, 2)), np.zeros(0))
    assert met(nowhere, (BOX, EVERYWHERE, None)) == []
    assert met(east()) == []
    with pytest.raises(ValueError, match="same length"):
        ZoneFacts.of([BOX], [], [None])
    assert math.isinf(ZoneFacts.of([BOX], [(math.nan, "AGL", None, "")], [None]).lower_agl_m[0])
