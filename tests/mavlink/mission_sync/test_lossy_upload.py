"""200 items over links that lose, double and reorder messages, in simulated time; by the keeper, so each is read back as well."""

import struct
from dataclasses import dataclass

import pytest

from mavlink.mission_sync.compare import differences
from mavlink.mission_sync.outcome import SyncOutcome, SyncState
from mavlink.mission_sync.sync import MissionSync
from mavlink.mission_sync.wire import onboard_list
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import FlightLoad, MissionItem, MissionType
from operation.reasons import english
from tests.cases import long
from tests.telemetry.vehicles.channel import Channel, Link
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES, known, load, polygon, rally
from tests.telemetry.vehicles.vehicle import Vehicle

ITEMS = 200
NEW = load(ITEMS, fence=polygon(0, 5), rally=rally())
OLD = load(50, east=40_000, fence=polygon(9_000))
SEEDS = [*range(8), *long(*range(8, 100))]


@dataclass(frozen=True)
class Run:
    outcome: SyncOutcome
    vehicle: Vehicle
    seconds: float


def with_old(autopilot_type: str) -> Vehicle:
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    for kind in MissionType:
        vehicle.lists[kind] += OLD.of(kind)
    return vehicle


def run(autopilot_type: str, loss: float, seed: int) -> Run:
    vehicle = with_old(autopilot_type)
    keeper = MissionSync(NEW, known(vehicle), ADDRESSING, TransferRules(), known=[OLD])
    channel = Channel(keeper, vehicle, Link(loss, duplicates=0.1, reordered=0.1), seed)
    return Run(channel.run(until_s=7_200.0), vehicle, channel.now_s)


def stored(vehicle: Vehicle, kind: MissionType) -> list[MissionItem]:
    """As the vehicle took it in: home, which ArduPilot puts in itself, is not among it."""
    return vehicle.lists[kind][1 if kind is MissionType.MISSION and "ArduPilot" in type(vehicle).__name__ else 0 :]


def on_the_wire(items: list[MissionItem] | tuple[MissionItem, ...]) -> list[bytes]:
    """Byte by byte as MISSION_ITEM_INT carries them."""
    return [
        struct.pack("<5fiiHB", *item.parameters, item.altitude_m, item.latitude_e7, item.longitude_e7, item.command, item.frame)
        for item in items
    ]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("loss", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_upload_over_a_bad_link_arrives_byte_for_byte_and_is_the_only_one(autopilot_type: str, loss: float, seed: int):
    ran = run(autopilot_type, loss, seed)
    assert (ran.outcome.state, ran.outcome.sha256) == (SyncState.READY, NEW.content_sha256), ran.outcome
    for kind in MissionType:
        assert on_the_wire(stored(ran.vehicle, kind)) == on_the_wire(NEW.of(kind))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_upload_over_half_a_link_arrives_or_fails_and_says_what_is_there(autopilot_type: str, seed: int):
    ran = run(autopilot_type, 0.5, seed)
    assert stated_what_is_there(ran.outcome, ran.vehicle, NEW, OLD), ran.outcome


def stated_what_is_there(outcome: SyncOutcome, vehicle: Vehicle, new: FlightLoad, old: FlightLoad) -> bool:
    """The outcome against the vehicle's memory: never ready with a list that is not whole, never called whole where it is mixed."""
    state = known(vehicle)
    assert state.autopilot_type is not None
    lists = {kind: onboard_list(tuple(vehicle.held(kind)), kind, state.autopilot_type) for kind in MissionType}
    is_new = {kind: not differences(new.of(kind), held, state.autopilot_type) for kind, held in lists.items()}
    is_old = {kind: not differences(old.of(kind), held, state.autopilot_type) for kind, held in lists.items()}
    if outcome.state is SyncState.READY:
        return all(is_new.values()) and outcome.sha256 == new.content_sha256
    assert outcome.sha256 == "" and outcome.code and english(outcome.why)
    if outcome.state is SyncState.INTACT:
        return all(is_old.values())
    if outcome.state is SyncState.CLEARED:
        return not lists[MissionType.MISSION]
    if outcome.state is SyncState.MIXED:
        return outcome.is_critical and bool(outcome.differences)
    is_whole = all(is_new[kind] or is_old[kind] or not lists[kind] for kind in MissionType)
    return is_whole or outcome.is_critical
