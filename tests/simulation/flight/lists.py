"""Places, mission items and weather for flights in tests, in metres around one home."""

import math

from pymavlink.dialects.v20 import common as mavlink
from pyproj import Geod

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from planning.energy.conditions import Conditions, WindLayer
from simulation.flight.events import Event, ItemReached
from simulation.flight.faults import Weather
from simulation.flight.states import FlightMode
from simulation.flight.uav import SimulatedUav

HOME = LonLat(9.0, 47.0)
EARTH = Geod(ellps="WGS84")
RELATIVE = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
NAN = math.nan


def place(east_m: float, north_m: float, home: LonLat = HOME) -> LonLat:
    """So far from home, by geodesics: first to the north, then to the east."""
    lon, lat, _ = EARTH.fwd(home.lon, home.lat, 0.0, north_m)
    lon, lat, _ = EARTH.fwd(lon, lat, 90.0, east_m)
    return LonLat(lon, lat)


def at(command: int, east_m: float, north_m: float, height_m: float, *parameters: float, frame: int = RELATIVE) -> MissionItem:
    """An item with a place; the parameters left out are 0, but the fourth is open."""
    one, two, three, four = (*parameters, *(0.0, 0.0, 0.0, NAN)[len(parameters) :])
    position = place(east_m, north_m)
    return MissionItem(command, frame, (one, two, three, four), round(position.lon * 1e7), round(position.lat * 1e7), height_m)


def plain(command: int, *parameters: float) -> MissionItem:
    one, two, three, four = (*parameters, *(0.0,) * 4)[:4]
    return MissionItem(command, mavlink.MAV_FRAME_MISSION, (one, two, three, four))


def take_off(height_m: float = 10.0) -> MissionItem:
    return at(mavlink.MAV_CMD_NAV_TAKEOFF, 0.0, 0.0, height_m)


def waypoint(east_m: float, north_m: float, height_m: float = 10.0, *parameters: float) -> MissionItem:
    return at(mavlink.MAV_CMD_NAV_WAYPOINT, east_m, north_m, height_m, *parameters)


def land(east_m: float = 0.0, north_m: float = 0.0) -> MissionItem:
    return at(mavlink.MAV_CMD_NAV_LAND, east_m, north_m, 0.0)


def speed(mps: float) -> MissionItem:
    return plain(mavlink.MAV_CMD_DO_CHANGE_SPEED, 1.0, mps, -1.0)


def wind(speed_mps: float, from_deg: float = 270.0, **more: float) -> Weather:
    return Weather(Conditions((WindLayer(10.0, speed_mps, from_deg),)), **more)


def begin(uav: SimulatedUav) -> None:
    """The mission that was loaded."""
    for outcome in (uav.set_mode(FlightMode.MISSION), uav.arm()):
        assert outcome.is_done, outcome


def step(uav: SimulatedUav, seconds: float) -> list[Event]:
    """What happens in so many simulated seconds."""
    events = uav.take_events()
    for _ in range(round(seconds / 0.04)):
        uav.step()
        events += uav.take_events()
    return events


def airborne(uav: SimulatedUav, height_m: float = 10.0) -> SimulatedUav:
    """Hovering at this height."""
    assert uav.take_off(height_m).is_done
    assert uav.arm().is_done
    step(uav, 4.0 + height_m / uav.airframe.climb_mps)
    assert abs(uav.state.altitude_relative_m - height_m) < 0.3
    return uav


def reached(events: list[Event]) -> list[int]:
    return [event.index for event in events if isinstance(event, ItemReached)]


def off_m(one: LonLat, other: LonLat) -> float:
    return float(EARTH.inv(one.lon, one.lat, other.lon, other.lat)[2])
