"""How high what stands and hangs beside a straight way is."""

import numpy as np
import pytest
import shapely

from inspection.network.spans import spans_between
from planning.trajectory.spans_below import BESIDE_M, tops_below

DEG_M = 111_319.49  # on the equator
SAMPLES = 1_000


def test_where_nothing_stands_nothing_is_high():
    nothing = spans_between(np.empty((0, 2)), np.empty((0, 2)), np.empty(0), np.empty(0))
    assert tops_below(np.zeros((2, 2)), np.ones((2, 2)), nothing, None, 45.0).tolist() == [-np.inf, -np.inf]


@pytest.mark.parametrize("is_hilly", [False, True])
@pytest.mark.parametrize("seed", range(2))
def test_no_point_of_a_wire_beside_the_way_is_higher_and_the_highest_is_not_far_from_it(seed, is_hilly):
    """Against wires cut into many points: those within BESIDE_M are no higher; one within the corners of the strip is as high."""
    draw = np.random.default_rng(seed)
    start, end = draw.uniform(0.0, 2_000.0, (2, 20, 2))
    end[:3] = start[:3]  # straight down
    low, high = draw.uniform(0.0, 2_000.0, (2, 50, 2))
    high[:10] = low[:10]  # masts
    heights_m = draw.uniform(5.0, 150.0, (2, 50))
    heights_m[1, :10] = heights_m[0, :10]

    def ground(position):
        return 300.0 + 40.0 * np.sin(position[:, 0] * DEG_M / 200.0)

    spans = spans_between(low / DEG_M, high / DEG_M, *heights_m)
    found_m = tops_below(start / DEG_M, end / DEG_M, spans, ground if is_hilly else None, 0.0)
    feet_m = heights_m + (np.stack([ground(low / DEG_M), ground(high / DEG_M)]) if is_hilly else 0.0)
    share = np.linspace(0.0, 1.0, SAMPLES)[:, None, None]
    points = shapely.points(low + share * (high - low))
    tops_m = feet_m[0] + share[:, :, 0] * (feet_m[1] - feet_m[0])
    for way, top_m in enumerate(found_m):
        away_m = shapely.distance(points, shapely.linestrings([start[way], end[way]]) if way >= 3 else shapely.points(start[way]))
        # on the equator a degree north is 0.7 % shorter than a degree east
        assert tops_m[away_m <= 0.99 * BESIDE_M].max(initial=-np.inf) <= top_m + 1e-6
        assert top_m <= tops_m[away_m <= 1.45 * BESIDE_M].max(initial=-np.inf) + 0.5
