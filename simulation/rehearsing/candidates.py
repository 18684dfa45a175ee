"""The airframes that can be flown, as they are compared with a type of UAV."""

from planning.energy.performance import Performance
from simulation.flight.airframe import AIRFRAMES, Airframe
from simulation.rehearsing.airframe_choice import Candidate, endurance_min

HOVER_MIN = {"iris": 20.0, "inspector": 36.0}  # as their model files have it


def _candidate(airframe: Airframe) -> Candidate:
    worked_out = endurance_min(Performance(battery_wh=airframe.battery_wh, mass_kg=airframe.mass_kg))
    return Candidate(airframe.code, airframe.mass_kg, HOVER_MIN.get(airframe.code) or worked_out or 0.0, airframe.max_speed_mps)


CANDIDATES = tuple(_candidate(AIRFRAMES[code]) for code in sorted(AIRFRAMES))
