"""Charging on towers on the way."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.energy.charging import CannotCharge, ChargerTooWeak, ChargingStop, charging_stops, places_over, with_stops
from planning.energy.conditions import Conditions
from planning.energy.performance import Performance
from planning.energy.power import power_w
from planning.rules import AT_ONCE, FlightRules
from planning.trajectory.timing import Timing, timing
from planning.trajectory.waypoints import NONE, Waypoints
from tests.planning.trajectory.test_timing import route

RULES = FlightRules(manoeuvres=AT_ONCE)
IRIS = Performance(battery_wh=50, reserve_percent=20)  # 40 Wh may be used
CALM = Conditions()
UP_WH = 6 * power_w(IRIS, climb_mps=2.5) / 3600  # over the 15 m of clearance
DOWN_WH = 6 * power_w(IRIS) / 3600
ROUNDING_WH = 1e-2  # between the formula and its table


def line(towers: int, *, metres: float = 1000.0) -> Waypoints:
    return route(*((metres * tower, 0.0, 60.0, 0.0) for tower in range(towers)))


def clock_of(waypoints: Waypoints, performance: Performance = IRIS) -> Timing:
    return timing(waypoints, cruise_speed_mps=10, performance=performance, conditions=CALM, lands=True, rules=RULES)


def stops_of(
    waypoints: Waypoints, towers: list[int], charging_w: float = 200.0, performance: Performance = IRIS
) -> tuple[ChargingStop, ...]:
    clock = clock_of(waypoints, performance)
    tops_m = [45.0] * len(towers)
    return charging_stops(
        waypoints, clock, towers=towers, tops_m=tops_m, charging_w=charging_w, performance=performance, conditions=CALM, rules=RULES
    )


def test_a_route_within_the_battery_needs_no_stop() -> None:
    assert stops_of(line(6), list(range(6))) == ()


def test_one_stop_charges_what_is_missing_and_the_way_to_the_tower() -> None:
    """Some 47 Wh over 9 km with 40 to use; the stop is where a full battery would last longest: as late as can be."""
    waypoints = line(10)
    clock = clock_of(waypoints)
    (stop,) = stops_of(waypoints, list(range(10)))
    assert clock.used_wh is not None
    assert clock.total_wh is not None
    assert clock.used_wh[stop.place] < 40 < clock.used_wh[stop.place + 1]
    assert stop.charged_wh == pytest.approx(clock.total_wh - 40 + UP_WH + DOWN_WH, rel=1e-3)
    assert stop.charging_s == pytest.approx(stop.charged_wh * 3600 / (200 - 8))
    assert stop.stopped_s == pytest.approx(stop.charging_s + 12)


def test_after_its_stop_a_route_is_later_and_ends_with_its_reserve() -> None:
    waypoints = line(10)
    clock = clock_of(waypoints)
    (stop,) = stops = stops_of(waypoints, list(range(10)))
    charged = with_stops(clock, stops, 50.0)
    assert charged.end_percent == pytest.approx(20.0)
    assert charged.arrival_s[: stop.place + 1] == pytest.approx(clock.arrival_s[: stop.place + 1])
    assert charged.arrival_s[stop.place + 1 :] - clock.arrival_s[stop.place + 1 :] == pytest.approx(stop.stopped_s)
    assert charged.total_s == pytest.approx(clock.total_s + stop.stopped_s)
    assert charged.total_wh == pytest.approx((clock.total_wh or 0) + stop.used_wh)


def test_towers_too_far_apart_are_named_with_what_is_missing() -> None:
    """Towers at the start and 12 km away: from the first no battery lasts to the second."""
    waypoints = line(15)
    clock = clock_of(waypoints)
    with pytest.raises(CannotCharge) as raised:
        stops_of(waypoints, [1, 13])
    assert (raised.value.start, raised.value.end) == (1, 13)
    assert clock.used_wh is not None
    assert raised.value.missing_wh == pytest.approx(clock.used_wh[13] - clock.used_wh[1] + UP_WH + DOWN_WH - 40, rel=1e-3)


def test_without_a_tower_the_way_to_the_end_is_too_far() -> None:
    with pytest.raises(CannotCharge) as raised:
        stops_of(line(15), [])
    assert (raised.value.start, raised.value.end) == (-1, 15)


def test_a_charger_weaker_than_what_stands_by_it_is_refused() -> None:
    with pytest.raises(ChargerTooWeak) as raised:
        stops_of(line(15), list(range(15)), charging_w=8.0)
    assert raised.value.missing_wh == pytest.approx((clock_of(line(15)).total_wh or 0) - 40)


def test_a_uav_whose_battery_is_not_known_never_stops() -> None:
    assert stops_of(line(15), list(range(15)), performance=Performance()) == ()


@given(st.lists(st.integers(200, 4000), min_size=2, max_size=14), st.data(), st.sampled_from([50.0, 400.0]))
def test_the_battery_never_falls_below_its_reserve_nor_rises_above_full(steps: list[int], data: st.DataObject, charging_w: float) -> None:
    east_m = np.cumsum([0, *steps]).tolist()
    waypoints = route(*((float(metres), 0.0, 60.0, 0.0) for metres in east_m))
    towers = sorted(data.draw(st.sets(st.integers(0, len(east_m) - 1))))
    clock = clock_of(waypoints)
    try:
        stops = stops_of(waypoints, towers, charging_w)
    except CannotCharge as error:
        assert fewest_stops(clock, towers, 40 - ROUNDING_WH) is None
        assert fewest_stops(clock, towers, 40 + error.missing_wh + ROUNDING_WH) is not None or isinstance(error, ChargerTooWeak)
        assert fewest_stops(clock, towers, 40 + error.missing_wh - ROUNDING_WH) is None
        return
    assert len(stops) in {fewest_stops(clock, towers, 40 + rounding_wh) for rounding_wh in (-ROUNDING_WH, ROUNDING_WH)}
    assert {stop.place for stop in stops} <= set(towers)
    charged = with_stops(clock, stops, 50.0)
    assert charged.battery_left_percent is not None
    assert charged.end_percent is not None
    assert (charged.battery_left_percent >= 20.0 - 1e-6).all()
    assert charged.end_percent >= 20.0 - 1e-6
    for stop in stops:
        on_arrival_wh = charged.battery_left_percent[stop.place] / 2
        assert on_arrival_wh - DOWN_WH >= 10 - 1e-3
        assert on_arrival_wh - DOWN_WH + stop.charged_wh <= 50 + 1e-3
        assert stop.charged_wh > 0


def fewest_stops(clock: Timing, towers: list[int], usable_wh: float) -> int | None:
    """By trying all sets of towers, each with a full battery after it."""
    assert clock.used_wh is not None
    assert clock.total_wh is not None
    for count in range(len(towers) + 1):
        for chosen in combinations(towers, count):
            marks = [(0.0, 0.0, 0.0), *((clock.used_wh[tower], DOWN_WH, UP_WH) for tower in chosen), (clock.total_wh, 0.0, 0.0)]
            if all(there[0] + there[1] - here[0] + here[2] <= usable_wh for here, there in pairwise(marks)):
                return count
    return None


def test_the_places_over_towers_are_those_of_their_assets() -> None:
    points = line(4).points
    points.asset[:] = [7, NONE, 9, 7]
    assert places_over(points, {7, 8}) == [0, 3]
    assert places_over(points, set()) == []
