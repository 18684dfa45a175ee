"""The air that a plan is flown in: wind by height, and temperature."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

MAX_LAYERS = 10
MAX_WIND_MPS = 60.0  # above it no UAV flies
MAX_LAYER_AGL_M = 10_000.0
TEMPERATURES_C = (-90.0, 60.0)  # colder and hotter than ever measured on the ground
# International Standard Atmosphere, ISO 2533: p = p0 (1 - L h / T0) ** (g / (R L)), in the troposphere.
SEA_LEVEL_PA = 101_325.0
SEA_LEVEL_K = 288.15
LAPSE_K_PER_M = 0.0065
PRESSURE_EXPONENT = 5.255_88
GAS_CONSTANT = 287.052_87  # J/(kg K), dry air
# (1 + x) ** PRESSURE_EXPONENT as a power series: in the troposphere, where -0.25 < x < 0.01, right to a millionth. The power takes longer.
_POWER_SERIES = tuple(float(math.prod((PRESSURE_EXPONENT - below) / (below + 1) for below in range(power))) for power in range(9))
TROPOSPHERE_M = (-430.0, 11_000.0)  # the lowest land, and where the troposphere ends


class InvalidConditions(ValueError):
    """Conditions that cannot be; `place` names the entry as the JSON does, e.g. wind[2].speed_mps."""

    def __init__(self, place: str, message: str) -> None:
        super().__init__(f"{place}: {message}")
        self.place = place
        self.message = message


@dataclass(frozen=True)
class WindLayer:
    """The wind at a height above ground; from_deg is where it blows from, clockwise from true north."""

    agl_m: float
    speed_mps: float
    from_deg: float

    @property
    def east_north_mps(self) -> tuple[float, float]:
        """Velocity of the air: opposite to where the wind comes from."""
        angle = math.radians(self.from_deg)
        return -self.speed_mps * math.sin(angle), -self.speed_mps * math.cos(angle)


@dataclass(frozen=True)
class Conditions:
    """Wind in layers, from low to high, and the temperature on the ground. Without layers there is no wind. Raises InvalidConditions."""

    wind: tuple[WindLayer, ...] = ()
    temperature_c: float = 15.0

    def __post_init__(self) -> None:
        _check(self.temperature_c, *TEMPERATURES_C, "temperature_c")
        if len(self.wind) > MAX_LAYERS:
            raise InvalidConditions("wind", f"has {len(self.wind)} layers; at most {MAX_LAYERS} are read")
        for number, layer in enumerate(self.wind):
            _check(layer.agl_m, 0.0, MAX_LAYER_AGL_M, f"wind[{number}].altitude_agl_m")
            _check(layer.speed_mps, 0.0, MAX_WIND_MPS, f"wind[{number}].speed_mps")
            if not 0.0 <= layer.from_deg < 360.0:
                raise InvalidConditions(f"wind[{number}].from_deg", "must be at least 0 and below 360")
        for number, (lower, upper) in enumerate(pairwise(self.wind), start=1):
            if not lower.agl_m < upper.agl_m:
                raise InvalidConditions(f"wind[{number}].altitude_agl_m", "must be above the layer before it")

    @property
    def is_calm(self) -> bool:
        return all(layer.speed_mps == 0.0 for layer in self.wind)

    @cached_property
    def wind_table(self) -> NDArray[np.float64]:
        """Layers as compiled code reads them, (layers, 3): height above ground [m], and the air's velocity to east and north [m/s]."""
        return np.array([(layer.agl_m, *layer.east_north_mps) for layer in self.wind], dtype=np.float64).reshape(-1, 3)

    def wind_at(self, agl_m: float) -> tuple[float, float]:
        """Velocity of the air at a height above ground, to east and north [m/s].

        Between two layers it is interpolated as a vector; below the lowest and above the highest it is as there.
        """
        east_mps, north_mps = wind_in_table(self.wind_table, float(agl_m))
        return float(east_mps), float(north_mps)

    def air_density(self, amsl_m: float | None) -> float:
        """Density of dry air [kg/m3]: pressure of the standard atmosphere at this height, temperature of the ground.

        Where the height above sea level is not known it is taken as 0, where air is densest: hover then seems to take too little power
        (by half the share that the air is thinner: 6 % at 1,000 m), and fast flight too much.
        The air some 100 m above ground is up to 1 K colder than taken here, which is 0.2 % of power.
        """
        return float(air_density(amsl_m or 0.0, self.temperature_c))


@njit(cache=True, nogil=True)
def air_density(amsl_m: float, temperature_c: float) -> float:
    """As Conditions.air_density, for compiled code."""
    height_m = min(max(amsl_m, TROPOSPHERE_M[0]), TROPOSPHERE_M[1])
    fallen = -LAPSE_K_PER_M / SEA_LEVEL_K * height_m
    series = _POWER_SERIES[-1]
    for power in range(len(_POWER_SERIES) - 2, -1, -1):
        series = _POWER_SERIES[power] + fallen * series
    return float(SEA_LEVEL_PA * series / (GAS_CONSTANT * (temperature_c + 273.15)))


@njit(cache=True, nogil=True)
def wind_in_table(table: NDArray[np.float64], agl_m: float) -> tuple[float, float]:
    """As Conditions.wind_at, for compiled code; the table is Conditions.wind_table."""
    if len(table) == 0:
        return 0.0, 0.0
    upper = 0
    while upper < len(table) and table[upper, 0] <= agl_m:
        upper += 1
    if upper == 0 or upper == len(table):
        held = max(upper - 1, 0)
        return table[held, 1], table[held, 2]
    lower = upper - 1
    share = (agl_m - table[lower, 0]) / (table[upper, 0] - table[lower, 0])
    east_mps = table[lower, 1] + share * (table[upper, 1] - table[lower, 1])
    return east_mps, table[lower, 2] + share * (table[upper, 2] - table[lower, 2])


def conditions_to_json(conditions: Conditions) -> dict[str, Any]:
    return {
        "wind": [{"altitude_agl_m": layer.agl_m, "speed_mps": layer.speed_mps, "from_deg": layer.from_deg} for layer in conditions.wind],
        "temperature_c": conditions.temperature_c,
    }


def conditions_from_json(value: Any) -> Conditions:
    """Conditions as the API has them; null, and what is left out, is calm air of 15 °C. Raises InvalidConditions."""
    if value is None:
        return Conditions()
    entries = _entries(value, "conditions", {"wind", "temperature_c"})
    layers = entries.get("wind") or []
    if not isinstance(layers, list | tuple):
        raise InvalidConditions("wind", "must be a list")
    if len(layers) > MAX_LAYERS:
        raise InvalidConditions("wind", f"has {len(layers)} layers; at most {MAX_LAYERS} are read")
    wind = []
    for number, layer in enumerate(layers):
        place = f"wind[{number}]"
        keys = ("altitude_agl_m", "speed_mps", "from_deg")
        read = _entries(layer, place, set(keys))
        wind.append(WindLayer(*(_number(read.get(key), f"{place}.{key}") for key in keys)))
    temperature_c = entries.get("temperature_c")
    return Conditions(tuple(wind), 15.0 if temperature_c is None else _number(temperature_c, "temperature_c"))


def _entries(value: Any, place: str, known: set[str]) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise InvalidConditions(place, "must be an object")
    for key in value:
        if key not in known:
            raise InvalidConditions(f"{place}.{key}", "is not known")
    return value


def _number(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidConditions(place, "must be a number")
    try:
        return float(value)
    except OverflowError:
        raise InvalidConditions(place, "is too large") from None


def _check(value: float, low: float, high: float, place: str) -> None:
    if not low <= value <= high:
        raise InvalidConditions(place, f"must be from {low:g} to {high:g}")
