"""Links that lose frames, gateways that are killed, and long lists: what an ArduCopter holds is what was approved."""

import signal

import pytest

from missions.models import CommandKind, CommandState, MissionState
from missions.services.approval import approve_mission
from missions.services.dispatch import load_of
from telemetry.models import TelemetryRecord, TelemetryStream
from tests.missions.flights import planned
from tests.sitl.flights import FLIGHT_S, holds, lands, order, take_off, wait_until_ready
from tests.telemetry.gateway.program import free_port, gateway_program
from tests.telemetry.gateway.station import gateway_at_work, port_of, wait_for
from tests.telemetry.gateway.test_commands import begin, dispatch, ended
from tests.workspace.people import somebody

pytestmark = pytest.mark.django_db(transaction=True)
PACE = 5.0


@pytest.mark.parametrize(("transport", "loss"), [("udp", 0.0), ("tcp", 0.0), ("udp", 0.3)])
def test_more_than_200_items_are_brought(transport, loss, uav, region, firmware, lossy, tmp_path):
    """Points on the legs make a mission of three towers so long."""
    mission = planned(somebody(), [uav], region.towers[:3])
    approve_mission(mission=mission, actor=mission.author, longest_leg_m=9.0)
    mission.refresh_from_db()
    with gateway_at_work(tmp_path) as gateway:
        port = port_of(gateway, transport)
        vehicle = firmware(lossy(port, loss).port if loss else port, transport)
        wait_until_ready(vehicle)
        vehicle.set("SIM_SPEEDUP", 1.0)
        upload = ended(dispatch(mission), patience_s=FLIGHT_S)
        assert upload.state == CommandState.APPLIED, upload.outcome
        load = load_of(upload).load
        assert len(load.mission) >= 200 and load.fence
        assert holds(vehicle, load)


def test_a_mission_is_brought_and_flown_off_over_a_link_that_loses_three_of_ten_frames(uav, mission, firmware, lossy, tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        link = lossy(port_of(gateway), 0.3)
        vehicle = firmware(link.port)
        wait_until_ready(vehicle)
        vehicle.set("SIM_SPEEDUP", 1.0)
        upload = ended(dispatch(mission))
        assert upload.state == CommandState.APPLIED, upload.outcome
        assert holds(vehicle, load_of(upload).load)
        start = ended(begin(uav, mission, upload.approval))
        assert start.state == CommandState.APPLIED, start.outcome
        order(uav, CommandKind.RETURN)
        vehicle.set("SIM_SPEEDUP", PACE)
        lands(vehicle)
    assert link.lost > 20


def test_a_gateway_that_is_killed_in_flight_is_followed_by_one_that_knows_the_flight(uav, mission, firmware, tmp_path):
    port = free_port()
    with gateway_program(port, tmp_path, name="one") as program:
        vehicle = firmware(port)
        take_off(vehicle, uav, mission)
        program.send_signal(signal.SIGKILL)
        program.wait()
    before = TelemetryRecord.objects.filter(uav=uav).count()
    with gateway_program(port, tmp_path, name="one"):
        wait_for(lambda: TelemetryRecord.objects.filter(uav=uav).count() > before, "reports")
        wait_for(lambda: mission.routes.get().flights_flown == 1, "the flight's end", patience_s=FLIGHT_S)
    mission.refresh_from_db()
    assert mission.state == MissionState.COMPLETED
    assert TelemetryStream.objects.filter(uav=uav).count() == 1, "one boot"
