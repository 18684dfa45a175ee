"""Heights above ground, sea level and take-off."""

import itertools

import numpy as np
import pytest

from inspection.geodesy import LonLat, distance_m
from planning.rules import FlightRules
from planning.trajectory.heights import FloatArray, asset_height_m, inspection_agl_m, is_above_limit, pass_agl_m, with_heights
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints

RULES = FlightRules()


def points(*places: tuple[float, float], agl_m: float = 60.0) -> RoutePoints:
    kinds = [WaypointKind.START, *[WaypointKind.PASS] * (len(places) - 2), WaypointKind.END]
    return RoutePoints.of([RoutePoint(LonLat(*place), kind, agl_m) for place, kind in zip(places, kinds, strict=True)])


def hills(positions: FloatArray) -> FloatArray:
    """Hills of 120 m, 1.5 km apart."""
    return 300.0 + 60.0 * np.sin(positions[:, 0] * 2 * np.pi / 0.024) + 20.0 * np.cos(positions[:, 1] * 2 * np.pi / 0.02)


def flown_height_above_ground_m(waypoints: Waypoints) -> tuple[FloatArray, FloatArray]:
    """Height above the hills and planned height at 200 places of every leg."""
    flown, planned = [], []
    share = np.linspace(0, 1, 200)
    for left, right in itertools.pairwise(waypoints):
        start, end = np.array(left.point.position), np.array(right.point.position)
        ground = hills(start + share[:, None] * (end - start))
        flown.append(left.amsl_m + share * (right.amsl_m - left.amsl_m) - ground)
        planned.append(left.point.agl_m + share * (right.point.agl_m - left.point.agl_m))
    return np.concatenate(flown), np.concatenate(planned)


def test_the_tagged_height_counts_then_voltage_then_kind() -> None:
    assert asset_height_m(kind="tower", subtype="pole", tagged_m=22.0) == 22.0
    assert asset_height_m(kind="tower", subtype="pole") == 14.0
    assert asset_height_m(kind="tower", subtype="tower") == 45.0
    assert asset_height_m(kind="line", subtype="line", voltage_v=380_000) == 60.0
    assert asset_height_m(kind="line", subtype="line", voltage_v=110_000) == 45.0
    assert asset_height_m(kind="line", subtype="minor_line", voltage_v=20_000) == 14.0
    assert asset_height_m(kind="line", tagged_m=float("nan")) == 45.0


def test_nothing_is_passed_below_transit_height_or_nearer_than_the_clearance() -> None:
    assert pass_agl_m(np.array([14.0, 80.0]), RULES).tolist() == [60.0, 95.0]
    assert inspection_agl_m(14.0, RULES) == 29.0
    assert inspection_agl_m(0.0, RULES) == 60.0
    assert not is_above_limit(105.0, RULES)
    assert is_above_limit(105.1, RULES)


def test_heights_round_trip_between_their_references() -> None:
    waypoints, is_flat = with_heights(points((10.0, 56.0), (10.03, 56.01), (10.06, 56.0)), hills, RULES)
    assert not is_flat
    ground_m = hills(np.array([waypoint.point.position for waypoint in waypoints]))
    for waypoint, under_m in zip(waypoints, ground_m, strict=True):
        assert waypoint.amsl_m == pytest.approx(under_m + waypoint.point.agl_m, abs=1e-9)
        assert waypoint.relative_m == pytest.approx(waypoint.amsl_m - ground_m[0], abs=1e-9)
    assert waypoints[0].relative_m == waypoints[0].point.agl_m


def test_between_waypoints_the_height_above_ground_stays_within_the_tolerance() -> None:
    waypoints, _ = with_heights(points((10.0, 56.0), (10.03, 56.01), (10.06, 56.0)), hills, RULES)
    flown_m, planned_m = flown_height_above_ground_m(waypoints)
    assert np.abs(flown_m - planned_m).max() < RULES.terrain_tolerance_m + 1.0  # 1 m: the ground between two samples
    assert len(waypoints) > 6


def test_points_are_put_in_on_the_straight_line_between_two_waypoints() -> None:
    start, end = np.array([10.0, 56.0]), np.array([10.05, 56.02])
    waypoints, _ = with_heights(points(tuple(start), tuple(end)), hills, RULES)
    along = np.array([waypoint.point.position for waypoint in waypoints]) - start
    across = (along[:, 0] * (end - start)[1] - along[:, 1] * (end - start)[0]) / np.hypot(*(end - start))
    assert np.abs(across).max() < 1e-12
    share = along[:, 0] / (end - start)[0]
    assert (np.diff(share) > 0).all()
    assert {waypoint.point.kind for waypoint in list(waypoints)[1:-1]} == {WaypointKind.PASS}
    assert distance_m(start + along[:-1], start + along[1:]).sum() == pytest.approx(distance_m(start, end)[0], rel=1e-6)


def test_over_level_ground_nothing_is_put_in() -> None:
    waypoints, _ = with_heights(points((10.0, 56.0), (10.1, 56.0)), lambda at: np.full(len(at), 120.0), RULES)
    assert [waypoint.amsl_m for waypoint in waypoints] == [180.0, 180.0]


def test_without_a_terrain_model_flat_ground_is_assumed() -> None:
    waypoints, is_flat = with_heights(points((10.0, 56.0), (10.1, 56.0)), None, RULES)
    assert is_flat
    assert [(waypoint.amsl_m, waypoint.relative_m) for waypoint in waypoints] == [(None, 60.0), (None, 60.0)]


def test_one_gap_in_the_terrain_under_the_route_makes_it_flat() -> None:
    def with_gap(positions: FloatArray) -> FloatArray:
        return np.where(np.abs(positions[:, 0] - 10.05) < 0.001, np.nan, 200.0)

    waypoints, is_flat = with_heights(points((10.0, 56.0), (10.1, 56.0)), with_gap, RULES)
    assert is_flat
    assert {waypoint.amsl_m for waypoint in waypoints} == {None}


def test_rules_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(ValueError, match="transit_agl_m"):
        FlightRules(transit_agl_m=130.0)
