"""Straight ways home at one height: what lies in them, and from where.

The flight leads 1 km north, 1 km east, and 1 km south again, at 50 m; its take-off is the south-western corner.

    1 ---- 2
    |      |
    0      3
"""

import numpy as np
import pytest
from shapely.geometry import box

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from inspection.network.spans import spans_between
from planning.clearance.rtl_paths import InTheWay, Places, ReturnPoint, RtlPaths
from planning.clearance.surroundings import Surroundings
from planning.clearance.zone_clearance import Margins, ZoneFacts

HOME = LonLat(10.0, 56.0)
FRAME = LocalFrame.around(*HOME)
CORNERS = np.array([[0.0, 0.0], [0.0, 1_000.0], [1_000.0, 1_000.0], [1_000.0, 0.0]])
NO_ZONES = ZoneFacts.of([], [], [])


def lonlat(metres):
    return FRAME.to_degrees(np.array(metres, dtype=np.float64))


def zone(west, south, east, north, upper_agl_m=None):
    (low, high) = lonlat([[west, south], [east, north]])
    return ZoneFacts.of([box(*low, *high)], [(None, "AGL", upper_agl_m, "AGL")], [None])


def wire(start, end, height_m):
    return spans_between(lonlat([start]), lonlat([end]), np.array([height_m]), np.array([height_m]))


NOTHING = spans_between(np.empty((0, 2)), np.empty((0, 2)), np.empty(0), np.empty(0))


def ways(*, zones=NO_ZONES, spans=NOTHING, ground=None, return_point=None, height_m=50.0) -> RtlPaths:
    places = Places.along(lonlat(CORNERS), np.full(4, height_m), [0, 1, 2, 3])
    return RtlPaths(
        places,
        return_point or ReturnPoint(HOME),
        around=Surroundings(zones, Margins(lateral_m=10.0), ground, spans),
        home_amsl_m=None if ground is None else float(ground(np.array([HOME]))[0]),
        clearance_m=15.0,
    )


def obstructions(home: RtlPaths, level_m: float):
    return home.obstructions(home.levels_m(lambda current_m, *_: max(current_m, level_m)))


def test_places_are_every_waypoint_and_points_between():
    corners = lonlat([[0.0, 0.0], [0.0, 120.0], [80.0, 120.0]])
    places = Places.along(corners, np.array([0.0, 60.0, 60.0]), [4, 5, 6])
    assert places.waypoint.tolist() == [4, 5, 5, 5, 6, 6]
    assert places.height_m.tolist() == pytest.approx([0.0, 20.0, 40.0, 60.0, 60.0, 60.0])
    assert FRAME.to_metres(places.position) == pytest.approx(np.array([[0, 0], [0, 40], [0, 80], [0, 120], [40, 120], [80, 120]]), abs=0.01)


def test_free_ground_is_free():
    assert obstructions(ways(), 50.0) == []


def test_a_zone_is_met_from_where_the_straight_way_crosses_it():
    (found,) = obstructions(ways(zones=zone(400.0, 400.0, 500.0, 500.0)), 50.0)
    assert (found.kind, found.zone, found.to_end) == (InTheWay.ZONE, 0, False)
    assert (found.first, found.last) == (2, 3)  # on the way to 2 already, and some way down to 3
    assert found.level_m == 50.0


def test_a_zone_beside_all_ways_is_not_met():
    assert obstructions(ways(zones=zone(1_100.0, 0.0, 1_200.0, 1_000.0)), 50.0) == []


def test_a_zone_is_crossed_above_its_limit_and_not_below():
    home = ways(zones=zone(400.0, 400.0, 500.0, 500.0, upper_agl_m=70.0))
    assert [found.kind for found in obstructions(home, 65.0)] == [InTheWay.ZONE]
    assert obstructions(home, 75.0) == []


@pytest.mark.parametrize(("level_m", "is_free"), [(60.0, False), (74.0, False), (75.0, True), (90.0, True)])
def test_wires_are_passed_with_clearance(level_m, is_free):
    home = ways(spans=wire((300.0, 500.0), (500.0, 300.0), 60.0))
    assert home.lowest_safe_m() == pytest.approx(74.5)  # but for rounding
    assert [found.kind for found in obstructions(home, level_m)] == ([] if is_free else [InTheWay.OBSTACLE])


def test_a_hill_between_is_in_the_way_and_heights_count_from_the_take_off():
    def hill(position):
        east, north = FRAME.to_metres(position).T
        return np.where(np.hypot(east - 500, north - 500) < 150, 260.0, 200.0)

    home = ways(ground=hill)
    (found,) = obstructions(home, 50.0)
    assert (found.kind, found.first, found.last) == (InTheWay.GROUND, 2, 3)
    assert obstructions(home, 75.0) == []
    assert home.most_agl_m(home.levels_m(lambda *_: 75.0)) == 75.0


def test_ground_that_is_not_known_is_said():
    def known_in_the_west(position):
        return np.where(FRAME.to_metres(position)[:, 0] > 700, np.nan, 200.0)

    assert {found.kind for found in obstructions(ways(ground=known_in_the_west), 90.0)} == {InTheWay.UNKNOWN_GROUND}


def test_what_lasts_to_the_end_is_told_so():
    (found,) = obstructions(ways(zones=zone(400.0, -50.0, 500.0, 50.0)), 50.0)
    assert (found.first, found.last, found.to_end) == (3, 3, True)


def test_a_rally_point_has_ways_of_its_own():
    return_point = ReturnPoint(LonLat(*lonlat([[1_000.0, 500.0]])[0]), 40.0, is_rally=True)
    home = ways(zones=zone(400.0, -50.0, 500.0, 600.0), return_point=return_point)
    assert [(found.is_rally, found.first) for found in obstructions(home, 50.0)] == [(True, 0)]
    reported = set()
    home.levels_m(lambda current_m, away_m, goal_m: reported.add(goal_m) or 50.0)
    assert reported == {40.0}
