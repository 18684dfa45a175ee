"""Commands of the outbox reach vehicles through the gateway, and their rows tell what became of them."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.autopilot_type import AutopilotType
from mavlink.mission_sync.compare import differences
from mavlink.mission_sync.wire import onboard_list
from mavlink.vehicle_plan import FlightLoad, MissionType
from missions.models import Approval, CommandKind, CommandState, Mission, MissionState, TargetState, Uav, UavCommand
from missions.services.commands.commands import queue_command
from missions.services.commands.dispatch import dispatch_mission, load_of
from telemetry.gateway import delivery
from telemetry.models import Alert, UavLink
from telemetry.selectors.alert_words import alert_words
from tests.accounts.users import a_user
from tests.missions.flights import approved, ground
from tests.missions.worlds import UAV_AT, world
from tests.telemetry.gateway.flyer import Flyer
from tests.telemetry.gateway.station import TIMEOUT_S, gateway_at_work, port_of, wait_for
from tests.telemetry.vehicles.ardupilot import ArduPilot
from tests.telemetry.vehicles.px4 import Px4

pytestmark = pytest.mark.django_db(transaction=True)
WAYPOINT = mavlink.MAV_CMD_NAV_WAYPOINT
AUTOPILOT_TYPES = {AutopilotType.PX4: Px4, AutopilotType.ARDUPILOT: ArduPilot}


@pytest.fixture
def mission(uav, own_folders, tmp_path) -> Mission:
    author = a_user()
    ground(tmp_path / "hill.tif", 100.0)
    mission, _ = approved(author, [uav], world().towers[:2])
    return mission


def dispatch(mission: Mission) -> UavCommand:
    (command,) = dispatch_mission(mission=mission, actor=mission.author)
    return command


def begin(uav: Uav, mission: Mission, approval: Approval) -> UavCommand:
    return queue_command(uav=uav, kind=CommandKind.START, actor=None, mission=mission, approval=approval, parameters={"flight": 1})


def ended(command: UavCommand, *, patience_s: float = TIMEOUT_S) -> UavCommand:
    def found() -> bool:
        command.refresh_from_db()
        return command.state in (CommandState.APPLIED, CommandState.FAILED, CommandState.EXPIRED)

    wait_for(found, f"the end of {command.kind}", patience_s=patience_s)
    return command


def holds(vehicle, load: FlightLoad, autopilot_type: AutopilotType) -> bool:
    return all(
        not differences(load.of(kind), onboard_list(vehicle.held(kind), kind, autopilot_type), autopilot_type) for kind in MissionType
    )


def flyer(vehicle, gateway, **values) -> Flyer:
    return Flyer(vehicle, port_of(gateway), **{"at": UAV_AT, "altitude_amsl_m": 101.0, **values})


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_mission_is_brought_started_and_taken_off(autopilot_type, uav, mission, tmp_path):
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        load = load_of(upload)
        assert upload.state == CommandState.APPLIED, upload.outcome
        assert holds(vehicle, load.load, autopilot_type)
        link = UavLink.objects.get(uav=uav)
        assert (link.loaded_sha256, link.loaded_approval, link.loaded_flight) == (load.content_sha256, upload.approval_id, 1)
        states = list(upload.events.values_list("state", flat=True))
        assert states[:2] == ["queued", "sent"] and states[-1] == "applied"

        start = queue_command(
            uav=uav, kind=CommandKind.START, actor=None, mission=mission, approval=upload.approval, parameters={"flight": 1}
        )
        assert ended(start).state == CommandState.APPLIED, start.outcome
        assert vehicle.is_in_air
        mission.refresh_from_db()
        assert mission.state == MissionState.ACTIVE

        hold = queue_command(uav=uav, kind=CommandKind.HOLD, actor=None)
        assert ended(hold).state == CommandState.APPLIED, hold.outcome


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_mission_is_flown_by_what_the_vehicle_tells(autopilot_type, uav, mission, tmp_path):
    vehicle, offset = AUTOPILOT_TYPES[autopilot_type](), 1 if autopilot_type is AutopilotType.ARDUPILOT else 0
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway) as flying:
        upload = ended(dispatch(mission))
        start = begin(uav, mission, upload.approval)
        assert ended(start).state == CommandState.APPLIED, start.outcome
        items = load_of(upload).load.mission
        visits = set(mission.routes.get().waypoints.filter(target__isnull=False).values_list("sequence", flat=True))
        at_target = next(place for place, item in enumerate(items) if item.waypoint in visits and item.command == WAYPOINT)
        session = gateway.sessions[uav.mavlink_system_id]
        wait_for(lambda: session.state.is_in_air, "that it is seen in the air")
        flying.report(mavlink.MAVLink_mission_item_reached_message(at_target + offset))
        wait_for(lambda: mission.targets.filter(state=TargetState.IN_PROGRESS).exists(), "a target in progress")

        vehicle.current_item = len(items) - 1 + offset  # as it tells each second
        wait_for(lambda: session.state.mission_item == len(items) - 1 + offset)
        last = {"mission_item": len(items) - 1 + offset, "waypoint_sequence": items[-1].waypoint}
        wait_for(lambda: mission.records.filter(**last).exists(), "a record at the last waypoint")
        wait_for(lambda: UavLink.objects.filter(uav=uav, **last).exists(), "the link at the last waypoint")
        assert mission.routes.get().flights_flown == 0
        vehicle.touch_down()
        wait_for(lambda: mission.routes.get().flights_flown == 1, "the flight's end")
    mission.refresh_from_db()
    assert mission.state == MissionState.COMPLETED
    assert set(mission.targets.values_list("state", flat=True)) == {TargetState.COMPLETE}


def test_a_start_without_the_mission_on_the_vehicle_is_refused(uav, mission, tmp_path):
    with gateway_at_work(tmp_path) as gateway, flyer(ArduPilot(), gateway):
        start = begin(uav, mission, mission.approvals.get())
        assert (ended(start).state, start.outcome_code) == (CommandState.FAILED, "not-loaded")


@pytest.mark.parametrize(
    ("facts", "code"), [({"at": LonLat(UAV_AT.lon + 0.01, UAV_AT.lat)}, "elsewhere"), ({"altitude_amsl_m": 900.0}, "other-height")]
)
def test_a_vehicle_that_stands_elsewhere_is_given_nothing(facts, code, uav, mission, tmp_path):
    vehicle = ArduPilot()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway, **facts) as flying:
        upload = ended(dispatch(mission))
        assert (upload.state, upload.outcome_code) == (CommandState.FAILED, code), upload.outcome
        assert not any(message.get_type() == "MISSION_COUNT" for message in flying.received)


def test_a_refused_upload_is_told_and_leaves_no_mix(uav, mission, tmp_path):
    vehicle = ArduPilot(refuses={3: mavlink.MAV_MISSION_INVALID_PARAM7})
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        assert (upload.state, UavLink.objects.get(uav=uav).loaded_sha256) == (CommandState.FAILED, "")
        assert len(vehicle.lists[MissionType.MISSION]) == 1, "home alone"
        wait_for(lambda: not Alert.objects.filter(closed_at=None).exists())
        assert Alert.objects.filter(code="mission-mixed", level="critical", uav=uav).exists(), "it was mixed for a while"


def test_commands_wait_for_a_vehicle_that_is_not_there(uav, tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        hold = queue_command(uav=uav, kind=CommandKind.HOLD, actor=None)
        vehicle = Px4(is_armed=True, is_in_air=True)
        with flyer(vehicle, gateway):
            assert ended(hold).state == CommandState.APPLIED, hold.outcome


def test_a_later_command_takes_the_place_of_one_that_goes_on(uav, tmp_path):
    vehicle = Px4(denied={mavlink.MAV_CMD_DO_SET_MODE: mavlink.MAV_RESULT_IN_PROGRESS}, is_armed=True, is_in_air=True)
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        first = queue_command(uav=uav, kind=CommandKind.HOLD, actor=None)
        wait_for(lambda: UavCommand.objects.filter(pk=first.pk, state=CommandState.SENT).exists())
        second = queue_command(uav=uav, kind=CommandKind.RETURN, actor=None)
        vehicle.denied.clear()
        assert ended(second).state == CommandState.APPLIED, second.outcome
    first.refresh_from_db()
    assert (first.state, first.outcome_code) == (CommandState.EXPIRED, "superseded")


def test_a_stopped_gateway_gives_its_commands_back(uav, tmp_path):
    vehicle = Px4(denied={mavlink.MAV_CMD_DO_SET_MODE: mavlink.MAV_RESULT_IN_PROGRESS}, is_armed=True, is_in_air=True)
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        hold = queue_command(uav=uav, kind=CommandKind.HOLD, actor=None)
        wait_for(lambda: UavCommand.objects.filter(pk=hold.pk, state=CommandState.SENT).exists())
    hold.refresh_from_db()
    assert (hold.state, hold.holder) == (CommandState.QUEUED, "")
    vehicle.denied.clear()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        assert ended(hold).state == CommandState.APPLIED


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_list_that_somebody_else_has_put_there_is_not_flown(autopilot_type, uav, mission, tmp_path):
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        vehicle.lists[MissionType.MISSION] = vehicle.lists[MissionType.MISSION][:-1]
        start = ended(begin(uav, mission, upload.approval))
        assert (start.state, start.outcome_code) == (CommandState.FAILED, "other-list"), start.outcome
        assert not vehicle.is_armed and UavLink.objects.get(uav=uav).loaded_sha256 == ""
        alert = Alert.objects.get(code="other-list-on-board")
        assert (alert.uav, alert.mission, alert.level, alert.closed_at) == (uav, mission, "critical", None)
        assert "another list than the approved one" in alert_words(alert.message, alert.values)
        (again,) = dispatch_mission(mission=mission, actor=mission.author, place=0)
        assert ended(again).state == CommandState.APPLIED
        alert.refresh_from_db()
        assert alert.close_reason == "cleared", "the approved one is on board"


def test_a_list_that_nobody_approved_is_not_resumed(uav, mission, tmp_path):
    vehicle = ArduPilot(is_armed=True, is_in_air=True, custom_mode=17)
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        alone = ended(queue_command(uav=uav, kind=CommandKind.RESUME, actor=None))
        assert (alone.state, alone.outcome_code) == (CommandState.FAILED, "no-mission")
        Mission.objects.filter(pk=mission.pk).update(state=MissionState.ACTIVE)
        own = queue_command(uav=uav, kind=CommandKind.RESUME, actor=None, mission=mission, approval=mission.approvals.get())
        assert (ended(own).state, own.outcome_code) == (CommandState.FAILED, "not-loaded")
    assert vehicle.custom_mode == 17


@pytest.mark.long
def test_a_mission_is_taken_off_once_the_vehicle_may_be_written_to(uav, mission, tmp_path, monkeypatch):
    monkeypatch.setattr(delivery, "CLEAR_AGAIN_IN_S", 0.2)
    vehicle = ArduPilot()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        vehicle.is_armed = vehicle.is_in_air = True
        vehicle.custom_mode = 3
        session = gateway.sessions[uav.mavlink_system_id]
        wait_for(lambda: session.state.is_armed)
        clear = queue_command(uav=uav, kind=CommandKind.CLEAR_MISSION, actor=None, mission=mission, approval=upload.approval)
        wait_for(lambda: clear.events.filter(state=CommandState.QUEUED, attempt__gte=2).exists(), "another try")
        assert len(vehicle.lists[MissionType.MISSION]) > 1
        vehicle.is_armed = vehicle.is_in_air = False
        assert ended(clear).state == CommandState.APPLIED, clear.outcome
    assert len(vehicle.lists[MissionType.MISSION]) == 1, "home alone"


@pytest.mark.long
@pytest.mark.parametrize("autopilot_type", [pytest.param(AutopilotType.PX4, marks=pytest.mark.long), AutopilotType.ARDUPILOT])
def test_a_vehicle_that_goes_over_to_another_gateway_in_mid_upload_holds_what_was_approved(autopilot_type, uav, mission, tmp_path):
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    with (
        gateway_at_work(tmp_path, name="one") as one,
        gateway_at_work(tmp_path, name="two") as two,
        flyer(vehicle, one, loss=0.2) as flying,
    ):
        wait_for(lambda: UavLink.objects.filter(uav=uav, holder__startswith="one/").exists())
        upload = dispatch(mission)
        wait_for(lambda: vehicle.received_items >= 2, "some items")
        flying.move_to(port_of(two))
        assert UavCommand.objects.get(pk=upload.pk).state == CommandState.SENT, "in mid-upload"
        assert ended(upload).state == CommandState.APPLIED, upload.outcome
        assert upload.holder.startswith("two/") and upload.attempts == 2
        assert holds(vehicle, load_of(upload).load, autopilot_type)
        wait_for(lambda: not Alert.objects.filter(closed_at=None, level="critical").exists(), "no alert")
