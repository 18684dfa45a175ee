"""What is known of a UAV's flight before it says anything."""

from dataclasses import dataclass, field

from inspection.geodesy import LonLat
from mavlink.approved_route import Flight
from planning.energy.conditions import Conditions
from planning.rules import FlightRules


@dataclass(frozen=True)
class Knowledge:
    """`flight` is the approved one that it is on; None: it flies none, or nobody knows which.

    `max_airspeed_mps` is the most that it flies through the air, None where not stated. `home` is where it returns to, None: the take-off.
    `is_to_go_on` tells whether it flies its route to the end without a link; else it may be anywhere on its way home by then.
    """

    flight: Flight | None = None
    cruise_speed_mps: float = FlightRules.cruise_speed_mps
    max_airspeed_mps: float | None = None
    climb_speed_mps: float = FlightRules.climb_speed_mps
    conditions: Conditions = field(default_factory=Conditions)
    home: LonLat | None = None
    is_to_go_on: bool = True
