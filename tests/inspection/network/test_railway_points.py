"""Thinning of railways: short enough legs, true to the track, junctions kept."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import LineString, Point

from inspection.geodesy import distance_m, path_length_m
from inspection.network.build.joining import join_vertices
from inspection.network.build.network import NO_PLACES
from inspection.network.build.railway_points import RailwayPoints, railway_points
from tests.inspection.network.drawn_ground import LAT, LON, lonlat, ways


def points_of(*tracks, osm=()) -> RailwayPoints:
    drawn = ways(*tracks, first_asset=300, osm=osm)
    return railway_points(drawn, join_vertices(NO_PLACES, drawn), 250.0)


def leg_lengths_m(points: RailwayPoints) -> np.ndarray:
    return distance_m(points.position[points.leg[:, 0]], points.position[points.leg[:, 1]])


def metres(position: np.ndarray) -> np.ndarray:
    """Near the origin: east and north, to a per mille."""
    east_m = distance_m(np.array([(LON, LAT)]), np.array([(LON + 0.01, LAT)]))[0] / 0.01
    north_m = distance_m(np.array([(LON, LAT)]), np.array([(LON, LAT + 0.01)]))[0] / 0.01
    return (position - [LON, LAT]) * [east_m, north_m]


def test_a_straight_track_is_thinned_to_steps_of_at_most_250_m():
    points = points_of([(10.0 * number, 0) for number in range(101)], osm=[range(101)])
    assert leg_lengths_m(points) == pytest.approx([240.0] * 4 + [40.0], abs=0.1)
    assert (leg_lengths_m(points) <= 250.0).all()


def test_a_long_leg_is_divided_into_equal_pieces():
    points = points_of([(0, 0), (1_100, 0)], osm=[[1, 2]])
    assert leg_lengths_m(points) == pytest.approx([220.0] * 5, abs=0.1)
    assert sorted(points.leg.ravel().tolist()) == sorted([0, 1] + [2, 3, 4, 5] * 2)


def test_a_curve_keeps_the_vertices_that_hold_legs_within_15_m():
    """A quarter circle of 100 m radius: its chord would stray 29 m."""
    curve = [(100 * np.sin(angle), 100 * (1 - np.cos(angle))) for angle in np.linspace(0, np.pi / 2, 40)]
    points = points_of(curve, osm=[range(40)])
    assert 2 < len(points.position) < 8
    assert greatest_stray_m(curve, points) <= 15.1


def greatest_stray_m(track, points: RailwayPoints) -> float:
    flown = LineString(metres(points.position[[*points.leg[:, 0], points.leg[-1, 1]]]))
    return max(flown.distance(Point(spot)) for spot in metres(np.array([lonlat(spot) for spot in track])))


def test_a_junction_stays_in_the_middle_of_a_straight_track():
    """The branch leaves the main track at its 35th metre."""
    main = [(7.0 * number, 0) for number in range(31)]
    points = points_of(main, [(35.0, 0), (35.0, 200)], osm=[range(31), [5, 99]])
    assert len(points.position) == 4
    degree = np.bincount(points.leg.ravel())
    assert sorted(degree.tolist()) == [1, 1, 1, 3]


def test_a_closed_track_stays_closed():
    circle = [(300 * np.cos(angle), 300 * np.sin(angle)) for angle in np.linspace(0, 2 * np.pi, 73)]
    points = points_of(circle, osm=[[*range(72), 0]])
    assert np.bincount(points.leg.ravel()).tolist() == [2] * len(points.position)


def test_drawn_tracks_join_where_they_touch():
    points = points_of([(0, 0), (200, 0)], [(200.5, 0), (400, 0)])
    assert len(points.position) == 3


def test_no_railways_give_no_points():
    points = points_of()
    assert len(points.position) == len(points.leg) == 0


steps = st.tuples(st.floats(1.0, 120.0), st.floats(-0.6, 0.6))


@given(st.lists(steps, min_size=1, max_size=60))
def test_any_track_is_followed_closely_in_short_legs(turns):
    heading, spot, track = 0.0, (0.0, 0.0), [(0.0, 0.0)]
    for length_m, turn in turns:
        heading += turn
        spot = (spot[0] + length_m * np.cos(heading), spot[1] + length_m * np.sin(heading))
        track.append(spot)
    points = points_of(track, osm=[range(len(track))])
    assert (leg_lengths_m(points) <= 250.5).all()
    assert greatest_stray_m(track, points) <= 15.5
    whole_m = path_length_m(np.array([lonlat(spot) for spot in track]))
    assert leg_lengths_m(points).sum() <= whole_m + 0.01
