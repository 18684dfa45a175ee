"""Heights above ground, sea level and take-off."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import LonLat, distance_m
from inspection.terrain.heights import HeightGrid
from planning.rules import FlightRules
from planning.task import Task, TaskKind
from planning.trajectory.heights import FloatArray, asset_height_m, inspection_agl_m, is_above_limit, pass_agl_m, with_heights
from planning.trajectory.waypoints import PASS, RoutePoint, RoutePoints, WaypointKind, Waypoints
from tests.planning.trajectory.posted_ground import PostedGround, ground_like, ground_of, tiled

RULES = FlightRules()


def points(*places: tuple[float, float], agl_m: float = 60.0) -> RoutePoints:
    kinds = [WaypointKind.START, *[WaypointKind.PASS] * (len(places) - 2), WaypointKind.END]
    return RoutePoints.of([RoutePoint(LonLat(*place), kind, agl_m) for place, kind in zip(places, kinds, strict=True)])


def hills_m(positions: FloatArray) -> FloatArray:
    """Hills of 120 m, 1.5 km apart."""
    return 300.0 + 60.0 * np.sin(positions[:, 0] * 2 * np.pi / 0.024) + 20.0 * np.cos(positions[:, 1] * 2 * np.pi / 0.02)


HILLS = ground_like(hills_m, 9.99, 56.03, 0.12)


def off_the_plan_m(waypoints: Waypoints, points: RoutePoints, ground: PostedGround, floor_m: FloatArray | None = None) -> FloatArray:
    """How far the flight is above the straight line between the planned heights of the points, at 300 places of every leg."""
    assert waypoints.amsl_m is not None
    floor_m = points.agl_m if floor_m is None else floor_m
    share = np.linspace(0.0, 1.0, 300)
    place, off = 0, []
    for leg in range(len(points) - 1):
        start, end = points.position[leg], points.position[leg + 1]
        first = place
        while place == first or (waypoints.points.position[place] != end).any():
            place += 1
        along = end - start
        if not along.any():
            continue
        flown_m = np.interp(
            share, (waypoints.points.position[first : place + 1] - start) @ along / (along @ along), waypoints.amsl_m[first : place + 1]
        )
        off.append(flown_m - ground.metres(start + share[:, None] * along) - floor_m[leg] - share * (floor_m[leg + 1] - floor_m[leg]))
    return np.concatenate(off)


def highest_m(waypoints: Waypoints, ground: PostedGround) -> float:
    assert waypoints.amsl_m is not None
    share = np.linspace(0.0, 1.0, 100)[:, None]
    return max(
        float((low_m + share[:, 0] * (high_m - low_m) - ground.metres(start + share * (end - start))).max())
        for start, end, low_m, high_m in zip(
            waypoints.points.position[:-1], waypoints.points.position[1:], waypoints.amsl_m[:-1], waypoints.amsl_m[1:], strict=True
        )
    )


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
    waypoints, is_flat = with_heights(points((10.0, 56.0), (10.03, 56.01), (10.06, 56.0)), HILLS.ground, RULES)
    assert not is_flat
    ground_m = HILLS.metres([waypoint.point.position for waypoint in waypoints])
    for waypoint, under_m in zip(waypoints, ground_m, strict=True):
        assert waypoint.amsl_m == pytest.approx(under_m + waypoint.point.agl_m, abs=1e-3)
        assert waypoint.relative_m == pytest.approx(waypoint.amsl_m - ground_m[0], abs=1e-3)
    assert waypoints[0].relative_m == waypoints[0].point.agl_m == 60.0


@st.composite
def flights(draw: st.DrawFn) -> tuple[PostedGround, RoutePoints]:
    """Rough ground, steps and cliffs among it, and a route over it with targets, climbs and points at one place."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    step_deg = draw(st.sampled_from([0.0003, 0.0008, 0.0025]))
    posts = random.normal(0.0, draw(st.sampled_from([0.2, 3.0, 25.0])), (40, 40)).cumsum(axis=draw(st.integers(0, 1)))
    if draw(st.booleans()):
        posts = np.round(posts / 10.0) * 10.0
    ground = PostedGround(500.0 + posts, 10.0, 56.0 + 39 * step_deg, step_deg, draw(st.sampled_from([7, 40])))
    count = draw(st.integers(2, 8))
    places = np.array([10.0, 56.0]) + 39 * step_deg * random.uniform(0.0, 1.0, (count, 2))
    if draw(st.booleans()):  # along a row of posts
        places[:, 1] = 56.0 + 20 * step_deg
    kinds, heights_m = [WaypointKind.START], [60.0]
    for place in range(1, count):
        if draw(st.integers(0, 4)) == 0:
            places[place] = places[place - 1]
        heights_m.append(draw(st.sampled_from([29.0, 60.0, 60.0, 75.0, 110.0, 120.0])))
        kinds.append(draw(st.sampled_from([WaypointKind.PASS, WaypointKind.PASS, WaypointKind.TARGET])))
    kinds[-1] = WaypointKind.END
    task = Task(TaskKind.LOOK, 5.0)
    return ground, RoutePoints.of(
        [
            RoutePoint(LonLat(*place), kind, height_m, task=task if kind == WaypointKind.TARGET else None)
            for place, kind, height_m in zip(places.tolist(), kinds, heights_m, strict=True)
        ]
    )


@given(flights())
def test_a_planned_height_is_a_floor_on_the_whole_leg_and_the_tolerance_and_the_limit_are_kept(
    flight: tuple[PostedGround, RoutePoints],
) -> None:
    ground, drawn = flight
    waypoints, is_flat = with_heights(drawn, ground.ground, RULES)
    assert not is_flat
    off_m = off_the_plan_m(waypoints, drawn, ground) if (np.diff(drawn.position, axis=0) != 0).any() else np.zeros(1)
    assert off_m.min() > -0.5
    assert off_m.max() < RULES.terrain_tolerance_m
    assert highest_m(waypoints, ground) < RULES.max_agl_m + 0.05
    own = [place for place, waypoint in enumerate(waypoints) if (drawn.position == waypoint.point.position).all(axis=1).any()]
    assert (waypoints.points.agl_m[own] >= min(drawn.agl_m) - 1e-3).all()
    assert waypoints.points.agl_m[[0, -1]].tolist() == pytest.approx(drawn.agl_m[[0, -1]].tolist())
    targets = drawn.agl_m[drawn.kind != PASS]
    assert waypoints.points.agl_m[waypoints.points.kind != PASS].tolist() == pytest.approx(targets.tolist())


@given(flights(), st.data())
def test_points_with_a_floor_of_their_own_are_flown_as_they_are(flight: tuple[PostedGround, RoutePoints], data: st.DataObject) -> None:
    ground, drawn = flight
    floors_m = drawn.agl_m - np.array([data.draw(st.sampled_from([0.0, 9.0])) for _ in range(len(drawn))])
    waypoints, _is_flat = with_heights(drawn, ground.ground, RULES, floors_m)
    kept = iter(zip(waypoints.points.position.tolist(), waypoints.points.agl_m.tolist(), strict=True))
    for position, agl_m in zip(drawn.position.tolist(), drawn.agl_m.tolist(), strict=True):
        assert any(other == position and height_m == agl_m for other, height_m in kept)
    if (np.diff(drawn.position, axis=0) != 0).any():
        assert off_the_plan_m(waypoints, drawn, ground, floors_m).min() > -0.5


@given(flights())
def test_what_was_drawn_stays_as_it_is_when_it_is_drawn_again_over_its_lowest_height(flight: tuple[PostedGround, RoutePoints]) -> None:
    ground, drawn = flight
    waypoints, _is_flat = with_heights(drawn, ground.ground, RULES)
    floors_m = np.minimum(waypoints.points.agl_m, drawn.agl_m.min())
    again, _is_flat = with_heights(waypoints.points, ground.ground, RULES, floors_m)
    assert len(again) == len(waypoints)


def test_points_are_put_in_on_the_straight_line_between_two_waypoints() -> None:
    start, end = np.array([10.0, 56.0]), np.array([10.05, 56.02])
    waypoints, _ = with_heights(points(tuple(start), tuple(end)), HILLS.ground, RULES)
    along = np.array([waypoint.point.position for waypoint in waypoints]) - start
    across = (along[:, 0] * (end - start)[1] - along[:, 1] * (end - start)[0]) / np.hypot(*(end - start))
    assert np.abs(across).max() < 1e-12
    share = along[:, 0] / (end - start)[0]
    assert (np.diff(share) > 0).all()
    assert {waypoint.point.kind for waypoint in list(waypoints)[1:-1]} == {WaypointKind.PASS}
    assert distance_m(start + along[:-1], start + along[1:]).sum() == pytest.approx(distance_m(start, end)[0], rel=1e-6)
    assert 4 < len(waypoints) < 12


def test_over_level_ground_nothing_is_put_in_and_nothing_is_flown_higher() -> None:
    level = ground_like(lambda at: np.full(len(at), 120.0), 9.99, 56.03, 0.12)
    waypoints, _ = with_heights(points((10.0, 56.0), (10.05, 56.0), (10.1, 56.0)), level.ground, RULES)
    assert [waypoint.amsl_m for waypoint in waypoints] == pytest.approx([180.0, 180.0, 180.0])


def test_where_one_model_ends_at_another_the_step_between_them_is_held_on_both_sides() -> None:
    """A fine tile 40 m above the coarse model around it: the route goes straight up before it and down behind it."""
    coarse = HeightGrid(10.0, 56.01, 0.01, 0.01, np.full((3, 3), 100.0, dtype=np.float32))
    fine = HeightGrid(10.0061, 56.006, 0.001, 0.001, np.full((7, 7), 140.0, dtype=np.float32))
    ground = ground_of(tiled([fine, coarse]))
    waypoints, _ = with_heights(points((10.001, 56.003), (10.019, 56.003)), ground, RULES)
    assert waypoints.amsl_m is not None
    share = np.linspace(0.0, 1.0, 500)[:, None]
    for place in range(len(waypoints) - 1):
        at = waypoints.points.position[place] + share * (waypoints.points.position[place + 1] - waypoints.points.position[place])
        over_m = np.linspace(*waypoints.amsl_m[place : place + 2], 500) - np.where(
            (at[:, 0] > 10.0061) & (at[:, 0] < 10.0121), 140.0, 100.0
        )
        assert over_m[1:-1].min() >= 59.5
        if (waypoints.points.position[place] != waypoints.points.position[place + 1]).any():
            assert over_m[1:-1].max() <= 70.0
    assert len(waypoints) <= 6


def test_without_a_terrain_model_flat_ground_is_assumed() -> None:
    waypoints, is_flat = with_heights(points((10.0, 56.0), (10.1, 56.0)), None, RULES)
    assert is_flat
    assert [(waypoint.amsl_m, waypoint.relative_m) for waypoint in waypoints] == [(None, 60.0), (None, 60.0)]


def test_one_gap_in_the_terrain_under_the_route_makes_it_flat() -> None:
    gap = ground_like(lambda at: np.where(np.abs(at[:, 0] - 10.05) < 0.0006, np.nan, 200.0), 9.99, 56.03, 0.12)
    waypoints, is_flat = with_heights(points((10.0, 56.0), (10.1, 56.0)), gap.ground, RULES)
    assert is_flat
    assert {waypoint.amsl_m for waypoint in waypoints} == {None}


def test_rules_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(ValueError, match="transit_agl_m"):
        FlightRules(transit_agl_m=130.0)
