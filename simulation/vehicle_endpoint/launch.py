"""Creates UAVs with endpoints on the ground."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from inspection.geodesy import LonLat
from planning.views.camera import Camera
from simulation.flight.airframe import AIRFRAMES, Airframe, Settings
from simulation.flight.camera import SIMULATED_CAMERA
from simulation.flight.faults import Faults, Weather
from simulation.flight.plant import FlatGround, GroundElevation
from simulation.flight.uav import SimulatedUav
from simulation.vehicle_endpoint.fleet import SimulatedFleet
from simulation.vehicle_endpoint.flying_uav import FlyingUav
from simulation.vehicle_endpoint.radio import Address, Radio
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot

MAX_SYSTEM_ID = 250  # higher ids are ground stations
METRES_PER_DEGREE = 111_195.0


@dataclass(frozen=True)
class Launch:
    """One UAV. `airframe` is one of AIRFRAMES, with another battery if `battery_wh` is set; `key` has 32 bytes."""

    system: int
    home: LonLat
    airframe: str = "iris"
    battery_wh: float | None = None
    autopilot_type: SimulatedAutopilot = SimulatedAutopilot.PX4
    key: bytes | None = field(default=None, repr=False)
    seed: int = 0
    heading_deg: float = 0.0
    battery_percent: float = 100.0
    ground: GroundElevation = field(default_factory=FlatGround)
    weather: Weather = field(default_factory=Weather)
    faults: Faults = field(default_factory=Faults)
    camera: Camera = SIMULATED_CAMERA
    talks_to: Sequence[Address] = ()
    listens_at: Address | None = None


def fleet_of(launches: Sequence[Launch], *, speed: float = 1.0) -> SimulatedFleet:
    """Return the fleet. Raises OSError if a socket cannot be opened, and closes all of them."""
    uavs: list[FlyingUav] = []
    try:
        for launch in launches:
            uav = SimulatedUav(
                _airframe(launch),
                launch.home,
                ground=launch.ground,
                weather=launch.weather,
                seed=launch.seed,
                heading_deg=launch.heading_deg,
                battery_percent=launch.battery_percent,
                faults=launch.faults,
                camera=launch.camera,
                settings=Settings(turns_to_target=launch.autopilot_type is not SimulatedAutopilot.ARDUPILOT),
            )
            uavs.append(FlyingUav(uav, launch.system, Radio(launch.talks_to, launch.listens_at), launch.autopilot_type, launch.key))
    except BaseException:
        for flying in uavs:
            flying.radio.close()
        raise
    return SimulatedFleet(uavs, speed)


def _airframe(launch: Launch) -> Airframe:
    airframe = AIRFRAMES[launch.airframe]
    return airframe if launch.battery_wh is None else replace(airframe, battery_wh=launch.battery_wh)


def in_a_row(first: LonLat, count: int, spacing_m: float) -> list[LonLat]:
    """Return places from west to east."""
    step_deg = spacing_m / (METRES_PER_DEGREE * math.cos(math.radians(first.lat)))
    return [LonLat(first.lon + number * step_deg, first.lat) for number in range(count)]
