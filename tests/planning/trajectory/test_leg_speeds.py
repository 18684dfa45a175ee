"""Speeds over single legs: what they cost in time and battery, which can be flown, and that divided legs keep them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.energy.conditions import Conditions, WindLayer
from planning.energy.performance import Performance
from planning.energy.power import power_w
from planning.trajectory.leg_speeds import SpeedRange, speeds_out_of_range
from planning.trajectory.route_points import with_short_legs
from planning.trajectory.sorties import joined_sorties, timing_of_route
from planning.trajectory.waypoints import RoutePoints, Waypoints
from tests.planning.trajectory.test_timing import CALM, IRIS, RULES, flown, route

EASTERLY = Conditions((WindLayer(10, 5, 90),))
LIMITED = Performance(battery_wh=56.6, max_airspeed_mps=13)


def at_speeds(waypoints: Waypoints, speed_mps: dict[int, float]) -> Waypoints:
    points = waypoints.points
    columns = points.position, points.agl_m, points.kind, points.asset, points.target, points.task
    return Waypoints(RoutePoints(*columns, speed_mps), waypoints.amsl_m, waypoints.relative_m)


@pytest.mark.long
def test_one_leg_at_half_the_speed_is_reached_so_much_later_and_paid_with_its_own_power() -> None:
    """50 m up at 2.5 m/s; 1,000 m at 5 instead of 10 m/s; 1,000 m at 10 m/s."""
    stops = (0, 0, 50, 0), (1000, 0, 50, 0), (2000, 0, 50, 0)
    slow = flown(at_speeds(route(*stops), {1: 5.0}))
    assert slow.arrival_s == pytest.approx([20, 220, 320], abs=0.02)
    powers_w = power_w(IRIS, climb_mps=2.5), power_w(IRIS, airspeed_mps=5), power_w(IRIS, airspeed_mps=10)
    assert slow.used_wh == pytest.approx(np.cumsum(np.array([20, 200, 100]) * powers_w) / 3600, rel=1e-3)


@pytest.mark.long
def test_the_uavs_own_speed_over_every_leg_changes_nothing() -> None:
    plain = route((0, 0, 50, 0), (1000, 0, 80, 5), (1000, 900, 60, 0))
    same = flown(at_speeds(plain, {1: 10.0, 2: 10.0}), EASTERLY)
    assert same.arrival_s.tolist() == flown(plain, EASTERLY).arrival_s.tolist()
    assert same.total_wh == flown(plain, EASTERLY).total_wh


@pytest.mark.parametrize(("east_m", "least_mps", "most_mps"), [(1000.0, 0.5, 8.0), (-1000.0, 0.5, 18.0)])
def test_against_the_wind_less_can_be_flown_and_with_it_more(east_m: float, least_mps: float, most_mps: float) -> None:
    """13 m/s through the air, 5 m/s of wind from the east."""
    legs = route((0, 0, 50, 0), (east_m, 0, 50, 0))

    def found(speed_mps: float) -> dict[int, SpeedRange]:
        return speeds_out_of_range(at_speeds(legs, {1: speed_mps}), cruise_speed_mps=10, performance=LIMITED, conditions=EASTERLY)

    assert found(most_mps - 0.01) == {}
    assert found(most_mps + 0.01)[1] == pytest.approx((least_mps, most_mps), abs=1e-3)
    assert set(found(0.4)) == {1}


def test_a_wind_that_pushes_leaves_no_slow_speed() -> None:
    """10 m/s through the air and 9 m/s of wind across, 4 with it: what is left is within 4.36 m/s of 4."""
    wind = Conditions((WindLayer(10, float(np.hypot(9, 4)), float(np.degrees(np.arctan2(-4, 9)) % 360)),))
    legs = at_speeds(route((0, 0, 50, 0), (1000, 0, 50, 0)), {1: 9.0})
    own = speeds_out_of_range(legs, cruise_speed_mps=10, performance=Performance(max_airspeed_mps=10), conditions=wind)[1]
    assert own == pytest.approx((0.5, 4 + 19**0.5), abs=1e-3)


def test_without_a_top_airspeed_nothing_above_the_cruising_speed_is_known_to_be_flown() -> None:
    legs = route((0, 0, 50, 0), (1000, 0, 50, 0))
    for speed_mps, is_fine in ((10.0, True), (10.1, False)):
        found = speeds_out_of_range(at_speeds(legs, {1: speed_mps}), cruise_speed_mps=10, performance=IRIS, conditions=CALM)
        assert (found == {}) is is_fine


@settings(max_examples=40)
@given(speed_mps=st.floats(1, 18), wind_mps=st.floats(0, 10), from_deg=st.floats(0, 359), north_m=st.floats(-900, 900))
def test_what_is_in_range_is_flown_at_that_speed(speed_mps: float, wind_mps: float, from_deg: float, north_m: float) -> None:
    wind = Conditions((WindLayer(10, wind_mps, from_deg),))
    legs = at_speeds(route((0, 0, 50, 0), (1000, north_m, 50, 0)), {1: speed_mps})
    if speeds_out_of_range(legs, cruise_speed_mps=10, performance=LIMITED, conditions=wind):
        return
    arrival_s = flown(legs, wind, LIMITED).arrival_s
    assert arrival_s[1] - arrival_s[0] == pytest.approx(np.hypot(1000, north_m) / speed_mps, rel=1e-4)


def test_a_divided_leg_keeps_its_speed_in_every_part() -> None:
    whole = at_speeds(route((0, 0, 50, 0), (2500, 0, 50, 0), (2500, 400, 50, 0), (4000, 400, 50, 0)), {1: 6.0, 3: 8.0})
    divided, _length_m = with_short_legs(whole.points, 900)
    assert divided.speed_mps == {1: 6.0, 2: 6.0, 3: 6.0, 5: 8.0, 6: 8.0}
    again = flown(Waypoints(divided, None, divided.agl_m))
    assert again.total_s == pytest.approx(flown(whole).total_s, rel=1e-6)


def test_the_second_of_two_flights_keeps_its_speed() -> None:
    one, other = route((0, 0, 50, 0), (1000, 0, 50, 0)), route((0, 0, 50, 0), (1000, 0, 50, 0))
    joined = joined_sorties([one, at_speeds(other, {1: 5.0})], 60.0)
    assert joined.points.speed_mps == {4: 5.0}
    clock = timing_of_route(joined, cruise_speed_mps=10, performance=IRIS, conditions=CALM, lands=True, rules=RULES)
    assert clock.arrival_s[4] - clock.arrival_s[3] == pytest.approx(200, abs=0.1)
