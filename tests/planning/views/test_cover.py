"""The choice of photos against all choices there are."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.views.cover import fewest_photos

PHOTOS, PATCHES = 9, 14


def is_enough(shows: np.ndarray, chosen: tuple[int, ...], area_m2: np.ndarray, kind: np.ndarray, share: float) -> bool:
    can, does = shows.any(axis=0), shows[list(chosen)].any(axis=0)
    return all(area_m2[does & (kind == own)].sum() >= share * area_m2[can & (kind == own)].sum() - 1e-6 for own in np.unique(kind))


def fewest(shows: np.ndarray, area_m2: np.ndarray, kind: np.ndarray, share: float) -> int:
    return next(
        count
        for count in range(len(shows) + 1)
        if any(is_enough(shows, chosen, area_m2, kind, share) for chosen in combinations(range(len(shows)), count))
    )


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from([0.7, 0.95, 1.0]), st.floats(0.05, 0.6))
def test_the_choice_shows_enough_and_lies_between_the_bound_and_the_best(seed: int, share: float, density: float) -> None:
    random = np.random.default_rng(seed)
    shows = random.random((PHOTOS, PATCHES)) < density
    area_m2, kind = random.uniform(0.1, 3.0, PATCHES), random.integers(0, 3, PATCHES)
    found = fewest_photos(shows, area_m2, kind, share)
    assert len(set(found.chosen.tolist())) == len(found.chosen)
    assert is_enough(shows, tuple(found.chosen.tolist()), area_m2, kind, share)
    best = fewest(shows, area_m2, kind, share)
    assert found.bound <= best <= len(found.chosen) <= best + 1


def test_the_same_photos_are_chosen_again() -> None:
    random = np.random.default_rng(5)
    shows = random.random((300, 200)) < 0.08
    area_m2, kind = random.uniform(0.1, 3.0, 200), random.integers(0, 4, 200)
    first, second = (fewest_photos(shows, area_m2, kind, 0.97) for _ in range(2))
    np.testing.assert_array_equal(first.chosen, second.chosen)
    assert first.bound == second.bound


@pytest.mark.parametrize("shape", [(0, 5), (4, 0), (4, 5)])
def test_nothing_to_show_needs_no_photo(shape: tuple[int, int]) -> None:
    found = fewest_photos(np.zeros(shape, dtype=bool), np.ones(shape[1]), np.zeros(shape[1], dtype=np.int64), 1.0)
    assert (len(found.chosen), found.bound) == (0, 0)
