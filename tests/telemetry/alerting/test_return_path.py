"""The way home by the rest of the approved list: never through a zone, never nearer to the ground or wires than the margin."""

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from inspection.network.spans import Spans, spans_between
from mavlink.approved_route import HOVER, RETURN, Flight, FrozenWaypoint, TakeOff
from planning.clearance.zone_clearance import Margins, ZoneFacts
from planning.rules import FlightRules
from planning.trajectory.waypoints import WaypointKind
from telemetry.alerting.return_path import Here, ReturnPath, return_path, return_path_points

RULES, MARGINS = FlightRules(), Margins(lateral_m=12.0, height_m=10.0, terrain_tolerance_m=10.0)
FRAME = LocalFrame.around(10.0, 56.0)
BASE_M = 100.0
#  north 300:          2 ------------ 3
#                      |              |
#  north 0:    home 0/5 - 1        4 (below 3, back to home beside the way out)
OUT_AND_BACK = [(0, 0), (400, 0), (400, 300), (1000, 300), (1000, 20), (0, 20)]


def lon_lat(east: float, north: float) -> LonLat:
    lon, lat = FRAME.to_degrees(np.array([[east, north]], dtype=np.float64))[0]
    return LonLat(float(lon), float(lat))


def a_flight(places: list[tuple[float, float]] = OUT_AND_BACK, height_m: float = 60.0, end_action: str = RETURN) -> Flight:
    waypoints = tuple(
        FrozenWaypoint(number, lon_lat(*place), WaypointKind.PASS, height_m, height_m, BASE_M + height_m)
        for number, place in enumerate(places)
    )
    return Flight(0, TakeOff(waypoints[0].position, BASE_M), waypoints, end_action)


def zones(*boxes: tuple[float, float, float, float]) -> ZoneFacts:
    """West, south, east, north [m], at any height and time."""
    polygons = [shapely.Polygon([lon_lat(w, s), lon_lat(e, s), lon_lat(e, n), lon_lat(w, n)]) for w, s, e, n in boxes]
    return ZoneFacts.of(polygons, [(None, "AGL", None, "AGL")] * len(boxes), [None] * len(boxes))


def wires(*lines: tuple[tuple[float, float], tuple[float, float], float]) -> Spans:
    """From place to place, so high."""
    start, end = (np.array([lon_lat(*line[side]) for line in lines]).reshape(-1, 2) for side in (0, 1))
    top_m = np.array([line[2] for line in lines], dtype=np.float64)
    return spans_between(start, end, top_m, top_m)


def flat(positions: np.ndarray) -> np.ndarray:
    return np.full(len(positions), BASE_M)


def along(
    flight: Flight, east: float, north: float, ahead: int, *, ground=flat, spans=None, meets=None, height_m=60.0
) -> ReturnPath | None:
    return return_path(
        flight, Here(lon_lat(east, north), height_m, ahead), cruise_mps=10.0, base_m=BASE_M, ground_heights_m=ground,
        spans=wires() if spans is None else spans, zones=zones() if meets is None else meets, margins=MARGINS, rules=RULES,
    )  # fmt: skip


def test_with_nothing_in_the_way_it_flies_straight_to_the_last_waypoint():
    way = along(a_flight(), 900.0, 300.0, 3)
    assert way is not None and (way.first, way.targets) == (5, ())
    assert way.length_m == pytest.approx(math.hypot(900.0, 280.0), abs=2.0)
    assert way.duration_s > way.length_m / 10.0


def test_it_joins_the_leg_back_before_a_zone_that_lies_in_the_straight_way():
    way = along(a_flight(), 900.0, 300.0, 3, meets=zones((480.0, 60.0, 520.0, 260.0)))
    assert way is not None and way.first == 4


def test_wires_and_ground_count_as_zones_do():
    line = wires(((500.0, 60.0), (500.0, 260.0), 55.0))
    assert along(a_flight(), 900.0, 300.0, 3, spans=line).first == 4

    def hill(positions: np.ndarray) -> np.ndarray:
        metres = FRAME.to_metres(positions)
        return BASE_M + 55.0 * np.exp(-((metres[:, 0] - 500.0) ** 2 + (metres[:, 1] - 160.0) ** 2) / 40.0**2)

    assert along(a_flight(), 900.0, 300.0, 3, ground=hill).first == 4


def test_none_is_offered_where_the_rest_of_the_list_meets_a_zone_or_the_ground_is_not_known():
    assert along(a_flight(), 900.0, 300.0, 3, meets=zones((-40.0, -40.0, 40.0, 60.0))) is None
    assert along(a_flight(), 900.0, 300.0, 3, ground=lambda positions: np.full(len(positions), np.nan)) is None


def test_a_flight_that_hovers_at_its_end_has_no_way_home():
    assert along(a_flight(end_action=HOVER), 900.0, 300.0, 3) is None


place = st.tuples(st.floats(-800, 800), st.floats(-800, 800))
box = st.tuples(place, st.floats(20, 300), st.floats(20, 300)).map(lambda b: (b[0][0], b[0][1], b[0][0] + b[1], b[0][1] + b[2]))
wire = st.tuples(place, place, st.floats(20, 70)).filter(lambda line: math.dist(line[0], line[1]) > 20.0)


@given(
    st.lists(place, min_size=3, max_size=8), place, st.floats(20.0, 110.0), st.lists(box, max_size=3), st.lists(wire, max_size=3),
    st.tuples(place, st.floats(0.0, 90.0), st.floats(60.0, 400.0)),
)  # fmt: skip
def test_no_way_that_is_offered_crosses_a_zone_or_goes_below_the_margins(places, here, height_m, boxes, lines, top):
    """By shapely in metres and by steps of 3 m. The rest of the list is as approved: over the ground and wires only the new leg counts."""
    (top_east, top_north), top_m, wide_m = top

    def above(metres: np.ndarray) -> np.ndarray:
        return top_m * np.exp(-((metres[:, 0] - top_east) ** 2 + (metres[:, 1] - top_north) ** 2) / wide_m**2)

    flight = a_flight(places)
    ground = lambda positions: BASE_M + above(FRAME.to_metres(positions))  # noqa: E731
    way = along(flight, *here, 0, ground=ground, meets=zones(*boxes), spans=wires(*lines), height_m=height_m)
    if way is None:
        return
    flown = return_path_points(flight, way, Here(lon_lat(*here), height_m, 0))
    metres = FRAME.to_metres(np.array([point for point, _height_m, _hold_s in flown]))
    for start, end in pairwise(metres):
        for west, south, east, north in boxes:
            assert shapely.LineString([start, end]).distance(shapely.box(west, south, east, north)) >= MARGINS.lateral_m - 0.5
    share = np.linspace(0.0, 1.0, max(2, math.ceil(math.dist(*metres[:2]) / 3.0)))
    steps = metres[0] + share[:, None] * (metres[1] - metres[0])
    heights_m = flown[0][1] + share * (flown[1][1] - flown[0][1])
    kept_m = min(RULES.clearance_m, height_m - float(above(metres[:1])[0]), 60.0)
    assert (heights_m - above(steps) >= kept_m - 1.0).all()
    for begin, until, tall_m in lines:
        feet = above(np.array([begin, until]))
        span, length_m = shapely.LineString([begin, until]), math.dist(begin, until)
        for step, level_m in zip(steps, heights_m, strict=True):
            where = span.project(shapely.Point(step)) / length_m
            hangs_m = tall_m + feet[0] + where * (feet[1] - feet[0])
            assert span.distance(shapely.Point(step)) >= 24.0 or level_m - hangs_m >= RULES.clearance_m - 3.0 - 0.3 * span.distance(
                shapely.Point(step)
            )
