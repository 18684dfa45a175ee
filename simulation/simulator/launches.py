"""From a stored vehicle to one that stands on the ground and talks."""

from inspection.geodesy import LonLat
from inspection.selectors.planning import heights_at, planning_read
from missions.models import CredentialKind, Uav
from missions.services.credentials import mavlink_signing_key
from simulation.models import SimulatedVehicle, Simulation
from simulation.rehearsing.ground import BlockedGround
from simulation.rehearsing.sky import sky_from_json
from simulation.rehearsing.sky_weather import weather_of
from simulation.simulator.options import Options
from simulation.vehicle_endpoint.launch import Launch
from simulation.vehicle_protocol.flavour import Flavour


class NoGateway(Exception):
    """A mission's UAV has nowhere to connect to."""


def launch_of(vehicle: SimulatedVehicle, simulation: Simulation, options: Options) -> Launch:
    """Over the stored terrain; a ground height that was said holds where it is known from nowhere else. Raises NoGateway."""
    if vehicle.uav is not None and options.gateway is None:
        raise NoGateway
    position, sky = LonLat(*vehicle.position.coords), sky_from_json(vehicle.conditions)
    return Launch(
        system=vehicle.system_id,
        home=position,
        airframe=vehicle.airframe,
        battery_wh=vehicle.battery_wh,
        flavour=Flavour(vehicle.flavour),
        key=None if vehicle.uav is None else _key_of(vehicle.uav),
        seed=simulation.seed + vehicle.sequence,
        heading_deg=vehicle.heading_deg,
        battery_percent=sky.battery_percent,
        ground=BlockedGround(heights_at(planning_read().edition), vehicle.ground_amsl_m or 0.0),
        weather=weather_of(sky),
        talks_to=[] if vehicle.uav is None or options.gateway is None else [options.gateway],
        listens_at=None if vehicle.port is None else (options.host, vehicle.port),
    )


def _key_of(uav: Uav) -> bytes | None:
    credential = uav.credentials.filter(kind=CredentialKind.MAVLINK_KEY, revoked_at=None).first()
    return None if credential is None else mavlink_signing_key(credential=credential)
