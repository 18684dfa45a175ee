"""Zones against legs: touching counts, and the answers equal exact arithmetic."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import MultiPolygon, Polygon, box
from shapely.affinity import translate

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import WGS84
from inspection.network.zones.zone_index import MANY, ZoneIndex
from tests.exact_geometry import segment_meets_polygon

ROOT = Path(__file__).resolve().parents[3]
SQUARE = box(10.0, 50.0, 10.1, 50.1)
RING = Polygon(SQUARE.exterior.coords, [box(10.02, 50.02, 10.08, 50.08).exterior.coords])


def index(*polygons) -> ZoneIndex:
    return ZoneIndex(polygons, range(1, len(polygons) + 1), [f"zone {number + 1}" for number in range(len(polygons))])


@pytest.mark.parametrize(
    ("start", "end", "is_met"),
    [
        ((9.9, 50.05), (10.2, 50.05), True),  # across
        ((10.04, 50.04), (10.06, 50.06), True),  # within
        ((9.9, 50.1), (10.2, 50.1), True),  # along the border
        ((10.1, 50.1), (10.2, 50.2), True),  # touches a corner
        ((9.95, 50.15), (10.15, 50.15), False),  # beside
        ((10.2, 50.0), (10.3, 50.1), False),
        ((10.05, 50.05), (10.05, 50.05), True),  # a point within
        ((10.1, 50.05), (10.1, 50.05), True),  # a point on the border
        ((10.2, 50.05), (10.2, 50.05), False),
    ],
)
def test_a_leg_meets_a_zone_that_it_touches(start, end, is_met):
    assert index(SQUARE).meets([start], [end]).tolist() == [is_met]


def test_a_leg_inside_a_hole_meets_nothing():
    assert index(RING).meets([(10.03, 50.03), (10.03, 50.03)], [(10.07, 50.07), (10.09, 50.07)]).tolist() == [False, True]


def test_an_overlap_of_1_cm_is_met():
    one_cm = 0.01 / 71_500
    met = index(SQUARE).meets([(10.1 - one_cm, 50.05), (10.1 + one_cm, 50.05)], [(10.2, 50.05), (10.2, 50.05)])
    assert met.tolist() == [True, False]


@pytest.mark.parametrize("lat", [0.0, 47.0, -69.0])
@pytest.mark.parametrize(
    ("bearing_deg", "east", "north"),
    [(0, 0, 1), (45, 1, 1), (90, 1, 0), (135, 1, -1), (180, 0, -1), (225, -1, -1), (270, -1, 0), (315, -1, 1)],
)
def test_the_clearance_is_kept_in_metres_in_every_direction(lat, bearing_deg, east, north):
    """From the middle of each side straight out, and from each corner slantwise."""
    half_deg = 0.001
    square = translate(box(-half_deg, -half_deg, half_deg, half_deg), 10.0, lat)
    border = (10.0 + east * half_deg, lat + north * half_deg)
    too_near, clear = (WGS84.fwd(*border, bearing_deg, metres)[:2] for metres in (49.9, 51.5))
    assert index(square).meets([too_near, clear], [too_near, clear], 50.0).tolist() == [True, False]


def test_parts_of_a_multipolygon_are_one_zone():
    pair = MultiPolygon([SQUARE, translate(SQUARE, 1.0)])
    zones = index(box(0, 0, 1, 1), pair)
    assert zones.zone_at(LonLat(11.05, 50.05)) == (2, "zone 2")
    assert zones.meets([(11.05, 50.05)], [(11.5, 50.5)]).tolist() == [True]


def test_the_zone_met_first_on_the_way_is_named():
    zones = index(translate(SQUARE, 1.0), SQUARE)
    assert zones.first_met(LonLat(9.0, 50.05), LonLat(12.0, 50.05)) == (2, "zone 2")
    assert zones.first_met(LonLat(12.0, 50.05), LonLat(9.0, 50.05)) == (1, "zone 1")
    assert zones.first_met(LonLat(9.0, 50.5), LonLat(12.0, 50.5)) is None


def test_the_border_belongs_to_the_zone():
    zones = index(SQUARE)
    assert zones.zone_at(LonLat(10.1, 50.05)) == (1, "zone 1")
    assert zones.zone_at(LonLat(10.1000001, 50.05)) is None
    assert zones.contains([(10.05, 50.05), (10.1, 50.1), (10.2, 50.0)]).tolist() == [True, True, False]
    assert zones.contains([(10.1 + 40 / 71_700, 50.05), (10.1 + 60 / 71_700, 50.05)], 50.0).tolist() == [True, False]


def test_one_start_goes_with_every_end():
    ends = [(10.2, 50.05), (9.8, 50.05), (10.0, 50.0)]
    assert (
        index(SQUARE).meets([(9.9, 50.05)], ends).tolist() == index(SQUARE).meets([(9.9, 50.05)] * 3, ends).tolist() == [True, False, True]
    )


def test_without_zones_nothing_is_met():
    zones = index()
    assert zones.meets([(0, 0)], [(1, 1)], 5.0).tolist() == [False]
    assert zones.contains([(0, 0)]).tolist() == [False]
    assert zones.zone_at(LonLat(0, 0)) is None
    assert zones.first_met(LonLat(0, 0), LonLat(1, 1)) is None


def test_lists_of_different_length_are_refused():
    with pytest.raises(ValueError, match="same length"):
        ZoneIndex([SQUARE], [1, 2], ["a", "b"])


coordinates = st.integers(-8, 8)


@st.composite
def zones_and_legs(draw: st.DrawFn):
    """Triangles on a coarse lattice and legs between lattice points: touches and collinear sides are common."""
    triangles = draw(st.lists(st.lists(st.tuples(coordinates, coordinates), min_size=3, max_size=3, unique=True), min_size=1, max_size=5))
    polygons = [polygon for polygon in map(Polygon, triangles) if polygon.area > 0]
    legs = draw(st.lists(st.tuples(st.tuples(coordinates, coordinates), st.tuples(coordinates, coordinates)), min_size=1, max_size=10))
    scale = draw(st.sampled_from([1.0, 0.1, 1 / 3]))
    return [Polygon(np.array(polygon.exterior.coords) * scale) for polygon in polygons], np.array(legs) * scale


@given(zones_and_legs())
def test_answers_equal_exact_arithmetic(case):
    polygons, legs = case
    met = index(*polygons).meets(legs[:, 0], legs[:, 1])
    for (start, end), is_met in zip(legs.tolist(), met.tolist(), strict=True):
        rings_of = [[list(polygon.exterior.coords)] for polygon in polygons]
        assert is_met == any(segment_meets_polygon(start, end, rings) for rings in rings_of)


@given(zones_and_legs())
def test_what_meets_a_zone_is_never_clear_of_it(case):
    polygons, legs = case
    zones = index(*polygons)
    assert (zones.meets(legs[:, 0], legs[:, 1], 5.0) >= zones.meets(legs[:, 0], legs[:, 1])).all()


def jagged(lon, corners=5_000):
    """A zone of so many corners that a look at it takes long enough for threads to get in each other's way."""
    angle = np.linspace(0.0, 2 * np.pi, corners, endpoint=False)
    radius = 1.0 + 0.3 * np.sin(37 * angle)
    return Polygon(np.column_stack([lon + radius * np.cos(angle), radius * np.sin(angle)]))


@pytest.mark.long
def test_threads_that_share_an_index_get_the_answers_that_one_thread_gets():
    """In a process of its own: what this guards against is a crash of the interpreter."""
    script = """
from concurrent.futures import ThreadPoolExecutor
import subprocess
import sys
from pathlib import Path

import numpy as np
from planning.clearance.zone_clearance import legs_that_meet
from tests.inspection.network.test_zone_index import index, jagged

zones = [jagged(lon) for lon in (0.0, 3.0)]
start = np.random.default_rng(1).uniform([-2.0, -2.0], [5.0, 2.0], (2_000, 2))
end = start + np.random.default_rng(2).normal(0.0, 0.3, start.shape)
truth = index(*zones).meets(start, end)
shared = index(*zones)
with ThreadPoolExecutor(4) as pool:
    answers = list(pool.map(lambda turn: shared.meets(start, end), range(24)))
    checks = list(pool.map(lambda turn: legs_that_meet(start, list(shared.polygons)), range(12)))
assert all((answer == truth).all() for answer in answers)
assert all(check == checks[0] for check in checks)
"""
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)  # noqa: S603
    assert done.returncode == 0, done.stderr


def banded(*bands: tuple[float, float]) -> ZoneIndex:
    """The square once for each band."""
    floors, ceilings = zip(*bands, strict=True)
    return ZoneIndex(
        [SQUARE] * len(bands),
        range(1, len(bands) + 1),
        [f"zone {number + 1}" for number in range(len(bands))],
        floor_agl_m=floors,
        ceiling_agl_m=ceilings,
    )


ACROSS = (9.9, 50.05), (10.2, 50.05)
INSIDE = LonLat(10.05, 50.05)


@pytest.mark.parametrize(
    ("low_m", "high_m", "is_met"),
    [
        (0.0, 60.0, False),
        (0.0, 99.9, False),
        (0.0, 100.0, True),  # touches the floor
        (120.0, 130.0, True),  # within
        (0.0, 500.0, True),  # through
        (150.0, 160.0, True),  # touches the ceiling
        (150.1, 160.0, False),
        (None, 99.0, False),
        (None, 100.0, True),
        (151.0, None, False),
        (None, None, True),
        (np.nan, np.nan, True),
    ],
)
def test_a_zone_of_100_to_150_m_is_met_at_its_heights_alone(low_m, high_m, is_met):
    zones = banded((100.0, 150.0))
    assert zones.meets([ACROSS[0]], [ACROSS[1]], 5.0, low_m, high_m).tolist() == [is_met]
    assert zones.contains([INSIDE], 5.0, low_m, high_m).tolist() == [is_met]
    assert (zones.zone_at(INSIDE, low_m, high_m) is not None) == is_met
    assert (zones.first_met(LonLat(*ACROSS[0]), LonLat(*ACROSS[1]), low_m, high_m) is not None) == is_met


def test_each_leg_has_its_own_heights():
    zones = banded((100.0, 150.0), (-np.inf, 30.0))
    start, end = [ACROSS[0]] * 4, [ACROSS[1]] * 4
    met = zones.meets(start, end, 5.0, np.array([40.0, 90.0, 20.0, 160.0]), np.array([80.0, 110.0, 25.0, 170.0]))
    assert met.tolist() == [False, True, True, False]
    assert zones.contains(start, 20_000.0, 40.0, np.array([80.0, 120.0, 80.0, 100.0])).tolist() == [False, True, False, True]


@pytest.mark.parametrize("band", [(np.nan, np.nan), (np.nan, 10.0), (-np.inf, np.inf), (150.0, 100.0)])
def test_a_limit_that_says_nothing_is_no_limit(band):
    """A band that is upside down says nothing either."""
    floor_m = 5.0 if band[1] == 10.0 else 60.0
    assert banded(band).meets([ACROSS[0]], [ACROSS[1]], 0.0, floor_m, 80.0).tolist() == [True]


def test_the_first_zone_met_is_the_first_at_this_height():
    west, east = box(10.0, 50.0, 10.1, 50.1), box(10.3, 50.0, 10.4, 50.1)
    zones = ZoneIndex([west, east], [1, 2], ["west", "east"], floor_agl_m=[100.0, 0.0], ceiling_agl_m=[200.0, 200.0])
    leg = LonLat(9.9, 50.05), LonLat(10.5, 50.05)
    assert (zones.first_met(*leg), zones.first_met(*leg, 0.0, 80.0)) == ((1, "west"), (2, "east"))
    assert zones.zone_at(LonLat(10.05, 50.05), 0.0, 80.0) is None


def test_some_of_the_zones_make_an_index():
    zones = banded((0.0, 10.0), (20.0, 30.0), (40.0, 50.0))
    some = zones.where([2, 0])
    assert (some.ids.tolist(), some.names) == ([1, 3], ("zone 1", "zone 3"))
    assert [some.zone_at(INSIDE, height_m, height_m) for height_m in (5.0, 25.0, 45.0)] == [(1, "zone 1"), None, (3, "zone 3")]
    assert some.digest == zones.where(np.array([True, False, True])).digest != zones.digest
    assert len(zones.where([])) == 0
    assert zones.where([0, 1, 2]) is zones


def test_very_many_legs_and_positions_get_the_answers_of_few():
    """Which are the same whatever stands beside them."""
    rng = np.random.default_rng(7)
    boxes = [
        box(*west_south, *(west_south + size))
        for west_south, size in zip(rng.uniform(5, 15, (40, 2)), rng.uniform(0.001, 0.5, (40, 2)), strict=True)
    ]
    zones = ZoneIndex(boxes, range(40), [""] * 40, floor_agl_m=rng.choice([-np.inf, 50.0, 90.0], 40))
    start = rng.uniform(4, 16, (2 * MANY, 2)).round(2)
    end = start + rng.uniform(-0.2, 0.2, start.shape).round(2)
    high_m = rng.uniform(0, 120, len(start))
    for limits in ((), (0.0, high_m)):
        few = [
            zones.meets(start[first : first + 500], end[first : first + 500], 5.0, *(limits and (0.0, high_m[first : first + 500])))
            for first in range(0, len(start), 500)
        ]
        assert zones.meets(start, end, 5.0, *limits).tolist() == np.concatenate(few).tolist()
        few = [
            zones.contains(start[first : first + 500], 5.0, *(limits and (0.0, high_m[first : first + 500])))
            for first in range(0, len(start), 500)
        ]
        assert zones.contains(start, 5.0, *limits).tolist() == np.concatenate(few).tolist()
        assert 0 < np.concatenate(few).sum() < len(start)
    from_one = zones.meets(start[:1], end, 5.0)
    assert from_one.tolist() == zones.meets(np.repeat(start[:1], len(end), axis=0), end, 5.0).tolist()
