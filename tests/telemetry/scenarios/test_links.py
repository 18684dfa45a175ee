"""Links that lose frames, gateways that are killed, and long lists: what an ArduCopter holds is what was approved."""

import signal

import pytest

from missions.models import CommandKind, CommandState, MissionState
from missions.services.approval.approval import approve_mission
from missions.services.commands.dispatch import load_of
from planning.clearance.lost_link import LostLink
from planning.request import LostLinkRequest
from telemetry.models import TelemetryRecord, TelemetryStream
from tests.accounts.users import a_user
from tests.missions.flights import planned
from tests.telemetry.gateway.commands.test_commands import begin, dispatch, ended
from tests.telemetry.gateway.program import free_port, gateway_program
from tests.telemetry.gateway.station import gateway_at_work, port_of, wait_for
from tests.telemetry.scenarios.flights import FLIGHT_S, holds, lands, order, take_off, wait_until_ready
from tests.telemetry.scenarios.vehicle import RALLY_AT

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]
SPEED = 5.0


@pytest.mark.parametrize(("transport", "loss"), [("udp", 0.0), ("tcp", 0.0), ("udp", 0.3), ("tcp", 0.3)])
def test_more_than_200_items_are_brought(transport, loss, uav, region, new_vehicle, lossy, tmp_path):
    """Points on the legs make a mission of three towers so long. With a fence and a rally point."""
    mission = planned(a_user(), [uav], region.towers[:3], lost_link=LostLinkRequest(LostLink.RETURN, rally_points=(RALLY_AT,)))
    approve_mission(mission=mission, actor=mission.author, longest_leg_m=9.0)
    mission.refresh_from_db()
    with gateway_at_work(tmp_path) as gateway:
        port = port_of(gateway, transport)
        vehicle = new_vehicle(lossy(port, loss, transport).port if loss else port, transport)
        wait_until_ready(vehicle)
        vehicle.set("SIM_SPEEDUP", 1.0)
        upload = ended(dispatch(mission), patience_s=FLIGHT_S)
        assert upload.state == CommandState.APPLIED, upload.outcome
        load = load_of(upload).load
        assert len(load.mission) >= 200 and load.fence and load.rally
        assert holds(vehicle, load)


@pytest.mark.parametrize("transport", ["udp", "tcp"])
def test_a_mission_is_brought_and_flown_off_over_a_link_that_loses_three_of_ten_frames(
    transport, uav, mission, new_vehicle, lossy, tmp_path
):
    with gateway_at_work(tmp_path) as gateway:
        link = lossy(port_of(gateway, transport), 0.3, transport)
        vehicle = new_vehicle(link.port, transport)
        wait_until_ready(vehicle)
        vehicle.set("SIM_SPEEDUP", 1.0)
        upload = ended(dispatch(mission))
        assert upload.state == CommandState.APPLIED, upload.outcome
        assert holds(vehicle, load_of(upload).load)
        start = ended(begin(uav, mission, upload.approval))
        assert start.state == CommandState.APPLIED, start.outcome
        order(uav, CommandKind.RETURN)
        vehicle.set("SIM_SPEEDUP", SPEED)
        lands(vehicle)
    assert link.lost > 20


@pytest.mark.parametrize("transport", ["udp", "tcp"])
def test_a_gateway_that_is_killed_in_flight_is_followed_by_one_that_knows_the_flight(transport, uav, mission, new_vehicle, lossy, tmp_path):
    """By TCP there is a radio between them that connects to the next gateway: the firmware itself does not connect twice."""
    port = free_port(transport)
    with gateway_program(port, tmp_path, name="one", transport=transport) as program:
        vehicle = new_vehicle(lossy(port, 0.0, transport).port if transport == "tcp" else port, transport)
        take_off(vehicle, uav, mission)
        program.send_signal(signal.SIGKILL)
        program.wait()
    before = TelemetryRecord.objects.filter(uav=uav).count()
    with gateway_program(port, tmp_path, name="one", transport=transport):
        wait_for(lambda: TelemetryRecord.objects.filter(uav=uav).count() > before, "reports")
        wait_for(lambda: mission.routes.get().flights_flown == 1, "the flight's end", patience_s=FLIGHT_S)
    mission.refresh_from_db()
    assert mission.state == MissionState.COMPLETED
    assert TelemetryStream.objects.filter(uav=uav).count() == 1, "one boot"
