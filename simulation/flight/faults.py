"""Faults and weather: values that can be replaced in flight."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from planning.energy.conditions import Conditions

MAX_GUSTS_MPS = 15.0
MAX_TURBULENCE_MPS = 40.0  # at 20 ft: 45 knots are severe in MIL-F-8785C
GUST_TIME_S = 3.0
MOTORS = 4
FAULTS = frozenset({"link_lost_for_s", "gps_lost_for_s", "battery_wh_left", "motor_failed", "stuck_item", "clock_offset_s"})
WHOLE = frozenset({"motor_failed", "stuck_item"})
LASTING = ("link_lost", "gps_lost")


class ImpossibleWeather(ValueError):
    """Gusts or turbulence out of range."""


@dataclass(frozen=True, slots=True)
class Weather:
    """Wind by height and temperature as in a mission's conditions, with gusts and turbulence.

    gusts_mps              standard deviation of gusts to north and to east; a quarter of it vertically
    gust_time_s            duration of a gust: the time constant of a Gauss-Markov process
    turbulence_mps_at_20ft wind at 20 ft of Dryden turbulence by MIL-F-8785C; 0: none
    """

    conditions: Conditions = field(default_factory=Conditions)
    gusts_mps: float = 0.0
    gust_time_s: float = GUST_TIME_S
    turbulence_mps_at_20ft: float = 0.0

    def __post_init__(self) -> None:
        _check("gusts_mps", self.gusts_mps, 0.0, MAX_GUSTS_MPS)
        _check("gust_time_s", self.gust_time_s, 0.1, 600.0)
        _check("turbulence_mps_at_20ft", self.turbulence_mps_at_20ft, 0.0, MAX_TURBULENCE_MPS)


def _check(name: str, value: float, least: float, most: float) -> None:
    if not (math.isfinite(value) and least <= value <= most):
        raise ImpossibleWeather(f"{name} must be from {least:g} to {most:g}, not {value:g}.")


class ImpossibleFault(ValueError):
    """A fault that is impossible for this UAV."""


@dataclass(frozen=True, slots=True)
class Faults:
    """Faults. Times are simulated seconds since the start.

    link_lost_until_s   nothing is sent or received until then; applied by the endpoint
    gps_lost_until_s    no fix until then: dead reckoning, which drifts
    battery_wh_left     charge from now on, reduced by later use; None: unchanged
    motor_failed        index of a stopped rotor, 0 to 3
    stuck_item          index of a mission item that is never done
    clock_offset_s      added to the UAV's time of day; applied by the endpoint
    """

    link_lost_until_s: float = 0.0
    gps_lost_until_s: float = 0.0
    battery_wh_left: float | None = None
    motor_failed: int | None = None
    stuck_item: int | None = None
    clock_offset_s: float = 0.0

    def __post_init__(self) -> None:
        if self.motor_failed is not None and not 0 <= self.motor_failed < MOTORS:
            raise ImpossibleFault(f"There is no motor {self.motor_failed}: there are {MOTORS}, counted from 0.")
        if self.battery_wh_left is not None and not self.battery_wh_left >= 0.0:
            raise ImpossibleFault("A battery does not hold less than nothing.")
        if any(value != value for value in (self.link_lost_until_s, self.gps_lost_until_s, self.clock_offset_s)):
            raise ImpossibleFault("Times of faults are numbers.")

    def is_link_lost(self, now_s: float) -> bool:
        return now_s < self.link_lost_until_s

    def is_gps_lost(self, now_s: float) -> bool:
        return now_s < self.gps_lost_until_s


Changed = Callable[[Faults, float], Faults]


class WrongFaults(ValueError):
    """The description of faults is invalid."""


def faults_from(reported: Any) -> Changed:
    """Return a function from previous faults and simulated seconds to the new faults. Omitted faults stay unchanged. Raises WrongFaults."""
    if not isinstance(reported, Mapping) or not reported.keys() <= FAULTS:
        raise WrongFaults(f"only {', '.join(sorted(FAULTS))} can be told")
    values: dict[str, Any] = {name: _value(name, value) for name, value in reported.items()}
    lasting = {f"{name}_until_s": values.pop(f"{name}_for_s") or 0.0 for name in LASTING if f"{name}_for_s" in values}

    def changed(before: Faults, now_s: float) -> Faults:
        until: dict[str, Any] = {name: now_s + for_s for name, for_s in lasting.items()}
        return replace(before, **values, **until)

    try:
        changed(Faults(), 0.0)
    except (ImpossibleFault, TypeError) as error:
        raise WrongFaults(str(error)) from error
    return changed


def _value(name: str, value: Any) -> Any:
    if value is None:
        return 0.0 if name == "clock_offset_s" else None
    if isinstance(value, bool) or (name in WHOLE and not isinstance(value, int)):
        raise WrongFaults(f"{name} is a whole number or null")
    if not isinstance(value, int | float) or not math.isfinite(value):
        raise WrongFaults(f"{name} is a number")
    return value if name in WHOLE else float(value)
