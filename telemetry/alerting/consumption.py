"""Battery drain of a UAV by kind of flight: computed from its data, and corrected by the drain observed in the same kind."""

import math
from collections import deque
from dataclasses import dataclass, field
from enum import StrEnum

from inspection.geodesy import LonLat
from planning.energy.performance import Performance
from planning.energy.power import ground_speed_mps, power_w

USUAL_ENDURANCE_S = 1_200.0  # assumed without battery data: small multicopters fly for 20 to 40 minutes
J_PER_WH = 3_600.0
STILL_BELOW_MPS = 1.0  # over ground
CLIMBS_ABOVE_MPS = 0.7
MAX_GAP_S = 30.0  # between two reports: over a longer gap the kind of flight is unknown
MIN_LOST_PERCENT = 5.0  # minimum observed drain: reports come in whole percent
READ_WITHIN_PERCENT = 1.0
STEP_PERCENT = 1.0  # of expected drain, between two entries
STEPS_KEPT = 12
RATIOS = (0.7, 4.0)  # of observed to expected drain
CLIMB_MPS = 2.5  # ArduCopter's WPNAV_SPEED_UP; PX4's MPC_Z_V_AUTO_UP is 3
CLIMB_FACTOR = 1.3  # drain of a climb relative to level flight, if the UAV's power is unknown
DESCENT_MPS = 1.5  # PX4's MPC_Z_V_AUTO_DN, ArduCopter's WPNAV_SPEED_DN
LANDING_MPS, SLOW_BELOW_M = 0.7, 8.0  # PX4's MPC_LAND_SPEED; planning/rules.py
Wind = tuple[float, float]  # velocity of the air to east and north [m/s]


class FlightKind(StrEnum):
    MOVING = "moving"
    STILL = "still"
    CLIMBING = "climbing"


def kind_of(speed_mps: float, climb_mps: float) -> FlightKind:
    """Return the kind of flight, by speed over ground and upward."""
    if climb_mps > CLIMBS_ABOVE_MPS:
        return FlightKind.CLIMBING
    return FlightKind.STILL if speed_mps < STILL_BELOW_MPS else FlightKind.MOVING


@dataclass(frozen=True, slots=True)
class Consumption:
    """Drain of a UAV by its data. Without `performance` or its battery energy an endurance is assumed."""

    cruise_mps: float
    performance: Performance | None = None
    wind_mps: Wind = (0.0, 0.0)  # as planned

    @property
    def climb_mps(self) -> float:
        """Return the speed of a vertical climb."""
        return CLIMB_MPS if self.performance is None else self.performance.climb_speed_mps or CLIMB_MPS

    def percent_per_s(self, airspeed_mps: float, climb_mps: float = 0.0) -> float:
        """Return the drain of level flight or a climb [% of the full battery per second]."""
        performance = self.performance
        if performance is None or performance.battery_wh is None:
            return 100.0 / USUAL_ENDURANCE_S * (CLIMB_FACTOR if climb_mps > 0.0 else 1.0)
        return power_w(performance, airspeed_mps=airspeed_mps, climb_mps=climb_mps) / J_PER_WH * 100.0 / performance.battery_wh

    def way(self, east_m: float, north_m: float, height_m: float, wind_mps: Wind) -> tuple[float, float, float]:
        """Return seconds of flight, seconds of landing and airspeed [m/s] for a straight leg with a landing at its end.

        Seconds are infinite if the wind leaves no headway. height_m: of the UAV above the landing place.
        """
        sinks_s = max(height_m - SLOW_BELOW_M, 0.0) / DESCENT_MPS + min(max(height_m, 0.0), SLOW_BELOW_M) / LANDING_MPS
        distance_m = math.hypot(east_m, north_m)
        if distance_m < 1.0:
            return 0.0, sinks_s, 0.0
        limit_mps = None if self.performance is None else self.performance.max_airspeed_mps
        course_deg = math.degrees(math.atan2(east_m, north_m))
        speed_mps = ground_speed_mps(course_deg, limit_mps, self.cruise_mps, wind_mps)
        if speed_mps is None:
            return math.inf, sinks_s, 0.0
        air_mps = math.hypot(east_m / distance_m * speed_mps - wind_mps[0], north_m / distance_m * speed_mps - wind_mps[1])
        return distance_m / speed_mps, sinks_s, air_mps


@dataclass
class Drained:
    """Expected and reported drain of one kind of flight [% of the full battery]."""

    expected: float = 0.0
    lost: float = 0.0
    runs: int = 0  # of consecutive reports, each beginning and ending with a reading
    steps: deque[tuple[float, float, int]] = field(default_factory=lambda: deque([(0.0, 0.0, 0)], maxlen=STEPS_KEPT + 1))

    def add(self, expected: float, lost: float) -> None:
        self.expected, self.lost = self.expected + expected, self.lost + lost
        if self.expected - self.steps[-1][0] >= STEP_PERCENT:
            self.steps.append((self.expected, self.lost, self.runs))

    @property
    def ratio(self) -> float | None:
        """Return observed to expected drain, recent or of the whole flight, whichever is more; None with too little data."""
        found = [
            (self.lost - lost - _read_within(self.runs - runs)) / (self.expected - expected)
            for expected, lost, runs in self.steps
            if self.lost - lost >= MIN_LOST_PERCENT + READ_WITHIN_PERCENT and self.expected > expected
        ]
        if self.lost >= MIN_LOST_PERCENT:
            found.append(_beyond(self.lost, self.expected, _read_within(self.runs - 1)) / self.expected)
        return min(max(*RATIOS[:1], *found), RATIOS[1]) if found else None


def _read_within(more_runs: int) -> float:
    """Return the reading error [%] of the drain over one run of reports and `more_runs` more."""
    return READ_WITHIN_PERCENT * math.sqrt(1 + max(more_runs, 0))


def _beyond(lost: float, expected: float, within: float) -> float:
    """Return the observed drain, moved towards the expected one by up to the reading error."""
    return min(max(expected, lost - within), lost + within)


@dataclass
class DrainState:
    """Observed drain of one flight."""

    of_kind: dict[FlightKind, Drained] = field(default_factory=lambda: {kind: Drained() for kind in FlightKind})
    last: tuple[float, float] | None = None  # measured at, percent left
    kind: FlightKind = FlightKind.STILL
    still_lost: float = 0.0  # since it came to a stop

    def note(self, measured_s: float, left_percent: float, kind: FlightKind, expected_per_s: float, clock_rate: float) -> None:
        """Add the drain since the previous report. A rising percentage restarts: the battery was charged or changed."""
        before, self.last = self.last, (measured_s, left_percent)
        was, self.kind = self.kind, kind
        if before is None or measured_s <= before[0]:
            self.last = before or self.last
            return
        seconds, lost = (measured_s - before[0]) * clock_rate, before[1] - left_percent
        if lost < -2.0 * READ_WITHIN_PERCENT or seconds > MAX_GAP_S:
            self.still_lost = 0.0
            return
        self.still_lost = self.still_lost + lost if kind is FlightKind.STILL is was else 0.0
        if kind is was:
            self.of_kind[kind].add(expected_per_s * seconds, lost)
        else:  # the moment of the change in between is unknown
            self.of_kind[kind].runs += 1

    def ratio(self, kind: FlightKind) -> float:
        """Return observed to expected drain of one kind of flight; 1 with too little data."""
        found = self.of_kind[kind].ratio
        return 1.0 if found is None else found


def east_north_m(start: LonLat, end: LonLat) -> tuple[float, float]:
    """Return the offset from one position to another on a flat Earth: within 1 % over some 20 km."""
    degree_m = 111_195.0
    return (end.lon - start.lon) * degree_m * math.cos(math.radians(start.lat)), (end.lat - start.lat) * degree_m
