"""Uploads that are cut at each message, by the death of either end."""

import pytest

from mavlink.autopilot_type import AutopilotType
from mavlink.mission_sync.compare import ReadbackMatch, differences
from mavlink.mission_sync.outcome import SyncState
from mavlink.mission_sync.sync import MissionSync
from mavlink.mission_sync.wire import onboard_list
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import MissionType
from tests.mavlink.mission_sync.test_lossy_upload import stated_what_is_there
from tests.telemetry.vehicles.channel import Channel
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES, known, load, polygon
from tests.telemetry.vehicles.vehicle import Vehicle

NEW = load(12, fence=polygon(0, 5))
OLD = load(9, east=40_000, fence=polygon(9_000))


def vehicle_with_old(autopilot_type: str) -> Vehicle:
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    for kind in MissionType:
        vehicle.lists[kind] += OLD.of(kind)
    return vehicle


def keeper_for(vehicle: Vehicle) -> MissionSync:
    return MissionSync(NEW, known(vehicle), ADDRESSING, TransferRules(), known=[OLD])


def messages_in_all(autopilot_type: str) -> int:
    vehicle = vehicle_with_old(autopilot_type)
    channel = Channel(keeper_for(vehicle), vehicle)
    assert channel.run().state is SyncState.READY
    return len(channel.to_vehicle)


def contents(vehicle: Vehicle, kind: MissionType) -> ReadbackMatch:
    autopilot_type = AutopilotType(type(vehicle).__name__.lower())
    held = onboard_list(tuple(vehicle.held(kind)), kind, autopilot_type)
    if not differences(NEW.of(kind), held, autopilot_type):
        return ReadbackMatch.APPROVED
    if not differences(OLD.of(kind), held, autopilot_type):
        return ReadbackMatch.KNOWN
    return ReadbackMatch.MIXED if held else ReadbackMatch.NOTHING


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_ground_station_dies_at_each_message(autopilot_type: str):
    """PX4 holds a whole list of one or the other after each cut; ArduPilot may hold a mix, which the next ground station names."""
    mixes = 0
    for sent in range(messages_in_all(autopilot_type)):
        vehicle = vehicle_with_old(autopilot_type)
        channel = Channel(keeper_for(vehicle), vehicle, ground_dies_after=sent)
        channel.run()
        channel.let_pass(20.0)
        found = {kind: contents(vehicle, kind) for kind in MissionType}
        next_one = keeper_for(vehicle)
        outcome = Channel(next_one, vehicle).run()
        mixed = {kind for kind in MissionType if found[kind] is ReadbackMatch.MIXED}
        assert not mixed or autopilot_type == "ardupilot", sent
        assert {mix.kind for mix in outcome.mixes} == mixed, sent
        assert {kind: next_one.found_before[kind] for kind in (MissionType.MISSION, MissionType.FENCE)} == {
            kind: found[kind] for kind in (MissionType.MISSION, MissionType.FENCE)
        }, sent
        assert outcome.state is SyncState.READY
        mixes += len(mixed)
    assert mixes > 0 if autopilot_type == "ardupilot" else mixes == 0


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_vehicle_dies_at_each_message(autopilot_type: str):
    """What the ground station says of a vehicle that fell silent agrees with what is in its memory; back again, it is put right."""
    states = set()
    for received in range(messages_in_all(autopilot_type)):
        vehicle = vehicle_with_old(autopilot_type)
        outcome = Channel(keeper_for(vehicle), vehicle, vehicle_dies_after=received).run()
        states.add(outcome.state)
        if outcome.state is SyncState.READY:
            continue  # only the last acknowledgement, of what was read, was lost
        if autopilot_type == "px4":
            assert all(contents(vehicle, kind) in (ReadbackMatch.APPROVED, ReadbackMatch.KNOWN) for kind in MissionType), received
        assert stated_what_is_there(outcome, vehicle, NEW, OLD), (received, outcome)
        vehicle.restart()
        assert Channel(keeper_for(vehicle), vehicle).run().state is SyncState.READY
    assert states == {SyncState.INTACT, SyncState.UNREAD, SyncState.READY}


@pytest.mark.parametrize("number", range(1, 12))
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_item_that_the_vehicle_refuses_leaves_the_old_mission_or_none(autopilot_type: str, number: int):
    vehicle = vehicle_with_old(autopilot_type)
    on_the_wire = number + 1 if autopilot_type == "ardupilot" else number
    vehicle.refuses = {on_the_wire: 3}  # type: ignore[attr-defined]
    keeper = MissionSync(load(12), known(vehicle), ADDRESSING, TransferRules(), known=[OLD])
    outcome = Channel(keeper, vehicle).run()
    assert outcome.code == "unsupported"
    if autopilot_type == "px4":
        assert (outcome.state, contents(vehicle, MissionType.MISSION)) == (SyncState.INTACT, ReadbackMatch.KNOWN)
    else:
        assert (outcome.state, contents(vehicle, MissionType.MISSION)) == (SyncState.CLEARED, ReadbackMatch.NOTHING)
        assert "are new" in str(outcome.mixes[-1].what) or "is new" in str(outcome.mixes[-1].what)
    assert contents(vehicle, MissionType.FENCE) is ReadbackMatch.KNOWN
