"""Reading back what a vehicle holds."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.mission_sync.compare import differences
from mavlink.mission_sync.download import Download
from mavlink.mission_sync.upload import Clear, TransferState
from mavlink.mission_sync.wire import onboard_list
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import MissionType
from tests.mavlink.mission_sync.test_upload import ack
from tests.telemetry.vehicles.ardupilot import AUTO, ArduPilot
from tests.telemetry.vehicles.channel import Channel, Link
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES, mission, polygon
from tests.telemetry.vehicles.vehicle import Vehicle

RULES = TransferRules()
KIND = MissionType.MISSION


def holding(autopilot_type: str, items: int) -> Vehicle:
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    vehicle.lists[KIND] += mission(items)
    return vehicle


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("loss", [0.0, 0.3])
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_list_is_read_as_it_is_over_a_bad_link(autopilot_type: str, loss: float, seed: int):
    download = Download(KIND, ADDRESSING, RULES)
    outcome = Channel(download, holding(autopilot_type, 60), Link(loss, duplicates=0.1, reordered=0.1), seed).run()
    assert outcome.state is TransferState.DONE
    assert not differences(mission(60), onboard_list(download.read, KIND, AutopilotType(autopilot_type)), AutopilotType(autopilot_type))


@pytest.mark.parametrize("seed", range(10))
def test_reading_that_px4_breaks_off_for_a_late_request_is_paced_from_then_on(seed: int):
    """Nothing is lost, but every tenth request comes twice, and some of these late."""
    download = Download(KIND, ADDRESSING, RULES)
    channel = Channel(download, holding("px4", 200), Link(duplicates=0.1, reordered=0.1), seed)
    assert channel.run().state is TransferState.DONE
    begun = [message.get_type() for message in channel.to_vehicle].count("MISSION_REQUEST_LIST")
    assert begun <= 3


def test_empty_list_is_read_at_once():
    download = Download(MissionType.FENCE, ADDRESSING, RULES)
    channel = Channel(download, AUTOPILOT_TYPES["px4"]())
    assert channel.run().state is TransferState.DONE
    assert (download.read, len(channel.to_vehicle)) == ((), 2)


def test_fence_is_read_apart_from_the_mission():
    vehicle = holding("px4", 9)
    vehicle.lists[MissionType.FENCE] += polygon(0)
    download = Download(MissionType.FENCE, ADDRESSING, RULES)
    Channel(download, vehicle).run()
    assert [there.item.command for there in download.read] == [mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION] * 4


def test_reading_waits_until_an_upload_of_another_time_is_over():
    """ArduPilot denies it for as long as it waits for items, 8 s."""
    vehicle = holding("ardupilot", 9)
    assert isinstance(vehicle, ArduPilot)
    vehicle._mission_count(mavlink.MAVLink_mission_count_message(7, 1, 30, 0), -2.0)
    download = Download(KIND, ADDRESSING, RULES)
    assert Channel(download, vehicle).run().state is TransferState.DONE
    assert len(download.read) == 10


def test_silence_is_told():
    vehicle = holding("px4", 9)
    vehicle.is_alive = False
    assert Channel(Download(KIND, ADDRESSING, RULES), vehicle).run().code == "silent"


def test_vehicle_without_such_a_list_is_told_apart():
    download = Download(MissionType.RALLY, ADDRESSING, RULES)
    download.start(0.0)
    download.receive(ack(mavlink.MAV_MISSION_UNSUPPORTED, int(MissionType.RALLY)), 0.1)
    download.tick(0.1 + RULES.timeout_s)
    assert download.outcome is not None
    assert (download.outcome.state, download.outcome.code) == (TransferState.REFUSED, "unsupported")


def test_reading_can_be_cancelled():
    download = Download(KIND, ADDRESSING, RULES)
    download.start(0.0)
    (stated,) = download.cancel(0.1)
    assert stated.type == mavlink.MAV_MISSION_OPERATION_CANCELLED
    assert download.outcome is not None
    assert download.outcome.state is TransferState.CANCELLED


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_list_is_taken_off_over_a_bad_link(autopilot_type: str, seed: int):
    vehicle = holding(autopilot_type, 9)
    assert (
        Channel(Clear(KIND, ADDRESSING, RULES), vehicle, Link(0.3, duplicates=0.1, reordered=0.1), seed).run().state is TransferState.DONE
    )
    assert not onboard_list(tuple(vehicle.held(KIND)), KIND, AutopilotType(autopilot_type))


def test_clearing_that_is_refused_in_flight_is_told():
    vehicle = holding("ardupilot", 9)
    vehicle.is_armed, vehicle.is_in_air, vehicle.custom_mode = True, True, AUTO
    outcome = Channel(Clear(KIND, ADDRESSING, RULES), vehicle).run()
    assert (outcome.state, outcome.code) == (TransferState.REFUSED, "error")
    assert len(vehicle.lists[KIND]) == 10
