"""Arrival and battery at each waypoint."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import LonLat, path_length_m
from inspection.geodesy.local_frame import LocalFrame, short_vector_m
from inspection.geodesy.wgs84 import WGS84
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.performance import Performance
from planning.energy.power import NoHeadway, power_w
from planning.rules import AT_ONCE, FlightRules
from planning.task import Task, TaskKind
from planning.trajectory.timing import Timing, timing
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints

RULES = FlightRules(climb_speed_mps=2.5, manoeuvres=AT_ONCE)  # of what can be worked out by hand
CALM = Conditions()
IRIS = Performance(battery_wh=56.6)
FRAME = LocalFrame.around(9.0, 47.0)
Stop = tuple[float, float, float, float]  # metres east and north, height above ground, seconds held


def route(*stops: Stop, amsl_m: float | None = None) -> Waypoints:
    points = []
    for east_m, north_m, agl_m, hold_s in stops:
        place = LonLat(*FRAME.to_degrees(np.array([[east_m, north_m]]))[0].tolist())
        points.append(RoutePoint(place, WaypointKind.PASS, agl_m, task=Task(TaskKind.HOLD, hold_s) if hold_s else None))
    heights_m = np.array([stop[2] for stop in stops])
    return Waypoints(RoutePoints.of(points), None if amsl_m is None else heights_m + amsl_m, heights_m)


def flown(
    waypoints: Waypoints,
    conditions: Conditions = CALM,
    performance: Performance = IRIS,
    *,
    speed_mps: float = 10,
    lands: bool = True,
    rules: FlightRules = RULES,
) -> Timing:
    return timing(waypoints, cruise_speed_mps=speed_mps, performance=performance, conditions=conditions, lands=lands, rules=rules)


def test_a_waypoint_is_reached_after_climb_and_flight_and_left_after_its_hold() -> None:
    """50 m up at 2.5 m/s; 1,000 m at 10 m/s, held for 30 s; 25 m down; then 25 m to the ground."""
    found = flown(route((0, 0, 50, 0), (1000, 0, 50, 30), (1000, 0, 25, 0)))
    assert found.arrival_s == pytest.approx([20, 120, 160], abs=0.01)
    assert found.total_s == pytest.approx(170, abs=0.01)


def test_each_part_is_paid_with_its_own_power() -> None:
    found = flown(route((0, 0, 50, 0), (1000, 0, 50, 30), (1000, 0, 25, 0)))
    up, level, hover = power_w(IRIS, climb_mps=2.5), power_w(IRIS, airspeed_mps=10), power_w(IRIS)
    used_wh = np.cumsum([20 * up, 100 * level, 40 * hover]) / 3600
    assert found.used_wh == pytest.approx(used_wh, rel=1e-3)
    assert found.total_wh == pytest.approx(used_wh[-1] + 10 * hover / 3600, rel=1e-3)
    assert found.battery_left_percent == pytest.approx(100 - used_wh / 56.6 * 100, abs=0.01)
    assert found.end_percent == pytest.approx(100 - (found.total_wh or 0) / 56.6 * 100)


def test_a_uav_with_mass_takes_its_time_to_lift_to_stop_and_to_touch_down() -> None:
    """At 10 m/s and 2 m/s2 slowing down and speeding up cost 2.5 s each; 1.5 s to lift off and to settle; 8 m at 0.7 instead of 2.5 m/s."""
    at_once = flown(route((0, 0, 50, 0), (1000, 0, 50, 30), (1000, 900, 50, 0)))
    slow = flown(route((0, 0, 50, 0), (1000, 0, 50, 30), (1000, 900, 50, 0)), rules=FlightRules())
    assert slow.arrival_s - at_once.arrival_s == pytest.approx([4.0, 6.5, 10.5], abs=0.01)
    more_s = 10.5 + 4.0 + 8 / 0.7 - 8 / 2.5
    assert slow.total_s - at_once.total_s == pytest.approx(more_s, abs=0.01)
    assert (slow.total_wh or 0) - (at_once.total_wh or 0) == pytest.approx(more_s * power_w(IRIS) / 3600, rel=1e-3)


def test_a_battery_that_does_not_suffice_falls_below_nothing() -> None:
    found = flown(route((0, 0, 50, 0), (1000, 0, 50, 3600)))
    assert found.end_percent is not None
    assert found.end_percent < 0


def test_without_a_battery_there_are_seconds_alone() -> None:
    found = flown(route((0, 0, 50, 0), (1000, 0, 50, 30)), performance=Performance())
    assert (found.used_wh, found.battery_left_percent, found.total_wh, found.end_percent) == (None, None, None, None)
    assert found.total_s == pytest.approx(flown(route((0, 0, 50, 0), (1000, 0, 50, 30))).total_s)


def test_an_unused_uav_takes_nothing() -> None:
    found = flown(route())
    assert (found.total_s, found.total_wh, found.end_percent) == (0, 0, 100)


def test_the_way_against_the_wind_takes_longer_than_the_way_back() -> None:
    """10 m/s wanted, 11 m/s through the air at most, 5 m/s from the east: 6 m/s there, 10 m/s back."""
    windy = Conditions((WindLayer(10, 5, 90),))
    found = flown(route((0, 0, 50, 0), (600, 0, 50, 0), (0, 0, 50, 0)), windy, Performance(max_airspeed_mps=11))
    assert np.diff(found.arrival_s) == pytest.approx([100, 60], abs=0.01)


def test_the_wind_is_that_of_the_legs_middle_height() -> None:
    """Still at the ground, 8 m/s from the east at 80 m: 2 m/s at 20 m."""
    windy = Conditions((WindLayer(0, 0, 90), WindLayer(80, 8, 90)))
    found = flown(route((0, 0, 20, 0), (700, 0, 20, 0)), windy, Performance(max_airspeed_mps=9))
    assert np.diff(found.arrival_s) == pytest.approx([100], abs=0.01)


def test_a_hover_in_wind_is_flight_through_the_air() -> None:
    fast = replace(IRIS, max_airspeed_mps=15)
    still, windy = (flown(route((0, 0, 50, 1000)), Conditions((WindLayer(10, speed_mps, 0),)), fast) for speed_mps in (0, 12))
    assert still.used_wh is not None
    assert windy.total_wh == pytest.approx(
        (20 * power_w(fast, airspeed_mps=12, climb_mps=2.5) + 1020 * power_w(fast, airspeed_mps=12)) / 3600, rel=1e-3
    )


def test_a_slope_takes_the_longer_of_its_way_and_its_rise() -> None:
    """At 10 m/s and 2.5 m/s: 100 m up over 1,000 m and over 100 m, and down again."""
    gentle, steep = (np.diff(flown(route((0, 0, 20, 0), (far_m, 0, 120, 0), (0, 0, 20, 0))).arrival_s) for far_m in (1000, 100))
    assert gentle == pytest.approx([100, 100], abs=0.01)
    assert steep == pytest.approx([40, 40], abs=0.01)


@given(st.floats(20, 3000), st.floats(5, 100), st.floats(4, 11))
def test_a_slope_takes_no_less_than_the_power_of_its_flight(far_m: float, rise_m: float, speed_mps: float) -> None:
    """Worked out for steady flight along the slope, as fast as its way and its rise allow. It is up to a tenth more."""
    found = flown(route((0, 0, 10, 0), (far_m, 0, 10 + rise_m, 0), (2 * far_m, 0, 10, 0)), speed_mps=speed_mps)
    assert found.used_wh is not None
    leg_s = max(far_m / speed_mps, rise_m / 2.5)
    least_wh = [leg_s * power_w(IRIS, airspeed_mps=far_m / leg_s, climb_mps=climb_mps) / 3600 for climb_mps in (rise_m / leg_s, 0.0)]
    up_wh, down_wh = np.diff(found.used_wh)
    assert 0.99 * least_wh[0] <= up_wh <= 1.1 * least_wh[0]
    assert 0.99 * least_wh[1] <= down_wh <= 1.1 * least_wh[1]


@pytest.mark.long
def test_thin_air_takes_more_of_the_battery() -> None:
    stops = (0, 0, 50, 300), (1000, 0, 50, 300)
    low, high = flown(route(*stops, amsl_m=0)), flown(route(*stops, amsl_m=2000))
    assert (high.total_wh or 0) > 1.05 * (low.total_wh or 0)


def test_a_leg_that_the_wind_keeps_it_from_is_named() -> None:
    windy = Conditions((WindLayer(10, 9, 0),))
    with pytest.raises(NoHeadway) as raised:
        flown(route((0, 0, 50, 0), (0, -500, 50, 0), (0, 500, 50, 0)), windy, Performance(max_airspeed_mps=9.2))
    assert raised.value.leg == 2


def test_a_wind_in_which_it_cannot_stay_ends_the_plan_at_its_start() -> None:
    with pytest.raises(NoHeadway) as raised:
        flown(route((0, 0, 50, 0), (0, -500, 50, 0)), Conditions((WindLayer(10, 12, 0),)), Performance(max_airspeed_mps=11))
    assert raised.value.leg == 0


metres, heights, holds = st.floats(-2000, 2000), st.floats(0, 120), st.sampled_from([0.0, 0.0, 5.0, 60.0])
stops = st.lists(st.tuples(metres, metres, heights, holds), min_size=1, max_size=8)


def duration_s(waypoints: Waypoints, *, cruise_speed_mps: float, lands: bool) -> float:
    """Of each leg its level flight or its metres up or down, whichever takes longer; both columns, and every hold."""
    relative_m, agl_m = waypoints.relative_m, waypoints.points.agl_m
    legs_m = [path_length_m(np.array(leg)) for leg in pairwise(waypoints.points.position)]
    level_s = np.array(legs_m) / cruise_speed_mps
    columns_m = agl_m[0] + (agl_m[-1] if lands else 0.0)
    hold_s = sum(task.hold_s for task in waypoints.points.task.values())
    legs_s = np.maximum(level_s, np.abs(np.diff(relative_m)) / RULES.climb_speed_mps).sum()
    return float(legs_s + columns_m / RULES.climb_speed_mps + hold_s)


@given(stops, st.booleans(), st.floats(1, 20))
def test_in_calm_air_it_takes_its_level_flight_its_climbs_and_its_holds(some: list[Stop], lands: bool, speed_mps: float) -> None:
    waypoints = route(*some)
    counted_s = duration_s(waypoints, cruise_speed_mps=speed_mps, lands=lands)
    assert flown(waypoints, speed_mps=speed_mps, lands=lands).total_s == pytest.approx(counted_s, abs=0.01, rel=1e-6)


@given(stops, st.floats(0, 9), st.floats(0, 360, exclude_max=True))
def test_time_and_energy_only_grow_along_a_route(some: list[Stop], wind_mps: float, from_deg: float) -> None:
    found = flown(route(*some), Conditions((WindLayer(10, wind_mps, from_deg),)), Performance(battery_wh=50, max_airspeed_mps=11))
    assert found.used_wh is not None
    assert (np.diff(found.arrival_s) >= 0).all()
    assert (np.diff(found.used_wh) >= 0).all()
    assert found.total_s >= found.arrival_s[-1]
    assert (found.total_wh or 0) >= found.used_wh[-1]


@given(stops, st.floats(0.1, 9), st.floats(0, 360, exclude_max=True))
def test_no_wind_makes_a_round_trip_quicker(some: list[Stop], wind_mps: float, from_deg: float) -> None:
    performance = Performance(max_airspeed_mps=11)
    calm, windy = (
        flown(route(*some), Conditions((WindLayer(10, speed_mps, from_deg),)), performance).total_s for speed_mps in (0.0, wind_mps)
    )
    assert windy >= calm - 1e-6


@given(st.floats(-80, 70), st.floats(-2000, 2000), st.floats(-2000, 2000))
def test_a_short_vector_has_the_geodesics_length_and_direction(lat: float, east_m: float, north_m: float) -> None:
    lon, to_lat = WGS84.fwd(10.0, lat, math.degrees(math.atan2(east_m, north_m)), math.hypot(east_m, north_m))[:2]
    azimuth_deg, _, length_m = WGS84.inv(10.0, lat, lon, to_lat)
    found = short_vector_m(10.0, lat, lon, to_lat)
    assert math.hypot(*found) == pytest.approx(length_m, rel=1e-6, abs=1e-6)
    if length_m > 1:
        turned_deg = (math.degrees(math.atan2(*found)) - azimuth_deg + 180) % 360 - 180
        assert abs(turned_deg) < 0.1
