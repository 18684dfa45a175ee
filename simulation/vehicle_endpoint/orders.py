"""Changes in flight as lines of JSON, to control a fleet from another process."""

import json
import math
from collections.abc import Callable
from typing import Any

from planning.energy.conditions import Conditions, InvalidConditions, WindLayer
from simulation.flight.faults import Faults, ImpossibleWeather, Weather, WrongFaults, faults_from
from simulation.vehicle_endpoint.fleet import VehicleChange

WIND_MEASURED_AGL_M = 10.0  # a single layer applies at all heights
ORDER = frozenset({"system", "weather", "faults", "speed"})
WEATHER = frozenset({"wind", "gusts_mps", "turbulence_mps", "temperature_c"})


class WrongOrder(ValueError):
    """The line is invalid."""


def change_of(line: str) -> VehicleChange:
    """Parse `{"system": 3, "weather": {"wind": [8, 270], "gusts_mps": 2}, "faults": {"link_lost_for_s": 20}, "speed": 5}`, or parts of it.

    Without a system it applies to all UAVs. Omitted weather is calm; omitted faults stay unchanged. Faults with a duration count from now
    on in simulated seconds. Raises WrongOrder.
    """
    try:
        order = json.loads(line)
    except ValueError as error:
        raise WrongOrder(f"not JSON: {error}") from error
    _known(order, ORDER)
    system, speed = order.get("system"), order.get("speed")
    if system is not None and not isinstance(system, int):
        raise WrongOrder("system is a number from 1 to 255")
    return VehicleChange(
        system=system,
        weather=weather_of(order["weather"]) if "weather" in order else None,
        faults=faults_of(order["faults"]) if "faults" in order else None,
        speed=None if speed is None else _number(speed, "speed"),
    )


def weather_of(reported: Any) -> Weather:
    """Return the weather. Raises WrongOrder."""
    _known(reported, WEATHER)
    wind = reported.get("wind", [0.0, 0.0])
    if not (isinstance(wind, list) and len(wind) == 2):
        raise WrongOrder("wind is [speed in m/s, degrees that it blows from]")
    speed_mps, from_deg = (_number(value, "wind") for value in wind)
    try:
        layer = WindLayer(WIND_MEASURED_AGL_M, speed_mps, from_deg % 360.0)
        conditions = Conditions((layer,), _number(reported.get("temperature_c", 15.0), "temperature_c"))
        gusts_mps, turbulence_mps = (_number(reported.get(name, 0.0), name) for name in ("gusts_mps", "turbulence_mps"))
        return Weather(conditions, gusts_mps=gusts_mps, turbulence_mps_at_20ft=turbulence_mps)
    except (InvalidConditions, ImpossibleWeather) as error:
        raise WrongOrder(str(error)) from error


def faults_of(reported: Any) -> Callable[[Faults, float], Faults]:
    """Return a function from previous faults and simulated seconds to the new faults. Raises WrongOrder."""
    try:
        return faults_from(reported)
    except WrongFaults as error:
        raise WrongOrder(str(error)) from error


def _known(reported: Any, names: frozenset[str]) -> None:
    if not isinstance(reported, dict) or not reported.keys() <= names:
        raise WrongOrder(f"only {', '.join(sorted(names))} can be told")


def _number(value: Any, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise WrongOrder(f"{name} is a number")
    return float(value)
