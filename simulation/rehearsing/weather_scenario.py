"""Weather scenarios of rehearsals: named ones, and those with a user's values."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from planning.energy.conditions import MAX_WIND_MPS, Conditions, InvalidConditions, WindLayer, conditions_from_json, conditions_to_json

FRESH_BREEZE_MPS = 8.0  # the lower limit of Beaufort 5 (WMO-No. 306, code table 1100)
STRONGER = 1.5  # factor on the planned wind, if that gives more
STRONG_GUSTS_MPS = 2.0
WIND_TURBULENT_FROM_MPS = 1.0  # no turbulence below it
WORN_BATTERY_PERCENT = 80.0  # of the rated energy, at which batteries are commonly replaced
PREVAILING_FROM_DEG = 270.0
LOW_AGL_M = 10.0  # 33 feet: the height of reported winds
MAX_NAME_LENGTH = 60
OWN_KEYS = {"name", "wind", "temperature_c", "gusts_mps", "turbulence_mps_at_20ft", "battery_percent"}
MAX_GUSTS_MPS = 10.0
MIN_BATTERY_PERCENT = 10.0


class Named(StrEnum):
    CALM = "calm"
    AS_PLANNED = "as-planned"
    STRONG_WIND = "strong-wind"
    WEAK_BATTERY = "weak-battery"
    OWN = "own"


@dataclass(frozen=True)
class WeatherScenario:
    """battery_percent is the share of the rated energy in a full battery; turbulence is Dryden's, by the wind at 20 feet."""

    code: Named
    conditions: Conditions
    gusts_mps: float = 0.0
    turbulence_mps_at_20ft: float = 0.0
    battery_percent: float = 100.0
    name: str = ""


def named_scenario(code: Named, planned: Conditions) -> WeatherScenario:
    """Return the named scenario for the mission's planned conditions. Raises InvalidConditions for `own`."""
    if code is Named.CALM:
        return WeatherScenario(code, replace(planned, wind=()))
    if code is Named.AS_PLANNED:
        return WeatherScenario(code, planned, turbulence_mps_at_20ft=_turbulence_of(planned))
    if code is Named.STRONG_WIND:
        strong = strong_wind(planned)
        return WeatherScenario(code, strong, gusts_mps=STRONG_GUSTS_MPS, turbulence_mps_at_20ft=_turbulence_of(strong))
    if code is Named.WEAK_BATTERY:
        return WeatherScenario(code, planned, turbulence_mps_at_20ft=_turbulence_of(planned), battery_percent=WORN_BATTERY_PERCENT)
    raise InvalidConditions("conditions", "its figures are to be said")


def strong_wind(planned: Conditions) -> Conditions:
    """Return the planned wind times 1.5 at each height, at least a fresh breeze."""
    if planned.is_calm:
        return replace(planned, wind=(WindLayer(LOW_AGL_M, FRESH_BREEZE_MPS, PREVAILING_FROM_DEG),))
    layers = (replace(layer, speed_mps=min(max(layer.speed_mps * STRONGER, FRESH_BREEZE_MPS), MAX_WIND_MPS)) for layer in planned.wind)
    return replace(planned, wind=tuple(layers))


def own_scenario(value: Any, planned: Conditions) -> WeatherScenario:
    """Return a scenario with a user's values; omitted ones are as planned. Raises InvalidConditions."""
    if not isinstance(value, Mapping):
        raise InvalidConditions("conditions", "must be a name or an object")
    for key in value:
        if key not in OWN_KEYS:
            raise InvalidConditions(str(key), "is not known")
    stated = {key: value[key] for key in ("wind", "temperature_c") if value.get(key) is not None}
    conditions = conditions_from_json(conditions_to_json(planned) | stated)
    name = value.get("name") or ""
    if not isinstance(name, str) or len(name) > MAX_NAME_LENGTH:
        raise InvalidConditions("name", f"must be a text of at most {MAX_NAME_LENGTH} characters")
    turbulence = value.get("turbulence_mps_at_20ft")
    return WeatherScenario(
        Named.OWN,
        conditions,
        gusts_mps=_within(value.get("gusts_mps"), 0.0, MAX_GUSTS_MPS, 0.0, "gusts_mps"),
        turbulence_mps_at_20ft=_within(turbulence, 0.0, MAX_WIND_MPS, _turbulence_of(conditions), "turbulence_mps_at_20ft"),
        battery_percent=_within(value.get("battery_percent"), MIN_BATTERY_PERCENT, 100.0, 100.0, "battery_percent"),
        name=name,
    )


def scenario_to_json(scenario: WeatherScenario) -> dict[str, Any]:
    return {
        "code": str(scenario.code),
        "name": scenario.name,
        **conditions_to_json(scenario.conditions),
        "gusts_mps": scenario.gusts_mps,
        "turbulence_mps_at_20ft": scenario.turbulence_mps_at_20ft,
        "battery_percent": scenario.battery_percent,
    }


def scenario_from_json(stored: Mapping[str, Any]) -> WeatherScenario:
    return WeatherScenario(
        Named(stored["code"]),
        conditions_from_json({"wind": stored["wind"], "temperature_c": stored["temperature_c"]}),
        gusts_mps=stored["gusts_mps"],
        turbulence_mps_at_20ft=stored["turbulence_mps_at_20ft"],
        battery_percent=stored["battery_percent"],
        name=stored["name"],
    )


def _turbulence_of(conditions: Conditions) -> float:
    """Return the wind of the lowest layer as that at 20 feet."""
    speed_mps = conditions.wind[0].speed_mps if conditions.wind else 0.0
    return speed_mps if speed_mps >= WIND_TURBULENT_FROM_MPS else 0.0


def _within(value: Any, low: float, high: float, otherwise: float, place: str) -> float:
    if value is None:
        return otherwise
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise InvalidConditions(place, f"must be from {low:g} to {high:g}")
    return float(value)
