"""x"""

from dataclasses import dataclass

from missions.flight_plan.waypoints import FloatArray


@dataclass(frozen=True)
class Timing:
    arrival_s: FloatArray
    used_wh: FloatArray | None = None
    battery_left_percent: FloatArray | None = None
    total_s: float = 0.0
    total_wh: float | None = None
    battery_percent: float | None = None
