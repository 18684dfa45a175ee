"""Departures that meet a zone: worked by hand, and against trying each."""

from hypothesis import given
from hypothesis import strategies as st

from inspection.zones.activity import TimeSpan
from missions.selectors.zones import blocked_departures, free_between

A_DAY = (0.0, 86_400.0)


def test_a_leg_flown_after_ten_to_twelve_minutes_bars_what_is_that_much_earlier() -> None:
    """The zone applies from 9:00 to 10:00 (32,400 s to 36,000 s)."""
    assert blocked_departures([(600.0, 720.0)], [(32_400.0, 36_000.0)], 0.0, *A_DAY) == (TimeSpan(31_680.0, 35_400.0),)
    assert blocked_departures([(600.0, 720.0)], [(32_400.0, 36_000.0)], 300.0, *A_DAY) == (TimeSpan(31_380.0, 35_700.0),)


def test_two_legs_of_one_zone_bar_both_times_and_what_overlaps_is_one() -> None:
    legs = [(600.0, 720.0), (7_200.0, 7_260.0)]
    assert blocked_departures(legs, [(32_400.0, 33_000.0)], 0.0, *A_DAY) == (TimeSpan(25_140.0, 25_800.0), TimeSpan(31_680.0, 32_400.0))
    assert blocked_departures(legs, [(32_400.0, 39_600.0)], 0.0, *A_DAY) == (TimeSpan(25_140.0, 39_000.0),)


def test_a_zone_that_applied_before_the_first_departure_or_ends_after_the_last_is_cut_there() -> None:
    assert blocked_departures([(600.0, 720.0)], [(-9_999.0, 700.0), (86_500.0, 99_999.0)], 0.0, *A_DAY) == (
        TimeSpan(0.0, 100.0),
        TimeSpan(85_780.0, 86_400.0),
    )


def test_what_is_free_is_what_is_left() -> None:
    assert free_between([], 0.0, 10.0) == (TimeSpan(0.0, 10.0),)
    assert free_between([TimeSpan(0.0, 10.0)], 0.0, 10.0) == ()
    assert free_between([TimeSpan(8.0, 10.0), TimeSpan(2.0, 4.0), TimeSpan(3.0, 5.0)], 0.0, 10.0) == (
        TimeSpan(0.0, 2.0),
        TimeSpan(5.0, 8.0),
    )


seconds = st.integers(-500, 1_500)
pairs = st.lists(st.tuples(seconds, st.integers(0, 300)).map(lambda at: (float(at[0]), float(at[0] + at[1]))), max_size=4)


@given(legs=pairs, spans=pairs, margin_s=st.integers(0, 50))
def test_each_second_of_departure_is_judged_as_by_trying_it(
    legs: list[tuple[float, float]], spans: list[tuple[float, float]], margin_s: int
) -> None:
    spans = [span for span in spans if span[0] < span[1]]
    blocked = blocked_departures(legs, spans, margin_s, 0.0, 1_000.0)
    free = free_between(blocked, 0.0, 1_000.0)
    for departure in range(1_000):
        meets = any(
            departure + first < end + margin_s and departure + last >= start - margin_s for start, end in spans for first, last in legs
        )
        assert meets == any(start <= departure < end for start, end in blocked)
        assert meets != any(start <= departure < end for start, end in free)
