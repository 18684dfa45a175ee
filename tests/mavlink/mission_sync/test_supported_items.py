"""A vehicle is sent what its firmware knows, and what it refuses all the same is named."""

import math
from dataclasses import replace

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.mission_sync.outcome import SyncOutcome, SyncState
from mavlink.mission_sync.supported_items import version_of
from mavlink.mission_sync.sync import MissionSync
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import FlightLoad, MissionItem, MissionType
from operation.reasons import english
from tests.telemetry.vehicles.ardupilot import ArduPilot
from tests.telemetry.vehicles.channel import Channel
from tests.telemetry.vehicles.loads import ADDRESSING, PLACELESS, RELATIVE, known, load, polygon, waypoint
from tests.telemetry.vehicles.px4 import Px4
from tests.telemetry.vehicles.vehicle import Vehicle

PHOTO = MissionItem(mavlink.MAV_CMD_IMAGE_START_CAPTURE, PLACELESS, (0.0, 0.0, 1.0, 0.0))
LOOK_AT = MissionItem(mavlink.MAV_CMD_DO_SET_ROI_LOCATION, RELATIVE, (0.0, 0.0, 0.0, 0.0), 98_001_234, 554_004_321, -2.35, 1)
LOOK_AHEAD = MissionItem(mavlink.MAV_CMD_DO_SET_ROI_NONE, PLACELESS, (0.0, 0.0, 0.0, 0.0), waypoint=1)
TAKE_OFF = MissionItem(mavlink.MAV_CMD_NAV_TAKEOFF, RELATIVE, (0.0, 0.0, 0.0, math.nan), 98_000_000, 554_000_000, 60.0)
LOOKING = FlightLoad((TAKE_OFF, waypoint(0), LOOK_AT, waypoint(1, hold_s=9.0), LOOK_AHEAD, waypoint(2)))


def bring(vehicle: Vehicle, new: FlightLoad, firmware: tuple[int, int, int] | None = None) -> tuple[SyncOutcome, Channel]:
    state = known(vehicle)
    state.firmware = firmware
    channel = Channel(MissionSync(new, state, ADDRESSING, TransferRules()), vehicle)
    return channel.run(), channel


@pytest.mark.parametrize(
    ("firmware", "reported", "commands"),
    [
        ((4, 6, 0), (4, 6, 0), [201, 201]),
        ((4, 6, 0), None, [201, 201]),
        ((4, 7, 0), (4, 7, 0), [195, 197]),
        ((4, 7, 0), None, [201, 201]),
    ],
)
def test_a_look_is_sent_to_ardupilot_by_what_its_firmware_knows(firmware, reported, commands):
    vehicle = ArduPilot(firmware=firmware)
    outcome, _ = bring(vehicle, LOOKING, reported)
    assert (outcome.state, outcome.sha256) == (SyncState.READY, LOOKING.content_sha256), english(outcome.why)
    held = vehicle.lists[MissionType.MISSION][1:]
    assert [held[2].command, held[4].command] == commands
    assert (held[2].longitude_e7, held[2].latitude_e7) == (LOOK_AT.longitude_e7, LOOK_AT.latitude_e7)
    assert (held[4].longitude_e7, held[4].latitude_e7, held[4].altitude_m) == (0, 0, 0.0)


def test_a_look_at_another_place_by_the_old_command_is_a_difference():
    vehicle = ArduPilot()
    bring(vehicle, LOOKING)
    moved = replace(LOOKING, mission=(*LOOKING.mission[:2], replace(LOOK_AT, latitude_e7=554_004_322), *LOOKING.mission[3:]))
    _, channel = bring(vehicle, moved)
    assert "MISSION_COUNT" in {message.get_type() for message in channel.to_vehicle}
    assert vehicle.lists[MissionType.MISSION][3].latitude_e7 == 554_004_322


def test_px4_is_sent_the_new_commands():
    vehicle = Px4()
    assert bring(vehicle, LOOKING, (1, 14, 0))[0].state is SyncState.READY
    assert [item.command for item in vehicle.lists[MissionType.MISSION] if 190 < item.command < 202] == [195, 197]


def test_what_the_firmware_is_known_to_refuse_is_not_sent():
    vehicle = ArduPilot(firmware=(4, 3, 2))
    outcome, channel = bring(vehicle, FlightLoad((TAKE_OFF, waypoint(0), PHOTO, waypoint(1))), (4, 3, 2))
    assert (outcome.state, outcome.code, channel.to_vehicle) == (SyncState.INTACT, "unknown-command", [])
    assert english(outcome.why) == "Nothing was sent. Not known to ArduPilot 4.3.2: item 2, IMAGE_START_CAPTURE (2000)."


def test_a_refused_item_is_named_with_its_command_and_the_version():
    vehicle = ArduPilot(firmware=(4, 3, 2))
    outcome, _ = bring(vehicle, FlightLoad((TAKE_OFF, waypoint(0), PHOTO, waypoint(1))))
    assert (outcome.state, outcome.code) == (SyncState.INTACT, "unsupported")
    assert "item 2 of the mission, IMAGE_START_CAPTURE (2000) (unsupported)" in english(outcome.why)
    vehicle = ArduPilot(refuses={3: mavlink.MAV_MISSION_INVALID_PARAM7})
    refused = english(bring(vehicle, load(7), (4, 6, 0))[0].why)
    assert refused.startswith("Refused by ArduPilot 4.6.0: item 2 of the mission, NAV_WAYPOINT (16)")


class Skewed(ArduPilot):
    """Gives each corner of a fence back a little farther north."""

    def _as_read(self, item, number, kind):
        message = super()._as_read(item, number, kind)
        message.x += 70 if kind is MissionType.FENCE else 0
        return message


def test_what_comes_back_otherwise_is_named_by_item_field_and_both_values():
    outcome, _ = bring(Skewed(), load(7, fence=polygon(0)))
    assert outcome.code == "differs"
    assert "Of the fence, item 0: latitude was sent as 55.4100000 and came back as 55.4100070." in english(outcome.why)


def test_a_version_is_read_from_its_words():
    assert (version_of("4.6.0"), version_of(""), version_of("1.2"), version_of("a.b.c")) == ((4, 6, 0), None, None, None)
