"""Rally points as places that a return may lead to."""

from collections.abc import Sequence

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from simulation.flight.states import Haven
from simulation.vehicle_protocol.item_rules import ABOVE_SEA

E7 = 1e7


def havens_of(items: Sequence[MissionItem], home_amsl_m: float) -> tuple[Haven, ...]:
    """Of items that were taken as rally points (see item_rules)."""
    return tuple(
        Haven(
            LonLat(item.longitude_e7 / E7, item.latitude_e7 / E7),
            item.altitude_m - home_amsl_m if item.frame in ABOVE_SEA else item.altitude_m,
        )
        for item in items
    )
