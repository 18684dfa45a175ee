"""From where the UAV is and what it is to follow to velocities and accelerations for the loops inside the model."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from simulation.flight.airframe import Airframe
from simulation.flight.course import Pace, Piece, Vector
from simulation.flight.governor import Governor, GovernorRules
from simulation.flight.reference import Reference


@dataclass(frozen=True, slots=True)
class GuidanceRules:
    """`pull_per_s`: m/s of correction for each metre off the reference, up to `most_pull_mps`; likewise up and down."""

    pull_per_s: float = 1.2
    most_pull_mps: float = 3.0
    lift_per_s: float = 1.2
    most_lift_mps: float = 1.5
    lead_s: float = 0.3
    slow_landing_mps: float = 0.6
    landing_slope_per_s: float = 0.18  # m/s for each metre above ground: the last 8 m take the 11 s that plans count


class Command(NamedTuple):
    """Velocity [m/s] and acceleration [m/s²] to east, north and up; `along` is the direction of the course."""

    velocity: Vector
    acceleration: Vector
    along: Vector


class Gate(NamedTuple):
    """Where a mark is, and how near it counts as passed."""

    place: Vector
    radius_m: float


STILL: Vector = (0.0, 0.0, 0.0)
GATE_LEASH_M = 1.0


class Guidance:
    """Follows a course, holds a place, or descends over one. `marks` are those that the UAV itself has passed in the last step.

    A mark is passed when the reference has been there and the UAV within the gate's radius of it. Until then the reference waits a little
    way beyond: no waypoint is left out because the wind blew the UAV past it.
    """

    def __init__(self, airframe: Airframe, rules: GuidanceRules | None = None, governor: GovernorRules | None = None) -> None:
        self._airframe = airframe
        self._rules = rules or GuidanceRules()
        self._governor = Governor(governor or GovernorRules())
        self._reference: Reference | None = None
        self._place: Vector = STILL
        self._is_descending = False
        self._gates: Mapping[int, Gate] = {}
        self._pending: list[int] = []
        self._beyond_m = 0.0
        self.marks: list[int] = []
        self.off_m = 0.0

    @property
    def pace(self) -> Pace:
        airframe = self._airframe
        return Pace(airframe.climb_mps, airframe.descent_mps, airframe.acceleration_mps2, airframe.corner_mps2)

    def follow(self, pieces: Sequence[Piece], velocity: Vector, gates: Mapping[int, Gate] | None = None) -> None:
        """`velocity` is what the UAV has; `gates` are those of the marks."""
        along = pieces[0].along if pieces else STILL
        speed_mps = max(sum(one * other for one, other in zip(velocity, along, strict=True)), 0.0)
        self._reference = Reference(pieces, speed_mps, self._airframe.acceleration_mps2)
        self._place = self._reference.end
        self._is_descending = False
        self._gates, self._pending = gates or {}, []

    def hold(self, place: Vector) -> None:
        self._reference, self._place, self._is_descending = None, place, False

    def descend(self, place: Vector) -> None:
        """Down to the ground over this place."""
        self._reference, self._place, self._is_descending = None, place, True

    @property
    def goal(self) -> Vector:
        """Where it will stand in the end."""
        return self._place

    @property
    def is_at_end(self) -> bool:
        """The reference stands where the course ends."""
        return self._reference is None or (self._reference.is_at_end and not self._pending)

    def step(self, dt_s: float, here: Vector, *, above_m: float, effort: float) -> Command:
        rules, reference = self._rules, self._reference
        self.marks = []
        if reference is None:
            command = self._to_place(here, above_m)
            self._governor.step(dt_s, lag_m=0.0, beside_m=0.0, effort=effort)
            return command
        away = (reference.place[0] - here[0], reference.place[1] - here[1], reference.place[2] - here[2])
        u, v, w = reference.along
        lag_m = away[0] * u + away[1] * v + away[2] * w
        self.off_m = math.sqrt(away[0] ** 2 + away[1] ** 2 + away[2] ** 2)
        beside_m = math.sqrt(max(self.off_m**2 - lag_m**2, 0.0))
        share = self._governor.step(dt_s, lag_m=lag_m, beside_m=beside_m, effort=effort)
        if self._pending and self._beyond_m > GATE_LEASH_M:
            share = 0.0
        self._pass_gates(reference.step(dt_s, share), reference.speed_mps * dt_s, here)
        (px, py, pz), (u, v, w), speed = reference.place, reference.along, reference.speed_mps
        pull = self._pull(px - here[0], py - here[1], pz - here[2])
        velocity = (u * speed + pull[0], v * speed + pull[1], w * speed + pull[2])
        return Command(velocity, reference.acceleration(rules.lead_s), reference.along)

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

    def _to_place(self, here: Vector, above_m: float) -> Command:
        away = (self._place[0] - here[0], self._place[1] - here[1], self._place[2] - here[2])
        east, north, up = self._pull(*away)
        self.off_m = math.sqrt(away[0] ** 2 + away[1] ** 2 + away[2] ** 2)
        if self._is_descending:
            rules = self._rules
            up = -min(self._airframe.descent_mps, max(rules.slow_landing_mps, rules.landing_slope_per_s * above_m))
        return Command((east, north, up), STILL, STILL)
