"""Launch sites: every target in reach has one, given ones come first, and no site is redundant. Against exhaustive search."""

from itertools import combinations, pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import WGS84
from planning.campaigns import launch_sites
from planning.campaigns.launch_sites import SiteChoice, choose_sites

Course = tuple[LonLat, ...]


def line(parts: int, *, lon: float = 10.0, lat: float = 56.0, step: float = 0.016) -> list[Course]:
    """Parts of about 1 km each of a line to the east."""
    ends = [LonLat(lon + step * number, lat) for number in range(parts + 1)]
    return list(pairwise(ends))


def ends_of(targets: list[Course]) -> list[LonLat]:
    return list(dict.fromkeys(end for target in targets for end in (target[0], target[-1])))


def reaches(target: Course, site: LonLat, reach_m: float) -> bool:
    return all(WGS84.inv(*point, *site)[2] <= reach_m for point in target)


def is_sound(choice: SiteChoice, targets: list[Course], candidates: list[LonLat], reach_m: float) -> None:
    """Every target that a candidate reaches is flown from a site that reaches it, and each site has a target."""
    for target, place in zip(targets, choice.site_of, strict=True):
        if place is None:
            assert not any(reaches(target, site, reach_m) for site in candidates)
        else:
            assert reaches(target, candidates[choice.sites[place]], reach_m)
    assert set(range(len(choice.sites))) == {place for place in choice.site_of if place is not None}


def test_a_line_of_ten_kilometres_takes_two_sites_with_a_reach_of_three():
    targets = line(10)
    choice = choose_sites(targets, ends_of(targets), 3_000.0)
    is_sound(choice, targets, ends_of(targets), 3_000.0)
    assert len(choice.sites) == 2
    assert sum(left != right for left, right in pairwise(choice.site_of)) == 1  # each has one stretch of the line
    assert min(choice.site_of.count(0), choice.site_of.count(1)) >= 4


def test_given_sites_are_used_before_others_are_proposed():
    targets = line(10)
    base = LonLat(10.04, 56.005)
    choice = choose_sites(targets, [base, *ends_of(targets)], 3_000.0, given=1)
    is_sound(choice, targets, [base, *ends_of(targets)], 3_000.0)
    assert choice.sites[0] == 0
    assert choice.site_of[2] == 0


def test_a_required_site_is_used_for_the_targets_nearest_to_it():
    targets = line(10)
    sites = [LonLat(10.048, 56.002), LonLat(10.12, 56.002), LonLat(10.064, 56.002)]
    choice = choose_sites(targets, sites, 5_000.0, given=3, required=[2])
    is_sound(choice, targets, sites, 5_000.0)
    assert choice.sites[0] == 2
    assert choice.site_of[4] == 0


def test_targets_beyond_reach_are_named_with_the_distance_that_it_would_take():
    targets = [*line(2), (LonLat(10.2, 56.0),)]
    choice = choose_sites(targets, [LonLat(10.0, 56.0)], 3_000.0, given=1)
    assert choice.site_of == (0, 0, None)
    assert choice.nearest_m[2] == pytest.approx(WGS84.inv(10.0, 56.0, 10.2, 56.0)[2], rel=1e-6)


def test_without_candidates_nothing_is_in_reach():
    assert choose_sites(line(2), [], 3_000.0) == SiteChoice((), (None, None), (np.inf, np.inf))
    assert choose_sites([], [LonLat(10.0, 56.0)], 3_000.0).sites == ()


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 1_000_000), given_sites=st.integers(0, 3))
def test_random_choices_are_sound_and_as_few_as_can_be(seed, given_sites):
    rng = np.random.default_rng(seed)
    targets: list[Course] = []
    for _ in range(rng.integers(1, 9)):
        at = LonLat(10.0 + 0.1 * rng.random(), 56.0 + 0.06 * rng.random())
        targets.append((at,) if rng.random() < 0.3 else (at, LonLat(at.lon + 0.02 * rng.random(), at.lat + 0.01 * rng.random())))
    candidates = [LonLat(10.0 + 0.1 * rng.random(), 56.0 + 0.06 * rng.random()) for _ in range(given_sites)] + ends_of(targets)
    choice = choose_sites(targets, candidates, 2_500.0, given=given_sites)
    is_sound(choice, targets, candidates, 2_500.0)
    if not given_sites:
        assert len(choice.sites) == fewest(targets, candidates, 2_500.0)


def test_where_no_cover_is_found_in_time_sites_are_added_greedily(monkeypatch):
    targets = line(10)
    monkeypatch.setattr(launch_sites, "milp", lambda *problem, **options: SimpleNamespace(x=None))
    choice = choose_sites(targets, ends_of(targets), 3_000.0)
    is_sound(choice, targets, ends_of(targets), 3_000.0)
    assert len(choice.sites) == 2


def fewest(targets: list[Course], candidates: list[LonLat], reach_m: float) -> int:
    covered = [{place for place, target in enumerate(targets) if reaches(target, site, reach_m)} for site in candidates]
    whole = set().union(*covered)
    choices = ((count, chosen) for count in range(len(candidates) + 1) for chosen in combinations(covered, count))
    return next(count for count, chosen in choices if set().union(*chosen) == whole)
