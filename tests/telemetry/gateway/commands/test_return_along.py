"""A return along the route goes on with the list that is on board, from where that is clear, and sends no list; else it is said."""

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.autopilot_type import AutopilotType
from missions.models import CommandKind, CommandState, Mission, MissionState, Uav
from missions.services.commands.dispatch import load_of
from missions.services.commands.staggered_returns import stuck_returns
from missions.services.commands.steering import command_uav
from telemetry.models import Alert
from telemetry.selectors.alert_words import alert_words
from telemetry.services.alerts.command_alerts import settle_command_alerts
from tests.accounts.users import a_user
from tests.missions.flights import approved, ground
from tests.missions.worlds import rebuild, world, zone_around
from tests.telemetry.gateway.commands.test_commands import AUTOPILOT_TYPES, begin, dispatch, ended, flyer
from tests.telemetry.gateway.station import gateway_at_work, wait_for

pytestmark = pytest.mark.django_db(transaction=True)
HEIGHT = {AutopilotType.PX4: "RTL_RETURN_ALT", AutopilotType.ARDUPILOT: "RTL_ALT"}


@pytest.fixture
def mission(uav, own_folders, tmp_path) -> Mission:
    ground(tmp_path / "hill.tif", 100.0)
    return approved(a_user(), [uav], world().towers[:2])[0]


def half_way(mission: Mission, items) -> tuple[int, LonLat, float]:
    """An item of the list with one before and after it, and the middle of the leg that leads there."""
    placed = [(number, item) for number, item in enumerate(items) if item.command == mavlink.MAV_CMD_NAV_WAYPOINT]
    (_, before), (number, item) = placed[len(placed) // 2 - 1 : len(placed) // 2 + 1]
    lon, lat = np.mean([(one.longitude_e7, one.latitude_e7) for one in (before, item)], axis=0) / 1e7
    return number, LonLat(float(lon), float(lat)), (before.altitude_m + item.altitude_m) / 2


def fly(vehicle, flying, gateway, uav: Uav, mission: Mission, autopilot_type: AutopilotType):
    """Loaded, started, and half way along its list."""
    upload = ended(dispatch(mission))
    assert upload.state == CommandState.APPLIED, upload.outcome
    assert ended(begin(uav, mission, upload.approval)).state == CommandState.APPLIED
    items = load_of(upload).load.mission
    item, place, height_m = half_way(mission, items)
    offset = 1 if autopilot_type is AutopilotType.ARDUPILOT else 0
    vehicle.current_item, flying.at, flying.height_m = item + offset, tuple(place), height_m
    state = gateway.sessions[uav.mavlink_system_id].state
    wait_for(lambda: state.mission_item == item + offset, "its item")
    wait_for(lambda: state.position is not None and abs(state.position.lon - place.lon) < 1e-6, "its place")
    assert Mission.objects.get(pk=mission.pk).state == MissionState.ACTIVE
    return items, item, offset


def uploads(flying) -> int:
    return sum(message.get_type() == "MISSION_COUNT" for message in flying.received)


def along(uav: Uav, mission: Mission):
    return command_uav(uav=Uav.objects.get(pk=uav.pk), kind=CommandKind.RETURN, actor=mission.author, parameters={"along_route": True})


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_it_goes_on_with_its_list_from_where_that_is_clear(autopilot_type, uav, mission, tmp_path):
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway) as flying:
        items, item, offset = fly(vehicle, flying, gateway, uav, mission, autopilot_type)
        sent = uploads(flying)
        command = ended(along(uav, mission))
        assert command.state == CommandState.APPLIED, command.outcome
        assert vehicle.current_item - offset > item, "targets on the way are left out"
        assert items[vehicle.current_item - offset].command == mavlink.MAV_CMD_NAV_WAYPOINT
        given = [number for number, _values in vehicle.taken[-3:]]
        assert mavlink.MAV_CMD_DO_CHANGE_SPEED in given and mavlink.MAV_CMD_DO_SET_MISSION_CURRENT in given
        assert uploads(flying) == sent, "no list is sent in flight"


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_zone_on_the_rest_of_its_way_is_said_and_nothing_is_sent(autopilot_type, uav, mission, tmp_path):
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway) as flying:
        items, item, offset = fly(vehicle, flying, gateway, uav, mission, autopilot_type)
        zone_around((items[-1].longitude_e7 / 1e7, items[-1].latitude_e7 / 1e7), 0.0004, name="Fire brigade")
        rebuild()
        command = ended(along(uav, mission))
        assert (command.state, command.outcome_code) == (CommandState.FAILED, "not-clear")
        assert vehicle.current_item - offset == item
    settle_command_alerts()
    alert = Alert.objects.get(code="return-not-begun", closed_at=None)
    assert alert.level == "critical" and alert.details["acts"] == [{"kind": "return", "uav": uav.pk}]
    assert "does not return along its route" in alert_words(alert.message, alert.values)


@pytest.mark.long
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_height_that_cannot_be_set_is_told_at_once_and_the_return_as_it_is_ends_it(autopilot_type, uav, mission, tmp_path):
    name = HEIGHT[autopilot_type]
    straight = {AutopilotType.PX4: {"RTL_TYPE": 0.0}, AutopilotType.ARDUPILOT: {"RTL_ALT_TYPE": 0.0}}[autopilot_type]
    vehicle = AUTOPILOT_TYPES[autopilot_type](
        parameters={name: 3_000.0 if autopilot_type is AutopilotType.ARDUPILOT else 30.0, "MIS_RESTART": 0.0, **straight}
    )
    vehicle.parameters_kept = {name}
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway) as flying:
        fly(vehicle, flying, gateway, uav, mission, autopilot_type)
        wait_for(lambda: bool(Uav.objects.get(pk=uav.pk).autopilot_return), "parameters that were told")
        command = command_uav(uav=Uav.objects.get(pk=uav.pk), kind=CommandKind.RETURN, actor=mission.author, parameters={"height_m": 75.0})
        assert command.kind == CommandKind.SET_RETURN_HEIGHT
        assert ended(command).state == CommandState.FAILED
        assert not Uav.objects.get(pk=uav.pk).commands.filter(kind=CommandKind.RETURN).exists()
        settle_command_alerts()
        alert = Alert.objects.get(code="return-not-begun", closed_at=None)
        words = alert_words(alert.message, alert.values)
        assert "its return height is not set" in words and "stays" in words
        assert [stuck.pk for stuck in stuck_returns()] == [command.pk]
        home = command_uav(uav=Uav.objects.get(pk=uav.pk), kind=CommandKind.RETURN, actor=mission.author)
        settle_command_alerts()
        assert not Alert.objects.filter(code="return-not-begun", closed_at=None).exists()
        assert ended(home).state == CommandState.APPLIED
