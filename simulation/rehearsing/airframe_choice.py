"""Choice of the simulated airframe for a UAV type: the nearest by speed, mass and endurance."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from planning.energy.performance import Performance
from planning.energy.power import power_w
from simulation.flight.airframe import AIRFRAMES, Airframe

AS_FAST_SHARE = 0.8  # of the planned speed


@dataclass(frozen=True)
class AirframeCandidate:
    """A simulated airframe to compare: kilograms, minutes of hover on its battery, and maximum ground speed."""

    code: str
    mass_kg: float
    endurance_min: float
    max_speed_mps: float


def endurance_min(performance: Performance) -> float | None:
    """Return the minutes of hover on a full battery; None if its energy is unknown."""
    return None if performance.battery_wh is None else performance.battery_wh / power_w(performance) * 60.0


def nearest_airframe(performance: Performance, speed_mps: float, candidates: Iterable[AirframeCandidate]) -> str:
    """Return the code of the candidate with the smallest ratio of mass, and of endurance where known; the first of equals.

    Without battery data only candidates of similar speed are considered, else the fastest, as a much slower one would only be late. With
    battery data, consumption must match that of a UAV of this mass.
    """
    own_min, candidates = endurance_min(performance), tuple(candidates)
    if own_min is None:
        wanted_mps = min(AS_FAST_SHARE * speed_mps, max(candidate.max_speed_mps for candidate in candidates))
        candidates = tuple(candidate for candidate in candidates if candidate.max_speed_mps >= wanted_mps)

    def differs(candidate: AirframeCandidate) -> float:
        by_mass = abs(math.log(candidate.mass_kg / performance.mass_kg))
        return by_mass if own_min is None else math.hypot(by_mass, math.log(candidate.endurance_min / own_min))

    return min(candidates, key=differs).code


HOVER_MIN = {"iris": 20.0, "inspector": 36.0}  # of their model files


def _candidate(airframe: Airframe) -> AirframeCandidate:
    worked_out = endurance_min(Performance(battery_wh=airframe.battery_wh, mass_kg=airframe.mass_kg))
    return AirframeCandidate(airframe.code, airframe.mass_kg, HOVER_MIN.get(airframe.code) or worked_out or 0.0, airframe.max_speed_mps)


CANDIDATES = tuple(_candidate(AIRFRAMES[code]) for code in sorted(AIRFRAMES))
