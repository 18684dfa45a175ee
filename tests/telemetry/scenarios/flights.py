"""A flight of a scenario: brought, started, and in the air."""

from inspection.geodesy.wgs84 import short_distance_m
from mavlink.autopilot_type import AutopilotType
from mavlink.mission_sync.compare import differences
from mavlink.mission_sync.wire import onboard_list
from mavlink.vehicle_plan import FlightLoad, MissionType
from missions.models import CommandKind, CommandState, Mission, Uav, UavCommand
from missions.services.commands.commands import queue_command
from missions.services.commands.dispatch import load_of
from tests.telemetry.gateway.commands.test_commands import begin, dispatch, ended
from tests.telemetry.gateway.station import wait_for
from tests.telemetry.scenarios.vehicle import ScenarioVehicle

FLIGHT_S = 400.0  # of patience, with a mission of some 250 s at five times its pace on a busy machine
ALOFT_M = 15.0
READY_S = 120.0


def holds(vehicle: ScenarioVehicle, load: FlightLoad) -> bool:
    """By its second link."""
    autopilot_type = AutopilotType.ARDUPILOT
    return all(
        not differences(load.of(kind), onboard_list(vehicle.held(kind), kind, autopilot_type), autopilot_type) for kind in MissionType
    )


def wait_until_ready(vehicle: ScenarioVehicle) -> None:
    wait_for(lambda: vehicle.is_ready, "that it may be armed", patience_s=READY_S)


def bring(vehicle: ScenarioVehicle, mission: Mission) -> UavCommand:
    wait_until_ready(vehicle)
    upload = ended(dispatch(mission))
    assert upload.state == CommandState.APPLIED, upload.outcome
    assert holds(vehicle, load_of(upload).load)
    return upload


def take_off(vehicle: ScenarioVehicle, uav: Uav, mission: Mission) -> UavCommand:
    """Returns the upload, once it is on its way."""
    upload = bring(vehicle, mission)
    start = ended(begin(uav, mission, upload.approval))
    assert start.state == CommandState.APPLIED, start.outcome
    wait_for(lambda: vehicle.height_m > ALOFT_M, "that it climbs", patience_s=READY_S)
    return upload


def order(uav: Uav, kind: CommandKind, upload: UavCommand | None = None) -> None:
    of_flight = {} if upload is None else {"mission": upload.mission, "approval": upload.approval}
    command = ended(queue_command(uav=uav, kind=kind, actor=None, **of_flight))
    assert command.state == CommandState.APPLIED, f"{kind}: {command.outcome}"


def from_home_m(vehicle: ScenarioVehicle) -> float:
    return short_distance_m(*vehicle.at, *vehicle.place)


def lands(vehicle: ScenarioVehicle) -> None:
    wait_for(lambda: not vehicle.is_armed, "that it has landed and disarmed", patience_s=FLIGHT_S)
    assert abs(vehicle.height_m) < 1.0
