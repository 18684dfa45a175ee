"""Airframe and battery that fly for each UAV of a mission."""

from dataclasses import asdict, dataclass
from typing import Any

from missions.models import MissionUav, UavType
from planning.energy.performance import PERFORMANCE_KEYS, performance_from_json
from simulation.flight.airframe import AIRFRAMES
from simulation.models import SimulatedAirframe
from simulation.rehearsing.airframe_choice import CANDIDATES, nearest_airframe

CHOSEN, NEAREST = "chosen", "nearest"  # why: chosen for the type, or the nearest by speed, mass and endurance


@dataclass(frozen=True)
class StandIn:
    """The airframe that flies for a UAV. battery_wh: the UAV's own if stated, else the airframe's."""

    uav: int
    name: str
    airframe: str
    airframe_name: str
    why: str
    battery_wh: float
    has_own_battery: bool


def stand_in_of(uav: MissionUav) -> StandIn:
    performance = performance_from_json(uav.performance or None)
    chosen = _chosen(uav)
    airframe = AIRFRAMES[chosen or nearest_airframe(performance, uav.cruise_speed_mps, CANDIDATES)]
    own_wh = performance.battery_wh
    return StandIn(
        uav=uav.sequence,
        name=uav.name,
        airframe=airframe.code,
        airframe_name=airframe.name,
        why=CHOSEN if chosen else NEAREST,
        battery_wh=airframe.battery_wh if own_wh is None else own_wh,
        has_own_battery=own_wh is not None,
    )


def stand_in_to_json(stand_in: StandIn) -> dict[str, Any]:
    return asdict(stand_in)


def airframe_of_type(uav_type: UavType) -> str:
    """Return the code of the airframe for a type's UAVs that have no values of their own."""
    chosen = SimulatedAirframe.objects.filter(uav_type=uav_type).values_list("airframe", flat=True).first()
    figures = {name: getattr(uav_type, name) for name in PERFORMANCE_KEYS}
    return chosen if chosen in AIRFRAMES else nearest_airframe(performance_from_json(figures), uav_type.cruise_speed_mps, CANDIDATES)


def _chosen(uav: MissionUav) -> str | None:
    """Return the airframe chosen for its type; None without one, or if it no longer exists."""
    type_id = None if uav.uav is None else uav.uav.uav_type_id
    found = SimulatedAirframe.objects.filter(uav_type=type_id).values_list("airframe", flat=True).first() if type_id else None
    return found if found in AIRFRAMES else None
