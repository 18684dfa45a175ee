"""Airframe and battery that fly for each UAV of a mission."""

from dataclasses import asdict, dataclass
from typing import Any

from missions.models import MissionUav, UavType
from planning.energy.performance import PERFORMANCE_KEYS, performance_from_json
from planning.views.camera import Camera, camera_from_json, camera_to_json
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.camera import SIMULATED_CAMERA
from simulation.models import SimulatedAirframe
from simulation.rehearsing.airframe_choice import CANDIDATES, nearest_airframe

CHOSEN, NEAREST = "chosen", "nearest"  # why: chosen for the type, or the nearest by speed, mass and endurance


@dataclass(frozen=True)
class StandIn:
    """The airframe and camera that fly for a UAV: battery_wh and camera are the UAV's own (the first of its type) if stated."""

    uav: int
    name: str
    airframe: str
    airframe_name: str
    why: str
    battery_wh: float
    has_own_battery: bool
    camera: Camera = SIMULATED_CAMERA


def stand_in_of(uav: MissionUav) -> StandIn:
    performance = performance_from_json(uav.performance or None)
    chosen, camera = _of_type(None if uav.uav is None else uav.uav.uav_type_id)
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
        camera=camera,
    )


def camera_of_type(type_id: int | None) -> Camera:
    """Return the first camera of a UAV type, else the usual simulated one."""
    return _of_type(type_id)[1]


def stand_in_to_json(stand_in: StandIn) -> dict[str, Any]:
    stored = {name: value for name, value in asdict(stand_in).items() if name != "camera"}
    return stored if stand_in.camera is SIMULATED_CAMERA else stored | {"camera": camera_to_json(stand_in.camera)}


def airframe_of_type(uav_type: UavType) -> str:
    """Return the code of the airframe for a type's UAVs that have no values of their own."""
    chosen = SimulatedAirframe.objects.filter(uav_type=uav_type).values_list("airframe", flat=True).first()
    figures = {name: getattr(uav_type, name) for name in PERFORMANCE_KEYS}
    return chosen if chosen in AIRFRAMES else nearest_airframe(performance_from_json(figures), uav_type.cruise_speed_mps, CANDIDATES)


def _of_type(type_id: int | None) -> tuple[str | None, Camera]:
    """Return the airframe chosen for a type, None without one or if it no longer exists, and the camera of its UAVs."""
    rows = UavType.objects.filter(pk=type_id or 0).values_list("simulated_airframe__airframe", "cameras")
    chosen, cameras = (rows.first() if type_id else None) or (None, [])
    return chosen if chosen in AIRFRAMES else None, camera_from_json(cameras[0]) if cameras else SIMULATED_CAMERA
