"""Small steps up and down of a drawn route become slopes that are nowhere lower."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.trajectory.sloped_rises import MAX_RISE_M, MIN_RUN_M, SLOPE, ProfilePoint, with_slopes

LEG_M = 400.0


def own(number: int, level_m: float, *, is_fixed: bool = False, most_m: float = 120.0) -> ProfilePoint:
    return ProfilePoint(number * LEG_M, level_m, number, 0.0, is_own=True, is_fixed=is_fixed, most_m=most_m)


def put_in(leg: int, share: float, level_m: float) -> ProfilePoint:
    return ProfilePoint((leg + share) * LEG_M, level_m, leg, share, is_own=False)


def seen(profile: list[ProfilePoint]) -> list[tuple[float, float]]:
    return [(round(point.along_m, 3), round(point.level_m, 3)) for point in profile]


def test_a_small_step_up_and_down_is_a_slope_before_and_behind() -> None:
    steps = [put_in(0, share, level_m) for share, level_m in ((0.4, 60.0), (0.4, 66.0), (0.6, 66.0), (0.6, 60.0))]
    drawn = with_slopes([own(0, 60.0), *steps, own(1, 60.0)])
    run_m = 6.0 / SLOPE
    assert seen(drawn) == [(0.0, 60.0), (160.0 - run_m, 60.0), (160.0, 66.0), (240.0, 66.0), (240.0 + run_m, 60.0), (400.0, 60.0)]
    assert [round(point.share, 6) for point in drawn[1:-1]] == pytest.approx([0.31, 0.4, 0.6, 0.69])


def test_a_step_of_a_foot_has_room_to_be_flown_at_speed() -> None:
    drawn = with_slopes([own(0, 60.0), put_in(0, 0.5, 60.0), put_in(0, 0.5, 60.3), own(1, 60.3)])
    assert seen(drawn) == [(0.0, 60.0), (200.0 - MIN_RUN_M, 60.0), (200.0, 60.3), (400.0, 60.3)]


def test_a_high_step_stays_straight_up() -> None:
    steps = [own(0, 60.0), put_in(0, 0.5, 60.0), put_in(0, 0.5, 60.1 + MAX_RISE_M), own(1, 60.1 + MAX_RISE_M)]
    assert with_slopes(steps) == steps


def test_what_a_slope_passes_over_is_lifted_but_not_a_target_and_nothing_above_the_limit() -> None:
    step = [put_in(1, 0.025, 60.0), put_in(1, 0.025, 66.0)]
    over = with_slopes([own(0, 60.0), own(1, 60.0), *step, own(2, 66.0)])
    assert seen(over) == [(0.0, 60.0), (374.0, 60.0), (400.0, pytest.approx(64.333, abs=1e-3)), (410.0, 66.0), (800.0, 66.0)]
    at_target = with_slopes([own(0, 60.0), own(1, 60.0, is_fixed=True), *step, own(2, 66.0)])
    assert seen(at_target)[1:4] == [(400.0, 60.0), (400.0, pytest.approx(64.333, abs=1e-3)), (410.0, 66.0)]
    assert at_target[2].leg == 1
    low = [own(0, 60.0), own(1, 60.0, most_m=62.0), *step, own(2, 66.0)]
    assert with_slopes(low) == low


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 12.0), st.booleans()), min_size=1, max_size=12), st.integers(1, 4))
def test_no_place_is_lower_than_it_was(drawn: list[tuple[float, float, bool]], legs: int) -> None:
    """Steps anywhere, up and down, close together; the route's own points stay at their places and in their order."""
    profile, level_m = [own(0, 60.0, is_fixed=True)], 60.0
    for number, (share, rise_m, is_fixed) in enumerate(sorted(drawn, key=lambda one: one[0])):
        at = min(share * legs, legs - 1e-6)
        while profile[-1].leg < int(at):
            profile.append(own(profile[-1].leg + 1, level_m, is_fixed=is_fixed))
        after_m = 60.0 + rise_m if number % 2 == 0 else 60.0
        profile += [put_in(int(at), at - int(at), level_m), put_in(int(at), at - int(at), after_m)]
        level_m = after_m
    profile.append(own(profile[-1].leg + 1, level_m, is_fixed=True))
    flown = with_slopes(profile)
    assert [(point.along_m, point.leg) for point in flown if point.is_own] == [
        (point.along_m, point.leg) for point in profile if point.is_own
    ]
    assert all(before.along_m <= after.along_m + 1e-9 for before, after in pairwise(flown))
    assert [(point.leg, not point.is_own, point.share) for point in flown] == sorted((p.leg, not p.is_own, p.share) for p in flown)
    at_m = np.linspace(0.0, profile[-1].along_m, 1_711)
    assert (highest_at(flown, at_m) >= lowest_at(profile, at_m) - 1e-6).all()
    assert max(point.level_m for point in flown) <= max(point.level_m for point in profile) + 1e-9


def highest_at(profile: list[ProfilePoint], at_m: np.ndarray) -> np.ndarray:
    return _at(profile, at_m, highest=True)


def lowest_at(profile: list[ProfilePoint], at_m: np.ndarray) -> np.ndarray:
    return _at(profile, at_m, highest=False)


def _at(profile: list[ProfilePoint], at_m: np.ndarray, *, highest: bool) -> np.ndarray:
    """Levels along a profile; where it is a step, its top or its foot."""
    found = np.full(len(at_m), -np.inf if highest else np.inf)
    for before, after in pairwise(profile):
        inside = (at_m >= before.along_m - 1e-9) & (at_m <= after.along_m + 1e-9)
        length_m = after.along_m - before.along_m
        share = np.clip((at_m[inside] - before.along_m) / length_m, 0.0, 1.0) if length_m > 1e-9 else 0.0
        ends = (before.level_m, after.level_m)
        level_m = ends[0] + share * (ends[1] - ends[0]) if length_m > 1e-9 else (max(ends) if highest else min(ends))
        found[inside] = np.maximum(found[inside], level_m) if highest else np.minimum(found[inside], level_m)
    return found
