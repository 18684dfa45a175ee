"""Which spans the last look takes to be beside which legs, against Shapely's distances."""

import numpy as np
import shapely
from hypothesis import given
from hypothesis import strategies as st

from planning.clearance.obstacle_clearance import BESIDE_M, _pairs, lines_between

METRES = st.integers(-200, 200).map(float)
PLACES = st.tuples(METRES, METRES)


@given(st.lists(PLACES, min_size=2, max_size=8), st.lists(st.tuples(PLACES, PLACES), min_size=1, max_size=80))
def test_legs_and_spans_within_reach_of_each_other_are_all_found(
    line: list[tuple[float, float]], spans: list[tuple[tuple[float, float], ...]]
) -> None:
    """Points among both: a leg straight up, what stands alone. Where the distance is the limit, rounding decides."""
    flown, start, end = np.array(line), np.array([one for one, _other in spans]), np.array([other for _one, other in spans])
    legs, found = _pairs(flown, start, end, BESIDE_M)
    assert len(set(zip(legs.tolist(), found.tolist(), strict=True))) == len(legs)
    near = np.zeros((len(line) - 1, len(spans)), dtype=bool)
    near[legs, found] = True
    apart_m = shapely.distance(lines_between(flown[:-1], flown[1:])[:, None], lines_between(start, end)[None, :])
    assert near[apart_m < BESIDE_M - 1e-6].all()
    assert not near[apart_m > BESIDE_M + 1e-6].any()
