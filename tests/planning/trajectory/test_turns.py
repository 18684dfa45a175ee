"""What turns of the course take, by hand and by the judge of plans."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.rules import AT_ONCE, FlightRules, Manoeuvres
from planning.trajectory.turns import turning_s
from tests.missions.oracles.turn_oracle import turns_s

Leg = tuple[float, float, float]  # metres to east, north and up


def turning(*legs: Leg, speed_mps: float, stands: tuple[int, ...] = (), rules: Manoeuvres | None = None) -> list[float]:
    """Of legs at one speed over ground, 2.5 m/s up and down; `stands`: ends of legs where it stands, each counted as slowing down."""
    rules = rules or FlightRules().manoeuvres
    leg_m = np.array(legs, dtype=np.float64)
    is_stop = np.isin(np.arange(len(legs) + 1), [0, *stands])
    brake_s = speed_mps / (2.0 * rules.acceleration_mps2)
    found = turning_s(leg_m, seconds(legs, speed_mps), is_stop, np.full(len(leg_m), brake_s), rules.acceleration_mps2, rules.corner_mps2)
    return [float(one) for one in found]


def seconds(legs: tuple[Leg, ...], speed_mps: float) -> np.ndarray:
    return np.array([max(math.hypot(east_m, north_m) / speed_mps, abs(up_m) / 2.5) for east_m, north_m, up_m in legs])


def test_a_right_angle_is_flown_as_slowly_as_its_corner_is_narrow() -> None:
    """An arc 1.3 m inside a right angle has a radius of 3.14 m, and takes that much of either leg; at 4 m/s2 it is flown at 3.54 m/s.

    From 14 m/s to that and back costs 1.95 s on either leg; the arc of 4.93 m takes 0.70 s on either leg, where 0.22 s were counted.
    """
    before_s, after_s = turning((500, 0, 0), (0, 500, 0), speed_mps=14)
    radius_m = 1.3 / (math.sqrt(2) - 1)
    corner_mps = math.sqrt(4 * radius_m)
    slowing_s = (14 - corner_mps) ** 2 / (2 * 2 * 14)
    own_s = slowing_s + math.pi / 4 * radius_m / corner_mps - radius_m / 14
    assert (before_s, after_s) == pytest.approx((own_s, own_s), abs=1e-9)
    assert own_s == pytest.approx(1.95 + 0.70 - 0.22, abs=0.01)


def test_a_straight_course_and_a_slight_turn_take_nothing() -> None:
    assert turning((100, 0, 0), (100, 0, 0), (100, 20, 0), speed_mps=14) == pytest.approx([0, 0, 0], abs=1e-9)


def test_a_reversal_is_made_standing() -> None:
    assert turning((300, 0, 0), (-300, 0, 0), speed_mps=12) == pytest.approx([3, 3])


def test_between_two_near_corners_it_does_not_come_to_its_speed() -> None:
    """25 m between two right angles, of which the arcs take 6.3 m: it comes to 7.1 m/s, and not to 14."""
    _first_s, between_s, _last_s = turning((500, 0, 0), (0, 25, 0), (500, 0, 0), speed_mps=14)
    radius_m = 1.3 / (math.sqrt(2) - 1)
    corner_mps = math.sqrt(4 * radius_m)
    peak_mps = math.sqrt(corner_mps**2 + 2 * (25 - 2 * radius_m))
    arcs_s = math.pi / 2 * radius_m / corner_mps
    assert between_s == pytest.approx((peak_mps - corner_mps) + arcs_s - 25 / 14, abs=1e-9)


def test_a_leg_that_is_flown_slower_is_slowed_down_to() -> None:
    leg_m, leg_s = np.array([[300.0, 0.0, 0.0], [300.0, 0.0, 0.0]]), np.array([300.0 / 14.0, 300.0 / 4.0])
    found = turning_s(leg_m, leg_s, np.array([True, False, False]), np.full(2, 3.5), 2.0, 4.0)
    assert found == pytest.approx([(14 - 4) ** 2 / (2 * 2 * 14), 0])


def test_what_a_stop_counts_already_is_not_counted_again() -> None:
    """Down to a hold and up again: the stop counts 3.5 s on either side, of which the turn into the descent and the stand take less."""
    legs = (500.0, 0.0, 0.0), (0.0, 0.0, -30.0), (0.0, 0.0, 30.0), (500.0, 0.0, 0.0)
    assert turning(*legs, speed_mps=14, stands=(2,)) == pytest.approx([0, 0, 0, 0], abs=1e-9)
    passing_s = turning(*legs, speed_mps=14)
    assert all(one > 0.4 for one in passing_s)
    rounding_s = math.pi / 2 * 1.5625 / 2.5 - 1.5625 / 14 - 1.5625 / 2.5  # at 2.5 m/s an arc of 1.56 m
    assert sum(passing_s) == pytest.approx(2 * (11.5**2 / 56 + rounding_s + 2.5 / 4), abs=0.01)


def test_a_uav_without_mass_turns_at_once() -> None:
    assert turning((500, 0, 0), (0, 500, 0), speed_mps=14, rules=AT_ONCE) == [0, 0]


legs = st.lists(
    st.tuples(st.floats(-300, 300), st.floats(-300, 300), st.sampled_from([0.0, 0.0, 0.0, 2.0, -20.0]))
    | st.just((0.0, 0.0, 30.0)) | st.just((0.0, 0.0, -30.0)),
    min_size=1, max_size=12,
)  # fmt: skip


def test_near_slight_turns_are_flown_faster_than_the_sharp_one_before_them() -> None:
    """Round a zone, a turn of 35° every 14 m after a right angle: it speeds up through the arcs, which leave no line between them."""
    bends = tuple((14 * math.cos(angle), 14 * math.sin(angle), 0.0) for angle in np.radians([90, 125, 160, 195]))
    ways = (200.0, 0.0, 0.0), *bends
    found = turning(*ways, speed_mps=12)
    own = turns_s(ways, seconds(ways, 12).tolist(), [True, *(False for _ in ways)], 3.0)
    assert found == pytest.approx(own, abs=0.1)
    assert found[1] > found[2] > found[3]


@given(legs, st.floats(4, 14), st.sets(st.integers(1, 12)))
def test_turns_take_what_the_judge_makes_of_them(drawn: list[Leg], speed_mps: float, stands: set[int]) -> None:
    ways = tuple(leg for leg in drawn if math.hypot(*leg) > 1.0)
    stops = tuple(stop for stop in stands if stop <= len(ways))
    own = turns_s(ways, seconds(ways, speed_mps).tolist(), [end in {0, *stops} for end in range(len(ways) + 1)], speed_mps / 4)
    found = turning(*ways, speed_mps=speed_mps, stands=stops) if ways else []
    assert all(one >= 0.0 for one in found)
    assert sum(found) == pytest.approx(sum(own), rel=0.02, abs=0.3)
