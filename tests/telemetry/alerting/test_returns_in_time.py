"""Returns of several UAVs: where they come near each other, and by which waits they do not."""

import math
from dataclasses import replace

import numpy as np
import pytest

from inspection.geodesy import LonLat
from planning.rules import SeparationRules
from planning.separation.separation import TimedRoute, conflicts
from telemetry.alerting.returns_in_time import WAITS_S, StraightReturn, chosen_apart, flying_on, staying

RULES = SeparationRules(lateral_m=30.0, vertical_m=15.0, time_s=30.0)
EAST = LonLat(10.010, 56.0)
NORTH_DEG = 1.0 / 111_320.0


def returning(name: str, lat_m: float = 0.0, *, goal_m: float = 0.0, height_m: float = 50.0) -> StraightReturn:
    """From 620 m east of the goal, so many metres to the north, at its height already."""
    return StraightReturn(
        name, LonLat(EAST.lon, EAST.lat + lat_m * NORTH_DEG), height_m, LonLat(10.0, 56.0 + goal_m * NORTH_DEG), height_m, 0.0, 10.0
    )


def waits(returns: list[StraightReturn], fixed: list[TimedRoute], most_s: list[float]) -> list[float | None]:
    """Seconds that each waits, as far as it may; None where no wait helps."""
    tried = [[wait_s for wait_s in WAITS_S if wait_s <= longest_s] for longest_s in most_s]
    choices = [[one.after(wait_s) for wait_s in own] for one, own in zip(returns, tried, strict=True)]
    chosen = chosen_apart(choices, fixed, RULES, [one.after(0.0) for one in returns])
    return [None if place is None else own[place] for place, own in zip(chosen, tried, strict=True)]


def test_a_return_takes_its_climb_its_way_and_its_descent():
    one = replace(returning("Tern"), height_m=25.0)
    assert one.duration_s() == pytest.approx(25.0 / 2.5 + 62.4 + 50.0, abs=0.2)
    route = one.after(40.0)
    assert route.lands_s == pytest.approx(40.0 + one.duration_s())
    assert route.height_m.tolist() == [25.0, 50.0, 50.0]


def test_returns_whose_ways_cross_at_one_height_meet_and_those_in_layers_do_not():
    one, other = returning("Tern", goal_m=200.0), returning("Kite", 200.0)
    (met,) = conflicts([one.after(0.0), other.after(0.0)], rules=RULES)
    assert met.uavs == ("Tern", "Kite") and met.metres < 30.0
    higher = replace(other, height_m=70.0, level_m=70.0)
    assert conflicts([one.after(0.0), higher.after(0.0)], rules=RULES) == ()


def test_waits_keep_returns_to_one_place_apart_and_the_first_does_not_wait():
    returns = [returning("Tern"), returning("Kite", 200.0), returning("Swift", 400.0)]
    assert len(conflicts([one.after(0.0) for one in returns], rules=RULES)) == 3
    seconds = waits(returns, [], [600.0] * 3)
    assert seconds[0] == 0.0 and min(seconds[1:]) > 0.0
    flown = [one.after(wait_s) for one, wait_s in zip(returns, seconds, strict=True)]
    assert conflicts(flown, rules=RULES) == ()


def test_one_that_would_wait_in_anothers_way_goes_first():
    behind, ahead = returning("Tern"), replace(returning("Kite"), position=LonLat(10.005, 56.0))
    first, second = waits([behind, ahead], [], [600.0] * 2)
    assert first > second == 0.0


def test_one_whose_battery_does_not_let_it_wait_does_not():
    assert waits([returning("Tern"), returning("Kite", 200.0)], [], [600.0, 0.0])[1] == 0.0


def test_one_that_hovers_on_the_way_is_met_whatever_the_wait():
    hovering = staying("Swift", LonLat(10.005, 56.0), 50.0)
    assert waits([returning("Tern")], [hovering], [600.0]) == [None]


def test_heights_are_chosen_before_waits_where_they_come_first():
    one, other = returning("Tern", goal_m=200.0), returning("Kite", 200.0)
    choices = [[back.after(0.0), replace(back, level_m=66.0).after(0.0), back.after(300.0)] for back in (one, other)]
    assert chosen_apart(choices, [], RULES, [one.after(0.0), other.after(0.0)]) == [0, 1]


def test_an_unknown_height_counts_as_the_same():
    passing = flying_on("Swift", [(LonLat(10.005, 56.002), math.nan, 0.0), (LonLat(10.005, 55.998), math.nan, 5.0)], 10.0, lands=False)
    assert np.isnan(passing.height_m).all()
    assert len(conflicts([returning("Tern").after(0.0)], [passing], rules=RULES)) == 1
