"""The aircraft itself: in its air, over its ground, on its battery, with what it knows of its place."""

import math
from enum import StrEnum

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from simulation.flight.air import Air
from simulation.flight.airframe import Airframe
from simulation.flight.battery import Battery
from simulation.flight.course import Vector
from simulation.flight.ground import Ground
from simulation.flight.navigation import Navigation
from simulation.flight.plant import GUIDANCE_STEP_S, J_PER_WH, Motion, Plant
from simulation.flight.weather import Weather

OFF_GROUND_M = 0.3  # above standing: from here on it flies
STEADY_M = 0.2  # above standing: from here on the loops may integrate
NEAR_GROUND_M = 0.5
OVERTURNED_RAD = math.radians(60.0)
HARD_DOWN_MPS, HARD_ALONG_MPS = 3.0, 2.5  # what the legs bear
GROUND_EACH_M = 1.0  # the ground is asked for its height each time so far has been flown
LOW_M, LOW_GROUND_EACH_M = 15.0, 0.2
SEEDS_APART = 2_654_435_761  # keeps the draws of gusts, drift and turbulence apart (Knuth's multiplier)


class Contact(StrEnum):
    """Of a UAV in the air with the ground."""

    NONE = "none"
    SOFT = "soft"
    HARD = "hard"
    OVERTURNED = "overturned"


class Body:
    """Vectors are metres to east, north and up of where it stood first."""

    def __init__(
        self,
        airframe: Airframe,
        home: LonLat,
        *,
        ground: Ground,
        weather: Weather,
        seed: int,
        heading_deg: float,
        battery_percent: float,
        physics_hz: int,
    ) -> None:
        ground_m = ground.elevation_m(home)
        self.home_amsl_m = self._ground_m = ground_m if math.isfinite(ground_m) else 0.0
        self._ground, self._ground_at = ground, home
        self.home, self.frame = home, LocalFrame.around(home.lon, home.lat)
        self.plant = Plant(airframe, home, ground_m=self._ground_m, heading_deg=heading_deg, seed=seed, physics_hz=physics_hz)
        self.air = Air(self.plant, weather, ground_m=self._ground_m, seed=seed * SEEDS_APART + 1)
        self._navigation = Navigation(seed * SEEDS_APART + 2)
        self._battery = Battery.charged(airframe, battery_percent)
        self._parked_j = 0.0
        self.motion: Motion = self.plant.motion
        self._before: Motion = self.motion

    # --- where it is ---------------------------------------------------------------------------------------------------------------

    @property
    def position(self) -> LonLat:
        return LonLat(self.motion.lon_deg, self.motion.lat_deg)

    @property
    def agl_m(self) -> float:
        return self.motion.altitude_amsl_m - self._ground_m

    @property
    def above_standing_m(self) -> float:
        return self.agl_m - self.plant.leg_m

    @property
    def velocity(self) -> Vector:
        return self.motion.east_mps, self.motion.north_mps, -self.motion.down_mps

    def believed(self) -> Vector:
        """Where it takes itself to be."""
        east_m, north_m = self._level(self.position)
        off_east_m, off_north_m = self._navigation.error_m
        return east_m + off_east_m, north_m + off_north_m, self.motion.altitude_amsl_m - self.home_amsl_m

    def _level(self, position: LonLat) -> tuple[float, float]:
        east_m = (position.lon - self.home.lon) * self.frame.metres_per_degree_east
        return east_m, (position.lat - self.home.lat) * self.frame.metres_per_degree_north

    # --- what happens to it --------------------------------------------------------------------------------------------------------

    def navigate(self, *, is_gps_lost: bool) -> None:
        self._navigation.step(GUIDANCE_STEP_S, is_gps_lost=is_gps_lost)

    def advance(self) -> None:
        """One guidance step. Raises CameApart, and is then where it was before."""
        self._before = self.motion
        self.motion = self.plant.advance()
        self._survey()

    def park(self) -> None:
        """One guidance step in which nothing moves and the avionics are on."""
        self._parked_j += self.motion.power_w * GUIDANCE_STEP_S

    def stop(self) -> None:
        """For good, where it is."""
        self.motion = self.motion._replace(north_mps=0.0, east_mps=0.0, down_mps=0.0, power_w=0.0)

    def _survey(self) -> None:
        """The ground below, asked for each time that some way has been flown; unknown ground is as it was before."""
        position = self.position
        (east_m, north_m), (at_east_m, at_north_m) = self._level(position), self._level(self._ground_at)
        if math.hypot(east_m - at_east_m, north_m - at_north_m) <= (GROUND_EACH_M if self.agl_m > LOW_M else LOW_GROUND_EACH_M):
            return
        self._ground_at = position
        ground_m = self._ground.elevation_m(position)
        if math.isfinite(ground_m) and ground_m != self._ground_m:
            self._ground_m = ground_m
            self.plant.set_ground_m(ground_m)

    def contact(self) -> Contact:
        if self.above_standing_m > NEAR_GROUND_M:
            return Contact.NONE
        if max(abs(self.motion.roll_rad), abs(self.motion.pitch_rad)) > OVERTURNED_RAD:
            return Contact.OVERTURNED
        if not self.plant.legs_down:
            return Contact.NONE
        is_hard = self._before.down_mps > HARD_DOWN_MPS or math.hypot(self._before.east_mps, self._before.north_mps) > HARD_ALONG_MPS
        return Contact.HARD if is_hard else Contact.SOFT

    @property
    def impact_mps(self) -> float:
        """How fast it was before the legs took it up."""
        return math.hypot(self._before.east_mps, self._before.north_mps, self._before.down_mps)

    # --- its battery ---------------------------------------------------------------------------------------------------------------

    @property
    def used_wh(self) -> float:
        return (self.motion.used_j + self._parked_j) / J_PER_WH

    @property
    def battery_percent(self) -> float:
        return self._battery.percent_after(self.used_wh)

    def weaken(self, left_wh: float) -> None:
        self._battery = self._battery.with_left(left_wh, self.used_wh)

    def volts_and_amperes(self) -> tuple[float, float]:
        return self._battery.under_load(self.used_wh, self.motion.power_w)
