"""A stabilised gimbal: turns its camera to a place or by angles, within its limits and at a limited rate."""

import math
from dataclasses import dataclass

from planning.views.camera import Gimbal
from simulation.flight.course import Vector

RATE_DPS = 60.0  # of each axis
MIN_AWAY_M = 0.5  # beside a place straight below or above, any heading is right


@dataclass(frozen=True, slots=True)
class GimbalAttitude:
    """Where the camera looks: pitch from the horizon, negative down; yaw from the nose, clockwise. `is_locked`: it keeps to the earth."""

    pitch_deg: float = 0.0
    yaw_deg: float = 0.0
    is_locked: bool = False


AHEAD = GimbalAttitude()


class StabilisedGimbal:
    """The gimbal of one UAV. Its camera stays level and keeps its pitch from the horizon, however the UAV tilts.

    Without a range of yaw the camera looks where the nose points; then a UAV turns for a place to look at, as ArduCopter and PX4 do.
    """

    def __init__(self, limits: Gimbal) -> None:
        self.limits = limits
        self.target: Vector | None = None
        self._pitch_deg = self._wanted_pitch_deg = _within(0.0, limits.pitch_min_deg, limits.pitch_max_deg)
        self._yaw_deg = self._wanted_yaw_deg = 0.0
        self._is_from_north = False

    @property
    def pans(self) -> bool:
        return self.limits.yaw_min_deg is not None and self.limits.yaw_max_deg is not None

    @property
    def attitude(self) -> GimbalAttitude:
        return GimbalAttitude(self._pitch_deg, self._yaw_deg, self.target is not None or self._is_from_north)

    def look_at(self, target: Vector) -> None:
        """Follow a place, in metres to east, north and up of the home."""
        self.target = target

    def turn(self, pitch_deg: float | None, yaw_deg: float | None, *, is_from_north: bool) -> None:
        """Turn by angles; None leaves the present one. `is_from_north`: keep the yaw from true north, else from the nose."""
        if self.target is not None:
            self._wanted_pitch_deg, self._wanted_yaw_deg, self._is_from_north = self._pitch_deg, self._yaw_deg, False
        self.target = None
        if pitch_deg is not None:
            self._wanted_pitch_deg = pitch_deg
        if yaw_deg is not None:
            self._wanted_yaw_deg, self._is_from_north = yaw_deg, is_from_north

    def centre(self) -> None:
        """Look ahead along the horizon."""
        self.turn(0.0, 0.0, is_from_north=False)

    def step(self, dt_s: float, here: Vector, heading_deg: float) -> None:
        pitch_deg, yaw_deg = self._wanted(here, heading_deg)
        most_deg = RATE_DPS * dt_s
        limits = self.limits
        pitch_deg = _within(pitch_deg, limits.pitch_min_deg, limits.pitch_max_deg)
        self._pitch_deg += _within(pitch_deg - self._pitch_deg, -most_deg, most_deg)
        if limits.yaw_min_deg is not None and limits.yaw_max_deg is not None:
            yaw_deg = _nearest_turn(yaw_deg, self._yaw_deg, limits.yaw_min_deg, limits.yaw_max_deg)
            self._yaw_deg += _within(yaw_deg - self._yaw_deg, -most_deg, most_deg)

    def _wanted(self, here: Vector, heading_deg: float) -> tuple[float, float]:
        """Return pitch, and yaw from the nose."""
        if self.target is None:
            return self._wanted_pitch_deg, self._wanted_yaw_deg - (heading_deg if self._is_from_north else 0.0)
        east_m, north_m, up_m = (goal - own for goal, own in zip(self.target, here, strict=True))
        away_m = math.hypot(east_m, north_m)
        pitch_deg = math.degrees(math.atan2(up_m, away_m))
        if away_m < MIN_AWAY_M:
            return pitch_deg, self._yaw_deg
        return pitch_deg, math.degrees(math.atan2(east_m, north_m)) - heading_deg


def _within(value: float, least: float, most: float) -> float:
    return min(max(value, least), most)


def _nearest_turn(wanted_deg: float, present_deg: float, least_deg: float, most_deg: float) -> float:
    """Return the angle of this direction that is nearest to the present one within the limits, else the nearest limit."""
    turned = wanted_deg + 360.0 * round((present_deg - wanted_deg) / 360.0)
    reachable = [angle for angle in (turned, turned - 360.0, turned + 360.0) if least_deg <= angle <= most_deg]
    return min(reachable, key=lambda angle: abs(angle - present_deg), default=_within(turned, least_deg, most_deg))
