"""A mission is approved, sent, started, held, resumed and flown to its end by a simulated UAV that the gateway takes for any other."""

import pytest
from pymavlink.dialects.v20.common import MAV_CMD_IMAGE_START_CAPTURE

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionType
from missions.models import CommandKind, CommandState, Mission, MissionState, TargetState, Uav, UavCommand
from missions.services import TargetRequest
from missions.services.commands.commands import queue_command
from missions.services.commands.dispatch import dispatch_mission, load_of
from planning.task import Task, TaskKind
from simulation.flight.plant import FlatGround
from simulation.vehicle_endpoint.launch import Launch
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from telemetry.models import Capture, TelemetryRecord, UavLink
from tests.accounts.users import a_user
from tests.missions.flights import approved, ground
from tests.missions.worlds import UAV_AT, world
from tests.simulation.fleets import flying, free_port
from tests.telemetry.gateway.program import gateway_program
from tests.telemetry.gateway.station import signed_uav, wait_for

pytestmark = pytest.mark.django_db(transaction=True)
GROUND_M = 100.0
SYSTEM = 7
SPEED = 20.0


@pytest.fixture
def uav_and_key() -> tuple[Uav, bytes]:
    return signed_uav(SYSTEM, a_user())


@pytest.fixture
def mission(settings, tmp_path, uav_and_key) -> Mission:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    settings.FLIGHT_LOG_DIR = tmp_path
    ground(tmp_path / "hill.tif", GROUND_M)
    target = TargetRequest(world().towers[0].pk, task=Task(TaskKind.PHOTO, 6.0))
    mission, _ = approved(a_user(), [uav_and_key[0]], [target])
    return mission


def ended(command: UavCommand) -> UavCommand:
    def found() -> bool:
        command.refresh_from_db()
        return command.state in (CommandState.APPLIED, CommandState.FAILED, CommandState.EXPIRED)

    wait_for(found, f"the end of {command.kind}")
    assert command.state == CommandState.APPLIED, command.outcome
    return command


def fresh(mission: Mission) -> Mission:
    mission.refresh_from_db()
    return mission


@pytest.mark.long
@pytest.mark.parametrize("autopilot_type", list(SimulatedAutopilot))
def test_a_mission_is_flown_to_its_end(autopilot_type, uav_and_key, mission, tmp_path):
    uav, key = uav_and_key
    port = free_port()
    ground_below, station = FlatGround(GROUND_M), ("127.0.0.1", port)
    launch = Launch(
        SYSTEM, LonLat(*UAV_AT), airframe="inspector", autopilot_type=autopilot_type, key=key, ground=ground_below, talks_to=[station]
    )
    with gateway_program(port, tmp_path), flying([launch], speed=SPEED) as fleet:
        (upload,) = dispatch_mission(mission=mission, actor=mission.author)
        load = load_of(ended(upload))
        assert UavLink.objects.get(uav=uav).loaded_sha256 == load.content_sha256
        endpoint = fleet.uavs[0].endpoint
        assert len(endpoint.missions.held[MissionType.MISSION]) == len(load.load.mission)

        def order(kind: CommandKind) -> None:
            parameters = {"flight": 1} if kind == CommandKind.START else {}
            with_mission = kind in (CommandKind.START, CommandKind.RESUME)
            approval, of = (upload.approval, mission) if with_mission else (None, None)
            ended(queue_command(uav=uav, kind=kind, actor=None, mission=of, approval=approval, parameters=parameters))

        order(CommandKind.START)
        assert fresh(mission).state == MissionState.ACTIVE
        order(CommandKind.HOLD)
        order(CommandKind.RESUME)
        wait_for(lambda: fresh(mission).state == MissionState.COMPLETED, "the end of the mission", patience_s=90.0)
    assert set(mission.targets.values_list("state", flat=True)) == {TargetState.COMPLETE}
    (waypoint,) = {item.waypoint for item in load.load.mission if item.command == MAV_CMD_IMAGE_START_CAPTURE}
    photos = Capture.objects.filter(mission=mission, uav=uav, is_taken=True)
    assert set(photos.values_list("flight", "waypoint_sequence")) == {(1, waypoint)}
    assert photos.count() == fleet.uavs[0].uav.state.photos == 2
    records = TelemetryRecord.objects.filter(uav=uav)
    assert records.filter(
        is_in_air=True, mode={SimulatedAutopilot.PX4: "MISSION", SimulatedAutopilot.ARDUPILOT: "AUTO"}[autopilot_type]
    ).exists()
    assert records.latest("measured_at").battery_percent < 100
    assert not UavLink.objects.get(uav=uav).losses.get("wrong-signature")
    assert fleet.uavs[0].refused == 0
