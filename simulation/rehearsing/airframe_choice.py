"""Which simulated airframe flies for a type of UAV: the nearest by mass and by how long it stays up."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from missions.flight_plan.performance import Performance
from missions.flight_plan.power import power_w


@dataclass(frozen=True)
class Candidate:
    """A simulated airframe as it is compared: kilograms, and minutes of hover on its own battery."""

    code: str
    mass_kg: float
    endurance_min: float


def endurance_min(performance: Performance) -> float | None:
    """Minutes of hover on a full battery; None without one."""
    return None if performance.battery_wh is None else performance.battery_wh / power_w(performance) * 60.0


def nearest_airframe(performance: Performance, candidates: Iterable[Candidate]) -> str:
    """The code of the one whose mass, and endurance where it is known, differ least as ratios; the first of equals."""
    own_min = endurance_min(performance)

    def differs(candidate: Candidate) -> float:
        by_mass = abs(math.log(candidate.mass_kg / performance.mass_kg))
        return by_mass if own_min is None else math.hypot(by_mass, math.log(candidate.endurance_min / own_min))

    return min(candidates, key=differs).code
