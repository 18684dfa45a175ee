"""Missions with a fence and with looks are brought, flown and ended on an ArduCopter; other kinds of vehicles are only shown."""

import time

import pytest

from mavlink.autopilot_type import AutopilotType
from missions.models import CommandKind, CommandState, Mission, MissionState
from missions.services import TargetRequest
from missions.services.commands.commands import queue_command
from missions.services.commands.dispatch import load_of
from planning.task import Task, TaskKind
from telemetry.models import TelemetryRecord, UavLink
from tests.accounts.users import a_user, client_of
from tests.cases import long
from tests.missions.flights import approved, ground
from tests.missions.worlds import world, zone_around
from tests.telemetry.gateway.commands.test_commands import begin, dispatch, ended, flyer, holds
from tests.telemetry.gateway.station import gateway_at_work, wait_for
from tests.telemetry.vehicles.ardupilot import ArduPilot

pytestmark = pytest.mark.django_db(transaction=True)
PLANE, ROVER = 1, 10


@pytest.fixture
def mission(uav, settings, tmp_path) -> Mission:
    """With a zone beside its route, and a look at its tower."""
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    settings.FLIGHT_LOG_DIR = tmp_path
    ground(tmp_path / "hill.tif", 100.0)
    towers = world().towers
    zone_around((10.010, 56.02), 0.001)
    return approved(a_user(), [uav], [TargetRequest(towers[0].pk, task=Task(TaskKind.LOOK, 5.0)), towers[1]])[0]


@pytest.mark.parametrize("item_after_landing", [0, *long(1)])
def test_a_mission_with_a_fence_and_a_look_is_flown_to_its_end_by_an_arducopter(item_after_landing, uav, mission, tmp_path):
    vehicle = ArduPilot(item_after_landing=item_after_landing)
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        assert upload.state == CommandState.APPLIED, upload.outcome
        load = load_of(upload).load
        assert load.fence and holds(vehicle, load, AutopilotType.ARDUPILOT)
        assert [item.command for item in vehicle.lists[0] if 190 < item.command < 202] == [201, 201]
        assert "The fence on the UAV does nothing: FENCE_ENABLE 0." in upload.outcome
        start = ended(begin(uav, mission, upload.approval))
        assert start.state == CommandState.APPLIED, start.outcome
        session = gateway.sessions[uav.mavlink_system_id]
        wait_for(lambda: session.state.is_in_air, "that it is seen in the air")
        vehicle.current_item = len(load.mission)
        wait_for(lambda: session.state.mission_item == len(load.mission), "that it is bound for the landing")
        vehicle.touch_down()
        wait_for(lambda: mission.routes.get().flights_flown == 1, "the flight's end")
    mission.refresh_from_db()
    assert mission.state == MissionState.COMPLETED
    winds = set(TelemetryRecord.objects.filter(uav=uav).values_list("wind_north_mps", flat=True))
    assert winds == {None}, "no calm that nobody measured"


@pytest.mark.long
def test_a_gateway_that_is_replaced_before_the_touch_down_knows_that_it_was_flown(uav, mission, tmp_path):
    vehicle = ArduPilot()
    with gateway_at_work(tmp_path, name="one") as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        assert ended(begin(uav, mission, upload.approval)).state == CommandState.APPLIED
        items = len(load_of(upload).load.mission)
        vehicle.current_item = items
        bound = UavLink.objects.filter(uav=uav, mission_item=items, is_in_air=True, is_armed=True, mode="AUTO")
        wait_for(lambda: bound.exists(), "a link that is bound for the landing")
    vehicle.touch_down()
    with gateway_at_work(tmp_path, name="two") as gateway, flyer(vehicle, gateway):
        wait_for(lambda: mission.routes.get().flights_flown == 1, "the flight's end")


@pytest.mark.long
@pytest.mark.parametrize(("vehicle_type", "number", "mode", "kind"), [(PLANE, 5, "FLY_BY_WIRE_A", "plane"), (ROVER, 10, "AUTO", "rover")])
def test_another_kind_of_vehicle_is_shown_and_takes_neither_mission_nor_command(vehicle_type, number, mode, kind, uav, mission, tmp_path):
    vehicle = ArduPilot(vehicle_type=vehicle_type, custom_mode=number)
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        assert (upload.state, upload.outcome_code) == (CommandState.FAILED, "vehicle-class"), upload.outcome
        assert f"The vehicle is a {kind}:" in upload.outcome
        for order in (CommandKind.HOLD, CommandKind.RETURN, CommandKind.LAND):
            reported = ended(queue_command(uav=uav, kind=order, actor=None))
            assert (reported.state, reported.outcome_code) == (CommandState.FAILED, "vehicle-class"), reported.outcome
        wait_for(lambda: UavLink.objects.filter(uav=uav, vehicle_type=vehicle_type, mode=mode).exists(), "its kind and mode")
        assert not gateway.sessions[uav.mavlink_system_id].may_receive(time.time()), "nothing is sent to it unheard"
    assert vehicle.taken == [] and vehicle.custom_mode == number
    connection = client_of(mission.author).get(f"/api/v1/uavs/{uav.pk}/connection").json()
    assert connection["vehicle_type"] in ("fixed wing", "ground rover")
    assert connection["warnings"][0] == f"UAV 7 is a {kind}: Spanwise plans for and commands multicopters only."
