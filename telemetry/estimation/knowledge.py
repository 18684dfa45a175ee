"""What is known of a UAV's flight before its first report."""

from dataclasses import dataclass, field

from inspection.geodesy import LonLat
from mavlink.approved_route import Flight
from planning.energy.conditions import Conditions
from planning.rules import FlightRules


@dataclass(frozen=True)
class Knowledge:
    """`flight` is the approved one that it flies; None: none, or unknown.

    `max_airspeed_mps` is its highest airspeed, None if not stated. `home` is where it returns to, None: the take-off. `is_to_go_on`:
    without a link it flies its route to the end; otherwise it may be anywhere on its RTL path by then.
    """

    flight: Flight | None = None
    cruise_speed_mps: float = FlightRules.cruise_speed_mps
    max_airspeed_mps: float | None = None
    climb_speed_mps: float = FlightRules.climb_speed_mps
    conditions: Conditions = field(default_factory=Conditions)
    home: LonLat | None = None
    is_to_go_on: bool = True
