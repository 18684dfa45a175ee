"""Tall things beside a route: it rises over them, and nothing else changes."""

import numpy as np
import pytest

from inspection.geodesy import LonLat
from missions.flight_plan.obstacles import TallThings, legs_too_low, rising_over
from missions.flight_plan.waypoints import RoutePoint, RoutePoints, WaypointKind

HERE = 56.0
METRE_DEG = 1.0 / 111_320.0  # of latitude, about


def route(*agl_m: float) -> RoutePoints:
    """Points 400 m apart to the north."""
    return RoutePoints.of(
        [RoutePoint(LonLat(10.0, HERE + 400 * METRE_DEG * n), WaypointKind.PASS, height) for n, height in enumerate(agl_m)]
    )


def thing(north_m: float, east_m: float, least_agl_m: float) -> TallThings:
    lon = 10.0 + east_m * METRE_DEG / np.cos(np.radians(HERE))
    return TallThings(np.array([[lon, HERE + north_m * METRE_DEG]]), np.array([least_agl_m]))


def test_a_leg_rises_over_what_stands_beside_it() -> None:
    flown = rising_over(route(60.0, 60.0), thing(100.0, 10.0, 95.0))
    assert flown.agl_m.tolist() == [60.0, 95.0, 60.0]
    assert flown.position[1] == pytest.approx([10.0, HERE + 100 * METRE_DEG], abs=2e-6)


def test_what_is_high_enough_or_far_enough_away_changes_nothing() -> None:
    points = route(60.0, 100.0, 60.0)
    for other in (thing(400.0, 10.0, 99.0), thing(100.0, 30.0, 95.0), thing(-50.0, 0.0, 95.0)):
        assert rising_over(points, other) is points


def test_it_rises_over_several_in_their_order() -> None:
    things = TallThings(np.concatenate([thing(300.0, 0.0, 80.0).position, thing(100.0, 5.0, 90.0).position]), np.array([80.0, 90.0]))
    flown = rising_over(route(60.0, 60.0, 60.0), things)
    assert flown.agl_m.tolist() == [60.0, 90.0, 80.0, 60.0, 60.0]
    assert legs_too_low(flown, things) == []
