"""The parameters of a vehicle's own return are read when it is heard, and once more before its mission is sent."""

import pytest

from mavlink.autopilot_type import AutopilotType
from missions.models import CommandKind, CommandState, Mission, Uav
from missions.services.commands.rtl_check import return_checks
from missions.services.commands.steering import command_uav
from tests.accounts.users import a_user
from tests.missions.flights import approved, ground
from tests.missions.worlds import world
from tests.telemetry.gateway.commands.test_commands import AUTOPILOT_TYPES, dispatch, ended, flyer
from tests.telemetry.gateway.station import gateway_at_work, wait_for

pytestmark = pytest.mark.django_db(transaction=True)
REPORTED = {
    AutopilotType.PX4: ({"RTL_RETURN_ALT": 60.0, "RTL_TYPE": 0.0, "RTL_MIN_DIST": 10.0}, {"RTL_RETURN_ALT": 85.0}, 85.0),
    AutopilotType.ARDUPILOT: ({"RTL_ALT": 1_500.0, "RTL_CLIMB_MIN": 0.0, "RTL_ALT_TYPE": 0.0}, {"RTL_ALT": 8_000.0}, 80.0),
}


@pytest.fixture
def mission(uav, settings, tmp_path) -> Mission:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    settings.FLIGHT_LOG_DIR = tmp_path
    ground(tmp_path / "hill.tif", 100.0)
    return approved(a_user(), [uav], world().towers[:2])[0]


@pytest.mark.long
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_the_height_of_its_return_is_read_and_read_anew(autopilot_type, uav, mission, tmp_path):
    first, later, height_m = REPORTED[autopilot_type]
    vehicle = AUTOPILOT_TYPES[autopilot_type](parameters=dict(first))
    reported = {"autopilot": str(autopilot_type), "parameters": first}
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway, loss=0.1):
        wait_for(lambda: Uav.objects.filter(pk=uav.pk, autopilot_return=reported).exists(), "parameters that were told")
        vehicle.parameters |= later  # somebody else sets it, and the vehicle tells nobody
        assert ended(dispatch(mission)).state == CommandState.APPLIED
        now = {"autopilot": str(autopilot_type), "parameters": first | later}
        wait_for(lambda: Uav.objects.filter(pk=uav.pk, autopilot_return=now).exists(), "parameters that were read anew")
    (check,) = return_checks(Mission.objects.get(pk=mission.pk))
    assert check.height_m == height_m
    assert check.read_at is not None


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_the_height_of_its_return_is_set_and_read_back(autopilot_type, uav, mission, tmp_path):
    first, _later, _height_m = REPORTED[autopilot_type]
    vehicle = AUTOPILOT_TYPES[autopilot_type](parameters=dict(first))
    name = next(iter(first))
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway, loss=0.1):
        wait_for(lambda: name in Uav.objects.get(pk=uav.pk).autopilot_return.get("parameters", {}), "the parameter of its height")
        command = command_uav(
            uav=Uav.objects.get(pk=uav.pk), kind=CommandKind.SET_RETURN_HEIGHT, actor=mission.author, parameters={"height_m": 74.2}
        )
        assert ended(command).state == CommandState.APPLIED
        assert vehicle.parameters[name] == (75.0 if autopilot_type is AutopilotType.PX4 else 7_500.0)
        wait_for(lambda: return_checks(Mission.objects.get(pk=mission.pk))[0].height_m == 75.0, "the height that was read back")
