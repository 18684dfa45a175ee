"""Missions with a fence, a rally point and every task are brought to an ArduCopter and flown to their end, by UDP and TCP."""

import pytest

from inspection.geodesy import LonLat
from missions.mavlink.content import MissionType
from missions.models import CommandState, Mission, MissionState, TargetState, Uav
from missions.flight_plan.lost_link import LostLink
from missions.routing.problem import Task, TaskKind
from missions.services import TargetRequest
from missions.services.dispatch import load_of
from missions.services.requests import LostLinkRequest
from telemetry.ground_station.compare import differences
from telemetry.ground_station.flavour import Flavour
from telemetry.ground_station.wire import held_list
from telemetry.models import TelemetryRecord, UavLink
from tests.missions.flights import approved, ground
from tests.missions.worlds import UAV_AT, world, zone_around
from tests.sitl.firmware import Firmware
from tests.telemetry.gateway.station import gateway_at_work, port_of, unsigned_uav, wait_for
from tests.telemetry.gateway.test_commands import begin, dispatch, ended
from tests.workspace.people import somebody

pytestmark = pytest.mark.django_db(transaction=True)
FLIGHT_S = 400.0  # of patience, with a mission of some 250 s at five times its pace on a busy machine


@pytest.fixture
def uav() -> Uav:
    return unsigned_uav(7, is_simulated=True)


@pytest.fixture
def mission(uav, settings, tmp_path) -> Mission:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    settings.FLIGHT_LOG_DIR = tmp_path
    ground(tmp_path / "hill.tif", 100.0)
    towers = world().towers
    zone_around((10.010, 56.02), 0.001)
    tasks = [TargetRequest(tower.pk, task=Task(kind, 5.0)) for tower, kind in zip(towers, TaskKind, strict=False)]
    lost = LostLinkRequest(LostLink.RETURN, rally_points=(LonLat(UAV_AT.lon + 0.001, UAV_AT.lat),))
    return approved(somebody(), [uav], tasks, lost_link=lost)[0]


def holds(vehicle: Firmware, load) -> bool:
    flavour = Flavour.ARDUPILOT
    return all(not differences(load.of(kind), held_list(vehicle.held(kind), kind, flavour), flavour) for kind in MissionType)


@pytest.mark.parametrize("transport", ["udp", "tcp"])
def test_a_mission_is_brought_and_flown_to_its_end(transport, uav, mission, firmware, tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        vehicle = firmware(port_of(gateway, transport), transport)
        wait_for(lambda: vehicle.is_ready, "that it is ready")
        upload = ended(dispatch(mission))
        assert upload.state == CommandState.APPLIED, upload.outcome
        load = load_of(upload).load
        assert load.fence and load.rally and holds(vehicle, load)
        assert "The fence on the UAV does nothing: FENCE_ENABLE 0." in upload.outcome
        start = ended(begin(uav, mission, upload.approval))
        assert start.state == CommandState.APPLIED, start.outcome
        wait_for(lambda: mission.routes.get().flights_flown == 1, "the flight's end", patience_s=FLIGHT_S)
        link = UavLink.objects.get(uav=uav)
        print(transport, len(load.mission), len(load.fence), len(load.rally), "items;", link.received_bytes_s, link.received_messages_s)
    mission.refresh_from_db()
    assert mission.state == MissionState.COMPLETED
    assert set(mission.targets.values_list("state", flat=True)) == {TargetState.COMPLETE}
    assert TelemetryRecord.objects.filter(uav=uav).exists() and not vehicle.is_armed
