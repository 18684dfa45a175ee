"""The aircraft: in its air, over its ground, with its battery and its estimated position."""

import math
from dataclasses import dataclass
from enum import StrEnum
from random import Random

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from planning.energy.conditions import LAPSE_K_PER_M, SEA_LEVEL_K
from simulation.flight.airframe import Airframe
from simulation.flight.course import Vector
from simulation.flight.faults import Weather
from simulation.flight.plant import GUIDANCE_STEP_S, J_PER_WH, GroundElevation, Motion, Plant

DRIFT_MPS = 0.3  # per axis, drawn when the fix is lost: the error of dead reckoning by compass, airspeed and tilt with an estimated wind
WANDER_MPS = 0.03  # change of the drift in the first second; grows with the square root of time
CATCH_UP_S = 1.0  # until a new fix is used
MIN_V = 1.0
VERTICAL_SHARE = 0.25  # near the ground vertical gusts are weaker
KELVIN = 273.15
OFF_GROUND_M = 0.3  # above its standing height: in the air
STEADY_M = 0.2  # above its standing height: integrators of the control loops start
NEAR_GROUND_M = 0.5
OVERTURNED_RAD = math.radians(60.0)
HARD_DOWN_MPS, HARD_ALONG_MPS = 3.0, 2.5  # that the legs withstand
GROUND_EACH_M = 1.0  # flown distance after which the ground height is read again
LOW_M, LOW_GROUND_EACH_M = 15.0, 0.2
SEEDS_APART = 2_654_435_761  # separates the seeds of gusts, drift and turbulence (Knuth's multiplier)


class Navigation:
    """Position estimate; `error_m` is its error to east and north."""

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._drift_mps: tuple[float, float] | None = None
        self.error_m = (0.0, 0.0)

    def step(self, dt_s: float, *, is_gps_lost: bool) -> None:
        if not is_gps_lost:
            self._drift_mps = None
            if self.error_m != (0.0, 0.0):
                kept = math.exp(-dt_s / CATCH_UP_S)
                east, north = (part * kept for part in self.error_m)
                self.error_m = (east, north) if math.hypot(east, north) > 1e-3 else (0.0, 0.0)
            return
        draw = self._random.gauss
        if self._drift_mps is None:
            self._drift_mps = (draw(0.0, DRIFT_MPS), draw(0.0, DRIFT_MPS))
        east_mps, north_mps = self._drift_mps
        wander_mps = WANDER_MPS * math.sqrt(dt_s)
        self._drift_mps = (east_mps + draw(0.0, wander_mps), north_mps + draw(0.0, wander_mps))
        self.error_m = (self.error_m[0] + self._drift_mps[0] * dt_s, self.error_m[1] + self._drift_mps[1] * dt_s)


@dataclass(frozen=True, slots=True)
class Battery:
    """A battery with `left_wh` at the time when `used_wh` had been used; later use reduces it."""

    airframe: Airframe
    left_wh: float
    used_wh: float = 0.0

    @classmethod
    def charged(cls, airframe: Airframe, percent: float) -> "Battery":
        return cls(airframe, airframe.battery_wh * percent / 100.0)

    def left_after(self, used_wh: float) -> float:
        return max(self.left_wh - (used_wh - self.used_wh), 0.0)

    def percent_after(self, used_wh: float) -> float:
        return 100.0 * self.left_after(used_wh) / self.airframe.battery_wh

    def with_left(self, left_wh: float, used_wh: float) -> "Battery":
        """Return a weakened or replaced battery, from this moment on."""
        return Battery(self.airframe, min(left_wh, self.airframe.battery_wh), used_wh)

    def under_load(self, used_wh: float, power_w: float) -> tuple[float, float]:
        """Return volts and amperes: the open-circuit voltage falls with the charge, and with the current."""
        airframe = self.airframe
        share = self.left_after(used_wh) / airframe.battery_wh
        open_v = airframe.cells * (airframe.empty_cell_v + (airframe.full_cell_v - airframe.empty_cell_v) * share)
        # P = U I and U = open - R I: the root with the small current. Above the maximum power the voltage falls to half.
        under_root = max(open_v**2 - 4.0 * airframe.resistance_ohm * power_w, 0.0)
        volts = max(0.5 * (open_v + under_root**0.5), MIN_V)
        return volts, power_w / volts


class Gusts:
    """Gusts: the air's velocity relative to its mean, north, east and down [m/s], at each step, with given deviation and time constant.

    The process is exact for any step (G. E. Uhlenbeck, L. S. Ornstein, On the Theory of the Brownian Motion, 1930): its deviation does not
    depend on the step.
    """

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._ned = (0.0, 0.0, 0.0)

    def step(self, dt_s: float, deviation_mps: float, time_s: float) -> tuple[float, float, float]:
        if deviation_mps == 0.0 and self._ned == (0.0, 0.0, 0.0):
            return self._ned
        kept = math.exp(-dt_s / time_s)
        fresh = deviation_mps * math.sqrt(1.0 - kept * kept)
        north, east, down = self._ned
        draw = self._random.gauss
        self._ned = (
            kept * north + fresh * draw(0.0, 1.0),
            kept * east + fresh * draw(0.0, 1.0),
            kept * down + fresh * VERTICAL_SHARE * draw(0.0, 1.0),
        )
        return self._ned


class SurroundingAir:
    """The air around the UAV. `wind_ned_mps` is its velocity without the Dryden turbulence of JSBSim."""

    def __init__(self, plant: Plant, weather: Weather, *, ground_m: float, seed: int) -> None:
        self._plant = plant
        self._gusts = Gusts(seed)
        self._ground_m = ground_m
        self.wind_ned_mps = (0.0, 0.0, 0.0)
        self.weather = weather
        self.change(weather)

    def change(self, weather: Weather) -> None:
        self.weather = weather
        self._plant.set_turbulence(weather.turbulence_mps_at_20ft)
        standard_k = SEA_LEVEL_K - LAPSE_K_PER_M * self._ground_m
        self._plant.set_temperature(weather.conditions.temperature_c + KELVIN - standard_k)

    def step(self, agl_m: float) -> None:
        weather = self.weather
        east_mps, north_mps = weather.conditions.wind_at(agl_m) if weather.conditions.wind and math.isfinite(agl_m) else (0.0, 0.0)
        gust = self._gusts.step(GUIDANCE_STEP_S, weather.gusts_mps, weather.gust_time_s)
        wind = (north_mps + gust[0], east_mps + gust[1], gust[2])
        if wind != self.wind_ned_mps:
            self.wind_ned_mps = wind
            self._plant.set_wind(*wind)


class Contact(StrEnum):
    """Contact of a UAV in the air with the ground."""

    NONE = "none"
    SOFT = "soft"
    HARD = "hard"
    OVERTURNED = "overturned"


class Body:
    """The aircraft. Vectors are metres to east, north and up of its starting place."""

    def __init__(
        self,
        airframe: Airframe,
        home: LonLat,
        *,
        ground: GroundElevation,
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
        self.air = SurroundingAir(self.plant, weather, ground_m=self._ground_m, seed=seed * SEEDS_APART + 1)
        self._navigation = Navigation(seed * SEEDS_APART + 2)
        self._battery = Battery.charged(airframe, battery_percent)
        self._parked_j = 0.0
        self.motion: Motion = self.plant.motion
        self._before: Motion = self.motion

    # --- position ----------------------------------------------------------------------------------------------------------------------

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
        """Return its estimated position."""
        east_m, north_m = self._level(self.position)
        off_east_m, off_north_m = self._navigation.error_m
        return east_m + off_east_m, north_m + off_north_m, self.motion.altitude_amsl_m - self.home_amsl_m

    def _level(self, position: LonLat) -> tuple[float, float]:
        east_m = (position.lon - self.home.lon) * self.frame.metres_per_degree_east
        return east_m, (position.lat - self.home.lat) * self.frame.metres_per_degree_north

    # --- motion ------------------------------------------------------------------------------------------------------------------------

    def navigate(self, *, is_gps_lost: bool) -> None:
        self._navigation.step(GUIDANCE_STEP_S, is_gps_lost=is_gps_lost)

    def advance(self) -> None:
        """Advance one guidance step. Raises CameApart, and keeps the previous state then."""
        self._before = self.motion
        self.motion = self.plant.advance()
        self._survey()

    def park(self) -> None:
        """Advance one guidance step without motion; the avionics draw power."""
        self._parked_j += self.motion.power_w * GUIDANCE_STEP_S

    def stop(self) -> None:
        """Stop for good at its position."""
        self.motion = self.motion._replace(north_mps=0.0, east_mps=0.0, down_mps=0.0, power_w=0.0)

    def _survey(self) -> None:
        """Read the ground height after each flown distance; unknown ground keeps the previous height."""
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
        """Return its speed before the legs absorbed it."""
        return math.hypot(self._before.east_mps, self._before.north_mps, self._before.down_mps)

    # --- battery -----------------------------------------------------------------------------------------------------------------------

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
