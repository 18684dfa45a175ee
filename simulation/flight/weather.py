"""The air that is flown in: a value that can be replaced in flight."""

import math
from dataclasses import dataclass, field

from planning.energy.conditions import Conditions

MAX_GUSTS_MPS = 15.0
MAX_TURBULENCE_MPS = 40.0  # at 20 ft: MIL-F-8785C calls 45 knots severe
GUST_TIME_S = 3.0


class ImpossibleWeather(ValueError):
    """Gusts or turbulence that cannot be."""


@dataclass(frozen=True, slots=True)
class Weather:
    """Wind by height and temperature as a mission's conditions have them, and what the air does around its mean.

    gusts_mps              standard deviation of gusts to north and to east; a quarter of it up and down
    gust_time_s            how long a gust lasts: the time constant of a Gauss-Markov process
    turbulence_mps_at_20ft the wind at 20 ft that makes Dryden turbulence as MIL-F-8785C has it; 0: none
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
