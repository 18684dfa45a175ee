"""What a UAV in flight is told is done by an ArduCopter: hold, go on, return, land, abort; and what it will not do is told in its words."""

import pytest

from mavlink.autopilot_type import COPTER_MODES, Mode
from missions.models import CommandKind, CommandState
from telemetry.models import Alert
from tests.telemetry.gateway.commands.test_commands import begin, ended
from tests.telemetry.gateway.station import gateway_at_work, port_of, wait_for
from tests.telemetry.scenarios.flights import bring, lands, order, take_off

pytestmark = pytest.mark.django_db(transaction=True)


@pytest.mark.parametrize("transport", ["udp", pytest.param("tcp", marks=pytest.mark.long)])
def test_a_flight_is_held_goes_on_and_returns(transport, uav, mission, new_vehicle, tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        vehicle = new_vehicle(port_of(gateway, transport), transport)
        upload = take_off(vehicle, uav, mission)
        order(uav, CommandKind.HOLD)
        wait_for(lambda: vehicle.custom_mode == COPTER_MODES[Mode.HOLD], "its hold")
        order(uav, CommandKind.RESUME, upload)
        wait_for(lambda: vehicle.custom_mode == COPTER_MODES[Mode.MISSION], "its mission")
        order(uav, CommandKind.RETURN)
        wait_for(lambda: vehicle.custom_mode == COPTER_MODES[Mode.RETURN], "its return")
        lands(vehicle)


@pytest.mark.long
@pytest.mark.parametrize(("kind", "mode"), [(CommandKind.LAND, Mode.LAND), (CommandKind.ABORT, Mode.RETURN)])
def test_a_flight_is_ended(kind, mode, uav, mission, new_vehicle, tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        vehicle = new_vehicle(port_of(gateway))
        take_off(vehicle, uav, mission)
        order(uav, kind)
        wait_for(lambda: vehicle.custom_mode == COPTER_MODES[mode], f"{kind}")
        lands(vehicle)


@pytest.mark.long
def test_a_refusal_to_arm_is_told_in_its_own_words(uav, mission, new_vehicle, tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        vehicle = new_vehicle(port_of(gateway), parameters={"BATT_MONITOR": 4.0, "BATT_ARM_VOLT": 20.0})
        upload = bring(vehicle, mission)
        start = ended(begin(uav, mission, upload.approval))
        assert start.state == CommandState.FAILED and not vehicle.is_armed
        assert "below minimum arming voltage" in start.outcome, start.outcome


@pytest.mark.long
def test_a_list_that_another_ground_station_has_changed_is_not_flown(uav, mission, new_vehicle, tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        vehicle = new_vehicle(port_of(gateway))
        upload = bring(vehicle, mission)
        vehicle.shorten()
        start = ended(begin(uav, mission, upload.approval))
        assert (start.state, start.outcome_code) == (CommandState.FAILED, "other-list"), start.outcome
        assert not vehicle.is_armed
        wait_for(lambda: Alert.objects.filter(code="other-list-on-board", uav=uav, closed_at=None).exists(), "an alert")
