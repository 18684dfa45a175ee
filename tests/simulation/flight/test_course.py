"""The way through waypoints: whole, smooth, within its corners, and no faster than it can be flown."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulation.flight.course import CORNER_M, Piece, SpeedLimits, Vector, Via, course
from simulation.flight.guidance import Reference

SPEED_LIMITS = SpeedLimits(climb_mps=2.0, descent_mps=1.5, acceleration_mps2=2.0, corner_mps2=2.5)
NUMBER = st.floats(-300.0, 300.0).map(lambda value: round(value, 2))
POINTS = st.lists(st.tuples(NUMBER, NUMBER, NUMBER), min_size=1, max_size=8)


def drawn(points: list[Vector], speed_mps: float = 5.0) -> tuple[Piece, ...]:
    return course((0.0, 0.0, 0.0), [Via(point, speed_mps, mark) for mark, point in enumerate(points)], SPEED_LIMITS)


@settings(max_examples=150, deadline=None)
@given(POINTS, st.floats(0.5, 20.0))
def test_course_is_one_way_without_gaps_through_all_waypoints(points: list[Vector], speed_mps: float) -> None:
    pieces = drawn(points, speed_mps)
    assert math.dist(pieces[0].at(0.0)[0], (0.0, 0.0, 0.0)) < 1e-9
    assert math.dist(pieces[-1].at(pieces[-1].length_m)[0], points[-1]) < 0.06  # less than a leg is none
    for piece, follows in pairwise(pieces):
        assert math.dist(piece.at(piece.length_m)[0], follows.at(0.0)[0]) < 1e-6
    assert [piece.mark for piece in pieces if piece.mark is not None] == list(range(len(points)))
    for piece in pieces:
        if piece.mark is not None:
            passed, _, _ = piece.at(0.5 * piece.length_m if piece.radius_m else piece.length_m)
            assert math.dist(passed, points[piece.mark]) < CORNER_M + 0.06


@settings(max_examples=150, deadline=None)
@given(POINTS, st.floats(0.5, 20.0))
def test_no_piece_is_left_faster_than_the_rest_allows(points: list[Vector], speed_mps: float) -> None:
    pieces = drawn(points, speed_mps)
    assert pieces[-1].end_mps == 0.0
    for piece, follows in pairwise(pieces):
        slowed = math.sqrt(follows.end_mps**2 + 2.0 * SPEED_LIMITS.acceleration_mps2 * follows.length_m)
        assert piece.end_mps <= min(piece.fastest_mps, follows.fastest_mps, slowed) + 1e-9
        if piece.radius_m:
            assert piece.fastest_mps**2 / piece.radius_m <= SPEED_LIMITS.corner_mps2 + 1e-9
        elif piece.length_m > 0.1:
            assert -SPEED_LIMITS.descent_mps - 1e-6 <= piece.along[2] * piece.fastest_mps <= SPEED_LIMITS.climb_mps + 1e-6
            assert math.hypot(*piece.along[:2]) * piece.fastest_mps <= speed_mps + 1e-6


@settings(max_examples=60, deadline=None)
@given(POINTS, st.integers(0, 1000))
def test_reference_comes_to_the_end_and_tells_each_mark_once(points: list[Vector], seed: int) -> None:
    pieces = drawn(points)
    reference = Reference(pieces, 0.0, SPEED_LIMITS.acceleration_mps2)
    marks, before = [], reference.place
    for number in range(60_000):
        marks += reference.step(0.04, 0.4 + 0.6 * ((number * 7919 + seed) % 100) / 100)
        assert math.dist(reference.place, before) <= 21.0 * 0.04
        before = reference.place
        if reference.is_at_end:
            break
    assert reference.is_at_end
    assert marks == list(range(len(points)))
    assert all(math.isfinite(part) for part in reference.acceleration(0.3))


def test_sharper_turns_are_flown_slower() -> None:
    def corner_mps(turn_deg: float) -> float:
        turn = math.radians(turn_deg)
        pieces = drawn([(100.0, 0.0, 0.0), (100.0 + 100.0 * math.cos(turn), 100.0 * math.sin(turn), 0.0)])
        return pieces[0].end_mps

    speeds = [corner_mps(turn_deg) for turn_deg in (0.0, 10.0, 30.0, 60.0, 90.0, 120.0, 180.0)]
    assert speeds == sorted(speeds, reverse=True)
    assert speeds[0] == speeds[1] == 5.0
    assert speeds[-1] == 0.0
    # By hand, 90 degrees: radius 1.3 / (sqrt(2) - 1) = 3.138 m, sqrt(2.5 * 3.138) = 2.801 m/s.
    assert speeds[4] == pytest.approx(2.801, abs=1e-3)


def test_short_legs_are_slowed_down_for_in_time() -> None:
    """Steps of one metre to the side, one after the other, at the end of a long leg: its end is flown as slowly as they need."""
    points = [(100.0, 0.0, 0.0), (100.0, 1.0, 0.0), (101.0, 1.0, 0.0), (101.0, 2.0, 0.0)]
    pieces = drawn(points)
    assert pieces[0].end_mps < 1.2
