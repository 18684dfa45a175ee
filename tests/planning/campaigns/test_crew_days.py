"""Working days of crews: within the day, every site once, and as few days as exhaustive search finds."""

from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import WGS84
from planning.campaigns.crew_days import ROAD_FACTOR, Crews, Schedule, schedule, work_limit_s

START = LonLat(10.0, 56.0)
CREW = Crews(START, drive_mps=10.0, set_up_s=600.0, day_s=4 * 3600.0)


def drive_s(start: LonLat, end: LonLat, crews: Crews = CREW) -> float:
    return WGS84.inv(*start, *end)[2] * ROAD_FACTOR / crews.drive_mps


def is_sound(made: Schedule, sites: list[LonLat], work_s: list[float], crews: Crews = CREW) -> None:
    """Recomputed: every site once, drives and times add up, no day is longer than allowed, crews work on one day at a time."""
    done = [visit.site for day in made.days for visit in day.visits]
    assert sorted([*done, *made.too_long]) == list(range(len(sites)))
    assert len({(day.crew, day.day) for day in made.days}) == len(made.days)
    for day in made.days:
        assert 0 <= day.crew < crews.count
        at, clock_s = crews.start, 0.0
        for visit in day.visits:
            there_s = drive_s(at, sites[visit.site], crews)
            assert visit.drive_s == pytest.approx(there_s, rel=1e-6)
            assert visit.drive_m == pytest.approx(there_s * crews.drive_mps, rel=1e-6)
            assert visit.arrives_s == pytest.approx(clock_s + there_s, rel=1e-6)
            clock_s += there_s + (0.0 if at == sites[visit.site] and at != crews.start else crews.set_up_s) + work_s[visit.site]
            assert visit.leaves_s == pytest.approx(clock_s, rel=1e-6)
            at = sites[visit.site]
        assert day.ends_s == pytest.approx(clock_s + drive_s(at, crews.start, crews), rel=1e-6)
        assert day.ends_s <= crews.day_s


def test_two_sites_that_fit_a_day_are_visited_on_one_day():
    sites = [LonLat(10.05, 56.0), LonLat(10.1, 56.0)]
    made = schedule(sites, [3_000.0, 3_000.0], CREW)
    is_sound(made, sites, [3_000.0, 3_000.0])
    assert len(made.days) == 1
    assert made.is_proven


def test_days_are_dealt_out_to_crews():
    sites = [LonLat(10.05, 56.0), LonLat(10.1, 56.0), LonLat(10.0, 56.05)]
    crews = Crews(START, count=2, drive_mps=10.0, set_up_s=600.0, day_s=4 * 3600.0)
    made = schedule(sites, [9_000.0] * 3, crews)
    is_sound(made, sites, [9_000.0] * 3, crews)
    assert sorted((day.day, day.crew) for day in made.days) == [(0, 0), (0, 1), (1, 0)]


def test_a_site_with_more_work_than_a_day_holds_is_named():
    sites = [LonLat(10.05, 56.0), LonLat(10.5, 56.0)]
    made = schedule(sites, [1_000.0, work_limit_s(sites[1], CREW) + 1.0], CREW)
    is_sound(made, sites, [1_000.0, work_limit_s(sites[1], CREW) + 1.0])
    assert made.too_long == (1,)
    assert schedule(sites[1:], [work_limit_s(sites[1], CREW) - 1.0], CREW).too_long == ()


def test_missions_that_follow_each_other_at_one_site_need_one_set_up():
    sites = [LonLat(10.05, 56.0), LonLat(10.1, 56.0), LonLat(10.05, 56.0)]
    made = schedule(sites, [1_000.0] * 3, CREW)
    is_sound(made, sites, [1_000.0] * 3)
    (day,) = made.days
    assert abs([visit.site for visit in day.visits].index(0) - [visit.site for visit in day.visits].index(2)) == 1
    alone_s = sum(drive_s(left, right) for left, right in pairwise([START, sites[0], sites[1], START]))
    assert day.ends_s == pytest.approx(alone_s + 2 * CREW.set_up_s + 3_000.0, rel=1e-6)


def test_nothing_to_do_is_no_day():
    assert schedule([], [], CREW) == Schedule((), (), True)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 1_000_000))
def test_random_days_are_sound_and_as_few_as_can_be(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 6))
    sites = [LonLat(10.0 + 0.2 * rng.random(), 56.0 + 0.1 * rng.random()) for _ in range(count)]
    work_s = [float(value) for value in rng.uniform(600.0, 8_000.0, count)]
    made = schedule(sites, work_s, CREW)
    is_sound(made, sites, work_s)
    days, least_s = fewest_days(sites, work_s)
    assert len(made.days) == days
    assert sum(day.ends_s for day in made.days) == pytest.approx(least_s, rel=1e-6)


def fewest_days(sites: list[LonLat], work_s: list[float]) -> tuple[int, float]:
    """The fewest days and of those the least time: every order, cut into days in every way."""
    best = (len(sites) + 1, np.inf)
    for order in permutations(range(len(sites))):
        for cuts in range(2 ** (len(order) - 1)):
            places = [0, *(place + 1 for place in range(len(order) - 1) if cuts >> place & 1), len(order)]
            days = [order[first:last] for first, last in pairwise(places)]
            took_s = [day_s([sites[site] for site in day], [work_s[site] for site in day]) for day in days]
            if max(took_s) <= CREW.day_s:
                best = min(best, (len(days), sum(took_s)))
    return best


def day_s(sites: list[LonLat], work_s: list[float]) -> float:
    stops = [START, *sites, START]
    return sum(drive_s(left, right) for left, right in pairwise(stops)) + sum(work_s) + CREW.set_up_s * len(sites)
