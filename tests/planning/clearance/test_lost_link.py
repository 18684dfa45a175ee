"""From where a UAV that hears nothing any more would not come home."""

import math

import numpy as np
import pytest
import shapely

from inspection.geodesy import LonLat
from inspection.network.spans import spans_between
from planning.clearance.lost_link import (
    FailedReturn,
    LostLink,
    LostLinkPlan,
    ReturnTrouble,
    checked_returns,
)
from planning.clearance.surroundings import Surroundings
from planning.clearance.zone_clearance import Margins, ZoneFacts
from planning.energy.charging import ChargingStop, with_stops
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.path_cost import FlightClass
from planning.energy.performance import Performance
from planning.energy.power import power_w
from planning.rules import AT_ONCE, FlightRules
from planning.task import Task, TaskKind
from planning.trajectory.sorties import joined_sorties, timing_of_route
from planning.trajectory.timing import timing
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints

RULES = FlightRules(manoeuvres=AT_ONCE)
CALM = Conditions()
KM_DEG = 1 / 111.31949  # of longitude on the equator
GO_HOME = LostLinkPlan(LostLink.RETURN)
NOWHERE = ZoneFacts.of([], [], [])


def route(*kms, agl_m=60.0, ground_m=None, hold_s=0.0):
    """Waypoints along the equator, so many km east of the start; ground_m: of the ground under all of them."""
    points = [
        RoutePoint(LonLat(km * KM_DEG, 0.0), WaypointKind.TARGET, agl_m, target=place, task=Task(TaskKind.HOLD, hold_s))
        for place, km in enumerate(kms)
    ]
    columns = RoutePoints.of(points)
    return Waypoints(columns, None if ground_m is None else columns.agl_m + ground_m, columns.agl_m)


def returns(waypoints, clock, plan, asked, departs_s=None, **around):
    return checked_returns(
        waypoints,
        clock,
        plan,
        flying=FlightClass(asked["performance"], asked["cruise_speed_mps"]),
        conditions=asked["conditions"],
        rules=asked["rules"],
        around=Surroundings(**({"zones": NOWHERE, "margins": Margins(5.0, 10.0, 300.0, 10.0)} | around)),
        departs_s=departs_s,
    )


def checked(waypoints, plan=GO_HOME, *, performance=Performance(), conditions=CALM, **more):  # noqa: B008 (frozen)
    asked = {"cruise_speed_mps": 10.0, "performance": performance, "conditions": conditions, "rules": RULES}
    return returns(waypoints, timing(waypoints, lands=False, **asked), plan, asked, **more)


def failed(waypoints, plan=GO_HOME, **more):
    return checked(waypoints, plan, **more).failed


def box(west_km, east_km, half_km=0.1):
    return shapely.box(west_km * KM_DEG, -half_km * KM_DEG, east_km * KM_DEG, half_km * KM_DEG)


def test_who_goes_on_does_what_was_checked():
    assert failed(route(0, 100), LostLinkPlan(LostLink.GO_ON), performance=Performance(battery_wh=1.0)) == []


def test_what_was_charged_on_the_way_is_there_for_the_return():
    """20 km out take more than the battery gives; with half an hour on a tower at 10 km the way back from there is in it."""
    waypoints = route(0, 10, 12)
    asked = {"cruise_speed_mps": 10.0, "conditions": CALM, "rules": RULES}
    battery_wh = timing(waypoints, lands=True, performance=Performance(battery_wh=1_000.0), **asked).total_wh * 1.4
    performance = Performance(battery_wh=battery_wh)
    clock = timing(waypoints, lands=True, performance=performance, **asked)
    asked["performance"] = performance
    assert [one.waypoint for one in returns(waypoints, clock, GO_HOME, asked).failed] == [1, 2]
    stop = ChargingStop(place=1, charging_s=1800.0, charged_wh=0.7 * battery_wh, stopped_s=1900.0, used_wh=1.0)
    assert [one.waypoint for one in returns(waypoints, with_stops(clock, [stop], battery_wh), GO_HOME, asked).failed] == [1]


def test_between_two_flights_it_stands_at_its_base_with_a_new_battery():
    one_flight = route(0, 3, 0)
    joined = joined_sorties([one_flight, one_flight], turnaround_s=3_600.0)
    performance = Performance(battery_wh=56.6)
    asked = {"cruise_speed_mps": 10.0, "performance": performance, "conditions": CALM, "rules": RULES}
    clock = timing_of_route(joined, lands=True, **asked)
    assert returns(joined, clock, GO_HOME, asked).failed == []


def test_without_a_battery_a_zone_or_a_hill_every_return_is_a_way_home():
    assert failed(route(0, 1, 2, 30)) == []


def test_the_battery_has_to_do_for_the_straight_way_back_and_the_landing():
    """A battery that just does for the return from 2 km: 4 km there and back, up 60 m and down 60 m, as steady flight has it."""
    uav = Performance()
    flight_w, climb_w, hover_w = power_w(uav, airspeed_mps=10.0), power_w(uav, climb_mps=2.5), power_w(uav)
    needed_wh = (4_000.0 / 10.0 * flight_w + 60.0 / 2.5 * climb_w + 60.0 / 2.5 * hover_w) / 3_600.0
    enough = Performance(battery_wh=needed_wh / 0.8 * 1.002)
    assert failed(route(0, 1, 2), performance=enough) == []
    less = Performance(battery_wh=needed_wh / 0.8 * 0.99)
    [found] = failed(route(0, 1, 2), performance=less)
    assert (found.waypoint, found.return_point, found.trouble) == (2, 0, ReturnTrouble.BATTERY)
    assert found.missing_wh == pytest.approx(0.01 * needed_wh, rel=0.05)


def test_holding_first_takes_more():
    uav = Performance(battery_wh=10.0)
    hold_w = power_w(uav)
    [found] = failed(route(0, 4), performance=uav)
    plan = LostLinkPlan(LostLink.HOLD, hold_s=60.0)
    [later] = [one for one in failed(route(0, 4), plan, performance=uav) if one.waypoint == 1]
    assert later.missing_wh - found.missing_wh == pytest.approx(60.0 * hold_w / 3_600.0, rel=1e-3)
    [after_task] = [one for one in failed(route(0, 4, hold_s=60.0), performance=uav) if one.waypoint == 1]
    assert after_task.missing_wh - found.missing_wh == pytest.approx(2 * 60.0 * hold_w / 3_600.0, rel=1e-3)


def test_a_rally_point_that_is_nearer_saves_the_way_home():
    uav = Performance(battery_wh=32.0)
    far = [one.waypoint for one in failed(route(0, 2, 4), performance=uav)]
    assert far == [2]
    near = LostLinkPlan(LostLink.RETURN, (LonLat(4.5 * KM_DEG, 0.0),))
    assert failed(route(0, 2, 4), near, performance=uav) == []


def test_a_zone_on_the_straight_way_back_is_told_from_each_waypoint_beyond_it():
    zones = ZoneFacts.of([box(9, 10), box(1.2, 1.8)], [(None, "", None, "")] * 2, [None, None])
    found = failed(route(0, 1, 2, 3), zones=zones)
    assert found == [FailedReturn(place, 0, ReturnTrouble.ZONE, zone=1) for place in (2, 3)]


def test_a_zone_above_the_return_is_not_met_and_one_that_cannot_be_compared_is():
    above = [(200.0, "AGL", None, "")]
    assert failed(route(0, 1, 2), zones=ZoneFacts.of([box(1.2, 1.8)], above, [None])) == []
    above_sea = [(200.0, "AMSL", None, "")]
    assert [one.waypoint for one in failed(route(0, 1, 2), zones=ZoneFacts.of([box(1.2, 1.8)], above_sea, [None]))] == [2]


def test_a_zone_counts_at_the_time_of_the_return():
    """From 2 km it is at 1.8 km some 20 s after 224 s, when it has flown out: a zone from then on is met, one long after is not."""
    soon, later = [(1_240.0, 9_000.0)], [(2_000.0, 9_000.0)]
    band = [(None, "", None, "")]
    assert failed(route(0, 1, 2), zones=ZoneFacts.of([box(1.2, 1.8)], band, [later]), departs_s=1_000.0) == []
    assert [one.waypoint for one in failed(route(0, 1, 2), zones=ZoneFacts.of([box(1.2, 1.8)], band, [soon]), departs_s=1_000.0)] == [2]


def test_a_hill_between_has_to_be_cleared_below_the_greatest_height():
    """A ridge of 50 m between 1 and 2 km is cleared at 110 m; one of 80 m would take 140 m above the ground of the start."""

    def ridge(height_m):
        return lambda position: 400.0 + np.where((position[:, 0] > 1.2 * KM_DEG) & (position[:, 0] < 1.8 * KM_DEG), height_m, 0.0)

    waypoints = route(0, 1, 2, ground_m=400.0)
    assert failed(waypoints, ground_heights_m=ridge(50.0)) == []
    [found] = failed(waypoints, ground_heights_m=ridge(80.0))
    assert (found.waypoint, found.trouble) == (2, ReturnTrouble.TOO_HIGH)
    assert found.over_m == pytest.approx(20.0)


def test_ground_that_is_not_known_is_no_ground_to_fly_over():
    def with_a_gap(position):
        return np.where(position[:, 0] > 1.5 * KM_DEG, np.nan, 400.0)

    found = failed(route(0, 1, 2, ground_m=400.0), ground_heights_m=with_a_gap)
    assert found == [FailedReturn(2, 0, ReturnTrouble.UNKNOWN_GROUND)]


def mast(km, beside_km, height_m):
    return hung([(km, beside_km, height_m, km, beside_km, height_m)])


def hung(wires):
    """Wires from km east, km north, top [m] to the same."""
    columns = np.array(wires, dtype=np.float64)
    return spans_between(columns[:, :2] * KM_DEG, columns[:, 3:5] * KM_DEG, columns[:, 2], columns[:, 5])


def test_a_mast_beside_the_way_counts_and_one_away_from_it_does_not():
    [found] = failed(route(0, 1, 2), spans=mast(1.5, 0.02, 130.0))
    assert (found.waypoint, found.trouble, found.over_m) == (2, ReturnTrouble.OBSTACLE, pytest.approx(130.0 + 15.0 - 120.0))
    assert failed(route(0, 1, 2), spans=mast(1.5, 0.2, 130.0)) == []
    assert failed(route(0, 1, 2), spans=mast(1.5, 0.02, 90.0)) == []


def test_a_wire_far_from_both_its_towers_is_cleared_like_a_tower():
    """Between towers of 90 m the way is flown at 105 m, where a zone is that a way at 60 m would pass below; 110 m are too many."""
    aloft = ZoneFacts.of([box(0.2, 0.8)], [(90.0, "AGL", None, "")], [None])
    waypoints = route(0, 1, 2)
    assert failed(waypoints, zones=aloft) == []
    assert [one.trouble for one in failed(waypoints, zones=aloft, spans=hung([(1.5, -0.2, 90.0, 1.5, 0.2, 90.0)]))] == [ReturnTrouble.ZONE]
    [found] = failed(waypoints, spans=hung([(1.5, -0.2, 110.0, 1.5, 0.2, 110.0)]))
    assert (found.waypoint, found.trouble, found.over_m) == (2, ReturnTrouble.OBSTACLE, pytest.approx(5.0))


def test_how_high_above_its_start_a_uav_returns_is_told():
    wire = hung([(1.5, -0.2, 90.0, 1.5, 0.2, 90.0)])
    assert checked(route(0, 1, 2)).highest_m == pytest.approx(60.0)
    assert checked(route(0, 1, 2), spans=wire).highest_m == pytest.approx(105.0)
    level = {"ground_heights_m": lambda position: np.full(len(position), 400.0)}
    assert checked(route(0, 1, 2, ground_m=400.0), spans=wire, **level).highest_m == pytest.approx(105.0)
    assert checked(route(0, 1, 2), LostLinkPlan(LostLink.GO_ON), spans=wire).highest_m is None


def test_a_sloping_wire_counts_as_high_as_it_is_beside_the_way():
    """From 100 m, 190 m north of the way, up to 140 m, 210 m south of it: 30 m south of the way it is at 122 m."""
    [found] = failed(route(0, 1, 2), spans=hung([(1.5, 0.19, 100.0, 1.5, -0.21, 140.0)]))
    assert found.over_m == pytest.approx(122.0 + 15.0 - 120.0, abs=0.05)


def test_a_wire_hangs_from_the_ground_under_its_towers():
    """Both stand 60 m above the ground of the way, on hills beside it that the way itself does not cross."""

    def hills(position):
        return 400.0 + np.where(np.abs(position[:, 1]) > 0.1 * KM_DEG, 60.0, 0.0)

    waypoints = route(0, 1, 2, ground_m=400.0)
    wire = hung([(1.5, -0.2, 50.0, 1.5, 0.2, 50.0)])
    assert failed(waypoints, ground_heights_m=lambda position: np.full(len(position), 400.0), spans=wire) == []
    [found] = failed(waypoints, ground_heights_m=hills, spans=wire)
    assert (found.waypoint, found.trouble, found.over_m) == (2, ReturnTrouble.OBSTACLE, pytest.approx(5.0))


def test_a_wire_over_ground_that_is_not_known_hangs_nobody_knows_how_high():
    def known_on_the_way(position):
        return np.where(np.abs(position[:, 1]) > 0.1 * KM_DEG, np.nan, 400.0)

    waypoints = route(0, 1, 2, ground_m=400.0)
    found = failed(waypoints, ground_heights_m=known_on_the_way, spans=hung([(1.5, -0.2, 20.0, 1.5, 0.2, 20.0)]))
    assert found == [FailedReturn(2, 0, ReturnTrouble.UNKNOWN_GROUND)]


def test_against_a_wind_that_is_too_strong_nobody_comes_home():
    """Out with 10 m/s of west wind, back against it: a UAV of 10 m/s through the air has no headway."""
    wind = Conditions((WindLayer(60.0, 10.0, 270.0),))
    found = failed(route(0, 1, 2), performance=Performance(max_airspeed_mps=10.2), conditions=wind)
    assert [(one.waypoint, one.trouble) for one in found] == [(1, ReturnTrouble.WIND), (2, ReturnTrouble.WIND)]


def test_a_route_without_waypoints_needs_no_way_home():
    assert failed(route()) == []
    assert not math.isnan(sum(one.waypoint for one in failed(route(0))))
