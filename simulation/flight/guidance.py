"""Guidance: computes velocities and accelerations for the model's control loops from the UAV's position and its course."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from simulation.flight.airframe import Airframe
from simulation.flight.course import Piece, SpeedLimits, Vector

NEAR_ENOUGH_M = 0.01
MIN_SPEED_MPS = 0.1  # so that an end is reached, not only approached
STILL: Vector = (0.0, 0.0, 0.0)
GATE_LEASH_M = 1.0


@dataclass(frozen=True, slots=True)
class SpeedLimiterRules:
    """The reference slows down when the UAV lags by `lag_m` and waits at `most_lag_m`; likewise for lateral distance.

    `effort` is the used share of the horizontal acceleration. Above `high_effort` the speed falls by up to `fall_per_s` of itself per
    second; below `low_effort` it recovers by `rise_per_s`.
    """

    lag_m: float = 0.8
    most_lag_m: float = 3.0
    beside_m: float = 0.4
    most_beside_m: float = 1.5
    high_effort: float = 0.85
    low_effort: float = 0.7
    fall_per_s: float = 1.5
    rise_per_s: float = 0.15
    effort_time_s: float = 0.4


class SpeedLimiter:
    def __init__(self, rules: SpeedLimiterRules) -> None:
        self._rules = rules
        self._effort = 0.0
        self._share = 1.0

    def step(self, dt_s: float, *, lag_m: float, beside_m: float, effort: float) -> float:
        """Return the share of its speed that the reference may use, 0 to 1."""
        rules = self._rules
        self._effort += min(dt_s / rules.effort_time_s, 1.0) * (min(effort, 2.0) - self._effort)
        if self._effort > rules.high_effort:
            self._share -= rules.fall_per_s * dt_s * min((self._effort - rules.high_effort) / 0.15, 1.0) * max(self._share, 0.1)
        elif self._effort < rules.low_effort:
            self._share += rules.rise_per_s * dt_s
        self._share = min(max(self._share, 0.05), 1.0)
        behind = _falling(lag_m, rules.lag_m, rules.most_lag_m)
        return self._share * behind * _falling(abs(beside_m), rules.beside_m, rules.most_beside_m)


def _falling(value: float, begins: float, ends: float) -> float:
    """Return 1 up to `begins`, 0 from `ends` on, linear between."""
    return min(max((ends - value) / (ends - begins), 0.0), 1.0)


class Reference:
    """Reference point on a course.

    `place`, `along`, `speed_mps` and its derivative `gain_mps2` are updated by each step. `is_at_end` is set once it stops at the last
    point.
    """

    def __init__(self, pieces: Sequence[Piece], speed_mps: float, acceleration_mps2: float) -> None:
        self._pieces = pieces
        self._number, self._s_m = 0, 0.0
        self._acceleration_mps2 = acceleration_mps2
        self.speed_mps, self.gain_mps2 = speed_mps, 0.0
        self.is_at_end = not pieces
        self._is_ordered = False
        self.place, self.along, self._curve = pieces[0].at(0.0) if pieces else ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0)

    def step(self, dt_s: float, share: float) -> list[int]:
        """Advance one step at this share of the permitted speed. Returns the passed marks."""
        marks: list[int] = []
        if self.is_at_end:
            self.speed_mps, self.gain_mps2 = 0.0, 0.0
            return marks
        piece = self._pieces[self._number]
        left_m = piece.length_m - self._s_m
        in_time_mps = math.sqrt(piece.end_mps**2 + 2.0 * self._acceleration_mps2 * max(left_m, 0.0))
        wanted_mps = max(min(piece.fastest_mps * share, in_time_mps), min(MIN_SPEED_MPS, share * MIN_SPEED_MPS))
        change_mps = self._acceleration_mps2 * dt_s
        # Braking follows the course, whose deceleration limit equals the acceleration limit.
        speed_mps = (
            min(wanted_mps, self.speed_mps + change_mps)
            if wanted_mps > self.speed_mps
            else max(wanted_mps, self.speed_mps - 1.5 * change_mps)
        )
        self.gain_mps2 = (speed_mps - self.speed_mps) / dt_s
        self._s_m += 0.5 * (speed_mps + self.speed_mps) * dt_s
        self.speed_mps = speed_mps
        while True:
            piece = self._pieces[self._number]
            is_past = self._s_m >= piece.length_m - NEAR_ENOUGH_M
            if piece.mark is not None and not self._is_ordered and (is_past or (piece.radius_m and self._s_m >= 0.5 * piece.length_m)):
                marks.append(piece.mark)
                self._is_ordered = True
            if not is_past:
                break
            if self._number + 1 == len(self._pieces):
                self.is_at_end, self._s_m = True, piece.length_m
                self.speed_mps = 0.0
                break
            self._s_m = max(self._s_m - piece.length_m, 0.0)
            self._number += 1
            self._is_ordered = False
        self.place, self.along, self._curve = self._pieces[self._number].at(self._s_m)
        return marks

    def acceleration(self, lead_s: float) -> Vector:
        """Return the acceleration of the course [m/s²]: lateral as in `lead_s`, the time to change attitude, and along it now."""
        gain = self.gain_mps2
        u, v, w = self.along
        number, s_m = self._number, self._s_m + self.speed_mps * lead_s
        while s_m > self._pieces[number].length_m and number + 1 < len(self._pieces):
            s_m -= self._pieces[number].length_m
            number += 1
        piece = self._pieces[number]
        if piece.radius_m == 0.0 or self.is_at_end:
            return gain * u, gain * v, gain * w
        a, b, c = piece.bend(min(s_m, piece.length_m))
        side = self.speed_mps**2 / piece.radius_m
        return gain * u + side * a, gain * v + side * b, gain * w + side * c

    @property
    def end(self) -> Vector:
        return self._pieces[-1].at(self._pieces[-1].length_m)[0] if self._pieces else self.place


@dataclass(frozen=True, slots=True)
class GuidanceRules:
    """`pull_per_s`: m/s of correction per metre from the reference, up to `most_pull_mps`; likewise vertically."""

    pull_per_s: float = 1.2
    most_pull_mps: float = 3.0
    lift_per_s: float = 1.2
    most_lift_mps: float = 1.5
    lead_s: float = 0.3
    slow_landing_mps: float = 0.6
    landing_slope_per_s: float = 0.18  # m/s per metre above ground: the last 8 m take 11 s, as in plans


class GuidanceCommand(NamedTuple):
    """Velocity [m/s] and acceleration [m/s²] to east, north and up; `along` is the direction of the course."""

    velocity: Vector
    acceleration: Vector
    along: Vector


class Gate(NamedTuple):
    """Place of a mark, and the radius within which it counts as passed."""

    place: Vector
    radius_m: float


class Guidance:
    """Follows a course, holds a place, or descends above one. `marks` are those that the UAV passed in the last step.

    A mark is passed when the reference has passed it and the UAV has been within the gate's radius. Until then the reference waits shortly
    beyond it, so that no waypoint is missed when wind drives the UAV past it.
    """

    def __init__(self, airframe: Airframe, rules: GuidanceRules | None = None, speed_limiter: SpeedLimiterRules | None = None) -> None:
        self._airframe = airframe
        self._rules = rules or GuidanceRules()
        self._speed_limiter = SpeedLimiter(speed_limiter or SpeedLimiterRules())
        self._reference: Reference | None = None
        self._place: Vector = STILL
        self._is_descending = False
        self._gates: Mapping[int, Gate] = {}
        self._pending: list[int] = []
        self._beyond_m = 0.0
        self.marks: list[int] = []
        self.off_m = 0.0

    @property
    def speed_limits(self) -> SpeedLimits:
        airframe = self._airframe
        return SpeedLimits(airframe.climb_mps, airframe.descent_mps, airframe.acceleration_mps2, airframe.corner_mps2)

    def follow(self, pieces: Sequence[Piece], velocity: Vector, gates: Mapping[int, Gate] | None = None) -> None:
        """Follow a course. `velocity` is the UAV's; `gates` are those of the marks."""
        along = pieces[0].along if pieces else STILL
        speed_mps = max(sum(one * other for one, other in zip(velocity, along, strict=True)), 0.0)
        self._reference = Reference(pieces, speed_mps, self._airframe.acceleration_mps2)
        self._place = self._reference.end
        self._is_descending = False
        self._gates, self._pending = gates or {}, []

    def hold(self, place: Vector) -> None:
        self._reference, self._place, self._is_descending = None, place, False

    def descend(self, place: Vector) -> None:
        """Descend to the ground above this place."""
        self._reference, self._place, self._is_descending = None, place, True

    @property
    def goal(self) -> Vector:
        """Return the place where it will stop."""
        return self._place

    @property
    def is_at_end(self) -> bool:
        """Return whether the reference has stopped at the end of the course."""
        return self._reference is None or (self._reference.is_at_end and not self._pending)

    def step(self, dt_s: float, here: Vector, *, above_m: float, effort: float) -> GuidanceCommand:
        rules, reference = self._rules, self._reference
        self.marks = []
        if reference is None:
            command = self._to_place(here, above_m)
            self._speed_limiter.step(dt_s, lag_m=0.0, beside_m=0.0, effort=effort)
            return command
        away = (reference.place[0] - here[0], reference.place[1] - here[1], reference.place[2] - here[2])
        u, v, w = reference.along
        lag_m = away[0] * u + away[1] * v + away[2] * w
        self.off_m = math.sqrt(away[0] ** 2 + away[1] ** 2 + away[2] ** 2)
        beside_m = math.sqrt(max(self.off_m**2 - lag_m**2, 0.0))
        share = self._speed_limiter.step(dt_s, lag_m=lag_m, beside_m=beside_m, effort=effort)
        if self._pending and self._beyond_m > GATE_LEASH_M:
            share = 0.0
        self._pass_gates(reference.step(dt_s, share), reference.speed_mps * dt_s, here)
        (px, py, pz), (u, v, w), speed = reference.place, reference.along, reference.speed_mps
        pull = self._pull(px - here[0], py - here[1], pz - here[2])
        velocity = (u * speed + pull[0], v * speed + pull[1], w * speed + pull[2])
        return GuidanceCommand(velocity, reference.acceleration(rules.lead_s), reference.along)

    def _pass_gates(self, marks: list[int], moved_m: float, here: Vector) -> None:
        if not self._pending:
            self._beyond_m = 0.0
        self._pending += marks
        self._beyond_m += moved_m
        while self._pending:
            gate = self._gates.get(self._pending[0])
            if gate is not None and math.dist(gate.place, here) > gate.radius_m:
                break
            self.marks.append(self._pending.pop(0))

    def _pull(self, east_m: float, north_m: float, up_m: float) -> Vector:
        rules = self._rules
        east, north = rules.pull_per_s * east_m, rules.pull_per_s * north_m
        strength = math.hypot(east, north)
        if strength > rules.most_pull_mps:
            east, north = east * rules.most_pull_mps / strength, north * rules.most_pull_mps / strength
        return east, north, min(max(rules.lift_per_s * up_m, -rules.most_lift_mps), rules.most_lift_mps)

    def _to_place(self, here: Vector, above_m: float) -> GuidanceCommand:
        away = (self._place[0] - here[0], self._place[1] - here[1], self._place[2] - here[2])
        east, north, up = self._pull(*away)
        self.off_m = math.sqrt(away[0] ** 2 + away[1] ** 2 + away[2] ** 2)
        if self._is_descending:
            rules = self._rules
            up = -min(self._airframe.descent_mps, max(rules.slow_landing_mps, rules.landing_slope_per_s * above_m))
        return GuidanceCommand((east, north, up), STILL, STILL)
