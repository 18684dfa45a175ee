"""Missions with a fence, a rally point and every task are brought to an ArduCopter and flown to their end, by UDP and TCP."""

import pytest

from missions.models import MissionState, TargetState
from missions.services.commands.dispatch import load_of
from telemetry.models import TelemetryRecord, UavLink
from tests.telemetry.gateway.station import gateway_at_work, port_of, wait_for
from tests.telemetry.scenarios.flights import FLIGHT_S, bring, take_off

pytestmark = pytest.mark.django_db(transaction=True)
MAX_BYTES_S, MAX_MESSAGES_S = 800.0, 25.0  # 3,390 and 95 before streams were turned off


@pytest.mark.parametrize("transport", ["udp", pytest.param("tcp", marks=pytest.mark.long)])
def test_a_mission_is_brought_and_flown_to_its_end(transport, uav, mission, new_vehicle, tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        vehicle = new_vehicle(port_of(gateway, transport), transport)
        upload = take_off(vehicle, uav, mission)
        load = load_of(upload).load
        assert load.fence and load.rally
        assert "The fence on the UAV does nothing: FENCE_ENABLE 0." in upload.outcome
        wait_for(lambda: mission.routes.get().flights_flown == 1, "the flight's end", patience_s=FLIGHT_S)
    mission.refresh_from_db()
    assert mission.state == MissionState.COMPLETED
    assert set(mission.targets.values_list("state", flat=True)) == {TargetState.COMPLETE}
    assert TelemetryRecord.objects.filter(uav=uav).exists() and not vehicle.is_armed


@pytest.mark.long
@pytest.mark.parametrize("transport", ["udp", pytest.param("tcp", marks=pytest.mark.long)])
def test_it_says_no_more_than_it_is_asked_for(transport, uav, mission, new_vehicle, tmp_path):
    """At its own pace: a window of the rate is 10 s."""
    with gateway_at_work(tmp_path) as gateway:
        vehicle = new_vehicle(port_of(gateway, transport), transport)
        bring(vehicle, mission)
        vehicle.set("SIM_SPEEDUP", 1.0)
        link = UavLink.objects.filter(uav=uav, received_bytes_s__gt=300.0, received_bytes_s__lt=MAX_BYTES_S)
        wait_for(lambda: link.filter(received_messages_s__gt=10.0, received_messages_s__lt=MAX_MESSAGES_S).exists(), "the rate asked for")
        rate = link.get()
        print(f"{transport}: {rate.received_bytes_s:.0f} bytes and {rate.received_messages_s:.1f} messages a second")
