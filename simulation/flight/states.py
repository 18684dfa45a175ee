"""States that a simulated UAV reports, and its responses to orders."""

from dataclasses import dataclass
from enum import StrEnum

from inspection.geodesy import LonLat
from operation.reasons import Reason
from simulation.flight.gimbal import AHEAD, GimbalAttitude


class FlightMode(StrEnum):
    """Flight modes independent of autopilots; the endpoint maps them to mode numbers."""

    HOLD = "hold"
    TAKE_OFF = "take-off"
    MISSION = "mission"
    GO_TO = "go-to"
    RETURN = "return"
    LAND = "land"


class Landed(StrEnum):
    ON_GROUND = "on-ground"
    TAKING_OFF = "taking-off"
    IN_AIR = "in-air"
    LANDING = "landing"


class MissionItemState(StrEnum):
    NONE = "none"
    NOT_STARTED = "not-started"
    ACTIVE = "active"
    PAUSED = "paused"
    COMPLETE = "complete"


class Severity(StrEnum):
    INFO = "info"
    WARNING = "warning"
    CRITICAL = "critical"


@dataclass(frozen=True, slots=True)
class RallyPoint:
    """A rally point; its height is above the take-off."""

    position: LonLat
    height_relative_m: float


@dataclass(frozen=True, slots=True)
class Gps:
    """GPS state. `fix` as in MAVLink: 0 none, 3 is 3D."""

    fix: int
    satellites: int
    hdop: float


@dataclass(frozen=True, slots=True)
class SimulatedState:
    """State at `at_s` seconds after the start.

    `position` is the estimated position, which the UAV reports and flies by; `true_position` is the real one. They only differ without GPS
    and shortly after. Heights are true: AMSL, above home, and above ground. Velocity, wind (the air's velocity) and rates are in m/s and
    degrees per second, to north, east and down. `photos` counts those since the start.
    """

    at_s: float
    position: LonLat
    true_position: LonLat
    altitude_amsl_m: float
    altitude_relative_m: float
    altitude_agl_m: float
    velocity_ned_mps: tuple[float, float, float]
    roll_deg: float
    pitch_deg: float
    heading_deg: float
    roll_rate_dps: float
    pitch_rate_dps: float
    yaw_rate_dps: float
    airspeed_mps: float
    ground_speed_mps: float
    wind_ned_mps: tuple[float, float, float]
    battery_percent: float
    battery_used_wh: float
    battery_v: float
    battery_a: float
    is_armed: bool
    is_in_air: bool
    landed: Landed
    mode: FlightMode
    is_crashed: bool
    gps: Gps
    current_item: int
    mission_state: MissionItemState
    home: LonLat
    home_amsl_m: float
    target_speed_mps: float
    gimbal: GimbalAttitude = AHEAD
    photos: int = 0


@dataclass(frozen=True, slots=True)
class Done:
    """The order is being carried out."""

    is_done: bool = True


@dataclass(frozen=True, slots=True)
class OrderRefused:
    """The order is refused: `code` for programs, `words` for people."""

    code: str
    words: Reason | str
    is_done: bool = False


Outcome = Done | OrderRefused
DONE = Done()
