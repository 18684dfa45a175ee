"""What a UAV lacks for a target that is refused, and how many minutes of flight that is."""

import math
from dataclasses import dataclass

from missions.services.planning.requests import UavRequest
from planning.energy.power import power_w


@dataclass(frozen=True)
class Shortfall:
    """Either metres or Wh, and the seconds of level flight at the UAV's speed, in calm air of 1.225 kg/m3, that they are."""

    seconds: float
    metres: float | None = None
    wh: float | None = None


def of_range(uav: UavRequest, metres: float) -> Shortfall:
    return Shortfall(metres / uav.cruise_speed_mps, metres=metres)


def of_battery(uav: UavRequest, wh: float) -> Shortfall:
    fastest_mps = uav.performance.max_airspeed_mps or math.inf
    watts = power_w(uav.performance, airspeed_mps=min(uav.cruise_speed_mps, fastest_mps))
    return Shortfall(wh * 3_600.0 / watts, wh=wh)


def with_minutes(sentence: str, shortfall: Shortfall) -> str:
    """The sentence, at whose end the shortfall stands, with its minutes; rounded up, as no less would do."""
    minutes = math.ceil(shortfall.seconds / 6.0) / 10.0
    return f"{sentence.removesuffix('.')}: {minutes:,.1f} min of flight."
