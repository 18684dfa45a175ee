"""The flight model in SI units: placed on the ground, stepped, read and written; NaN stops it."""

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple, Protocol
from xml.etree import ElementTree

import jsbsim
import numpy as np

from inspection.geodesy import LonLat
from simulation.flight.airframe import Airframe
from simulation.flight.faults import MOTORS

ROTORS = 4
AXES = ("thrust", "roll", "pitch", "yaw")
FOOT_M = 0.3048
GUIDANCE_STEP_S = 0.04
PHYSICS_HZ = (250, 125, 100)  # below 100 Hz the springs of the legs are not resolved
J_PER_WH = 3600.0
MAX_HEIGHT_M = 20_000.0  # above it, or as deep below ground, the model has diverged
_READ = (
    "position/long-gc-deg",
    "position/lat-geod-deg",
    "position/h-sl-meters",
    "velocities/v-north-fps",
    "velocities/v-east-fps",
    "velocities/v-down-fps",
    "attitude/phi-rad",
    "attitude/theta-rad",
    "attitude/psi-rad",
    "velocities/p-rad_sec",
    "velocities/q-rad_sec",
    "velocities/r-rad_sec",
    "control/effort",
    "battery/used-j",
    "battery/power-w",
)
_VELOCITY = slice(3, 6)  # of these, in feet per second
_SET_POINTS = (
    "setpoint/north-mps",
    "setpoint/east-mps",
    "setpoint/down-mps",
    "setpoint/accel-north-mps2",
    "setpoint/accel-east-mps2",
    "setpoint/accel-down-mps2",
    "setpoint/heading-rad",
)


class GroundElevation(Protocol):
    """Returns the ground height AMSL [m]; NaN if unknown."""

    def elevation_m(self, position: LonLat) -> float: ...


@dataclass(frozen=True, slots=True)
class FlatGround:
    """Ground of constant height."""

    height_m: float = 0.0

    def elevation_m(self, position: LonLat) -> float:
        return self.height_m


MODELS = Path(__file__).resolve().parent.parent / "aircraft_models"


def flight_model(code: str, step_s: float, seed: int) -> jsbsim.FGFDMExec:
    """Return the model of an airframe, without a position. Raises ValueError if its file cannot be loaded."""
    jsbsim.set_logger(jsbsim.DefaultLogger(jsbsim.LogLevel.ERROR))
    model = jsbsim.FGFDMExec(str(MODELS))
    model.set_debug_level(0)
    model.set_aircraft_path(str(MODELS))
    model.set_systems_path(str(MODELS / "systems"))
    model.set_dt(step_s)  # before loading: filters and integrators take the step that is set then
    if not model.load_model(code):
        raise ValueError(f"The airframe {code!r} has no model file that can be loaded.")
    model["simulation/randomseed"] = seed % 2**31
    for axis, row in zip(AXES, mixer_of(code), strict=True):
        for number, share in enumerate(row, start=1):
            model[f"mixer/{axis}-{number}"] = share
    return model


@lru_cache
def mixer_of(code: str) -> tuple[tuple[float, ...], ...]:
    """Return the thrust of each rotor [N] per newton of thrust and per newton metre about each axis: (axes, rotors).

    It is the inverse of the rotors' effect at their places in the model file.
    """
    root = ElementTree.parse(MODELS / code / f"{code}.xml").getroot()  # noqa: S314 - our own file
    figures = {(node.text or "").strip(): node.get("value") for node in root.findall("./system/property")}
    reaction_m = float(figures.get("figure/moment-m") or "nan")
    turning = root.find("./external_reactions/moment/function/product/difference")
    if turning is None:
        raise ValueError(f"The airframe {code!r} has no reaction of its rotors.")
    clockwise = {(node.text or "").strip() for node in turning[1].iter("property")}
    effects = []
    for number in range(1, ROTORS + 1):
        place = root.find(f"./external_reactions/force[@name='rotor-{number}']/location")
        if place is None:
            raise ValueError(f"The airframe {code!r} has no rotor {number}.")
        forward_m, right_m = -float(place.findtext("x", "nan")), float(place.findtext("y", "nan"))
        sign = -1.0 if f"rotor/thrust-{number}-n" in clockwise else 1.0
        effects.append((1.0, -right_m, forward_m, sign * reaction_m))
    inverse = np.linalg.inv(np.array(effects).T)
    if not np.isfinite(inverse).all():
        raise ValueError(f"The rotors of the airframe {code!r} cannot turn it.")
    return tuple(tuple(float(share) for share in inverse[:, axis]) for axis in range(len(AXES)))


class Motion(NamedTuple):
    """State of the model: degrees, metres AMSL, m/s to north, east and down, radians, radians per second."""

    lon_deg: float
    lat_deg: float
    altitude_amsl_m: float
    north_mps: float
    east_mps: float
    down_mps: float
    roll_rad: float
    pitch_rad: float
    heading_rad: float
    roll_rad_s: float
    pitch_rad_s: float
    yaw_rad_s: float
    effort: float
    used_j: float
    power_w: float


class CameApart(ArithmeticError):
    """The model has diverged: its state is NaN or out of range."""


class Plant:
    """One aircraft. `altitude_amsl_m` is JSBSim's height above sea level, as is the ground height."""

    def __init__(self, airframe: Airframe, home: LonLat, *, ground_m: float, heading_deg: float, seed: int, physics_hz: int = 250) -> None:
        if physics_hz not in PHYSICS_HZ:
            raise ValueError(f"The model is stepped {', '.join(map(str, PHYSICS_HZ))} times a second, not {physics_hz}.")
        self._steps = round(GUIDANCE_STEP_S * physics_hz)
        self._model = model = flight_model(airframe.code, 1.0 / physics_hz, seed)
        self.leg_m = model["figure/leg-m"] - model["figure/static-sag-m"]
        model["ic/lat-geod-deg"], model["ic/long-gc-deg"] = home.lat, home.lon
        model["ic/terrain-elevation-ft"], model["ic/h-agl-ft"] = ground_m / FOOT_M, self.leg_m / FOOT_M
        model["ic/psi-true-deg"] = heading_deg
        model.run_ic()
        self._run = model.run
        self._read = tuple(self._node(name) for name in _READ)
        self._set_points = tuple(self._node(name) for name in _SET_POINTS)
        self._armed, self._grounded = self._node("setpoint/is-armed"), self._node("setpoint/is-grounded")
        self._terrain = self._node("position/terrain-elevation-asl-ft")
        self._wind = tuple(self._node(f"atmosphere/wind-{axis}-fps") for axis in ("north", "east", "down"))
        self._legs = tuple(self._node(f"gear/unit[{leg}]/WOW") for leg in range(MOTORS))
        self._air = tuple(self._node(f"velocities/{axis}-aero-fps") for axis in ("u", "v", "w"))
        self.motion = self._moved()

    def _node(self, name: str) -> jsbsim.FGPropertyNode:
        node = self._model.get_property_manager().get_node(name)
        if node is None:
            raise ValueError(f"The flight model has no {name}.")
        return node

    def advance(self) -> Motion:
        """Advance one guidance step of 0.04 s. Raises CameApart."""
        run = self._run
        try:
            for _ in range(self._steps):
                run()
        except (RuntimeError, ValueError, jsbsim.BaseError) as error:
            raise CameApart(str(error)) from error
        self.motion = self._moved()
        return self.motion

    def _moved(self) -> Motion:
        values = [node.get_double_value() for node in self._read]
        values[_VELOCITY] = [speed * FOOT_M for speed in values[_VELOCITY]]
        motion = Motion._make(values)
        # The sum is NaN if any part is; infinities cannot cancel out unnoticed.
        if not math.isfinite(sum(motion)) or not abs(motion.altitude_amsl_m) < MAX_HEIGHT_M:
            raise CameApart("the state of the model is not a number")
        return motion

    def fly(self, velocity: tuple[float, float, float], acceleration: tuple[float, float, float], heading_rad: float) -> bool:
        """Set the set-points to north, east and down [m/s, m/s²]. Returns False and changes nothing if a value is not finite."""
        values = (*velocity, *acceleration, heading_rad)
        if not math.isfinite(sum(values)):
            return False
        for node, value in zip(self._set_points, values, strict=True):
            node.set_double_value(value)
        return True

    def set_armed(self, is_armed: bool) -> None:
        self._armed.set_double_value(float(is_armed))

    def set_grounded(self, is_grounded: bool) -> None:
        self._grounded.set_double_value(float(is_grounded))

    def set_ground_m(self, ground_m: float) -> None:
        self._terrain.set_double_value(ground_m / FOOT_M)

    def set_wind(self, north_mps: float, east_mps: float, down_mps: float) -> None:
        """Set the velocity of the air."""
        for node, value in zip(self._wind, (north_mps, east_mps, down_mps), strict=True):
            node.set_double_value(value / FOOT_M)

    def set_turbulence(self, wind_at_20ft_mps: float) -> None:
        """Set the Dryden turbulence of MIL-F-8785C, whose strength at these heights depends only on the wind at 20 ft."""
        self._model["atmosphere/turb-type"] = 3 if wind_at_20ft_mps > 0.0 else 0
        self._model["atmosphere/turbulence/milspec/windspeed_at_20ft_AGL-fps"] = wind_at_20ft_mps / FOOT_M
        self._model["atmosphere/turbulence/milspec/severity"] = 3

    def set_temperature(self, warmer_k: float) -> None:
        """Set the difference from the standard atmosphere."""
        self._model["atmosphere/delta-T"] = warmer_k * 1.8

    def fail_motor(self, index: int | None) -> None:
        for number in range(MOTORS):
            self._model[f"fault/rotor-{number + 1}"] = 0.0 if number == index else 1.0

    @property
    def legs_down(self) -> int:
        return sum(node.get_double_value() > 0.5 for node in self._legs)

    @property
    def airspeed_mps(self) -> float:
        return math.hypot(*(node.get_double_value() * FOOT_M for node in self._air))
