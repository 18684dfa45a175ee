"""Our own ground station brings lists over links that lose, double and reorder messages: each is the old one or the new one, and whole."""

from typing import Any

import pytest

from mavlink.mission_sync.outcome import SyncState
from mavlink.mission_sync.sync import MissionSync
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import MissionItem, MissionType
from mavlink.vehicle_state import VehicleState
from simulation.vehicle_protocol.endpoint import Endpoint
from simulation.vehicle_protocol.mission_server import as_kept
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.streams import Station
from tests.simulation.kinematic_uav import KinematicUav
from tests.simulation.vehicle_protocol.talk import SYSTEM, UNIX_S, over_the_wire
from tests.telemetry.vehicles.channel import Channel, Link
from tests.telemetry.vehicles.loads import ADDRESSING, load, polygon, rally

NEW = load(60, fence=polygon(0, 5), rally=rally())
OLD = load(20, east=40_000, fence=polygon(9_000))
SEEDS = [*range(5), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(5, 60))]


class OnChannel:
    """An endpoint as the channel of the ground station's tests drives a vehicle."""

    def __init__(self, autopilot_type: SimulatedAutopilot) -> None:
        self.system, self.is_alive = SYSTEM, True
        self.endpoint = Endpoint(KinematicUav(), autopilot_type=autopilot_type, system=SYSTEM, unix_at_zero_s=UNIX_S)
        for kind in MissionType:
            items = tuple(as_kept(item, kind, autopilot_type) for item in OLD.of(kind))
            assert self.endpoint.missions.put(kind, items) == 0
        self.wake_at_s: float | None = 0.0

    def start(self, now_s: float) -> list[Any]:
        return self.tick(now_s)

    def receive(self, message: Any, now_s: float) -> list[Any]:
        if not self.is_alive:
            return []
        station = Station(message.get_srcSystem(), message.get_srcComponent())
        return [one.message for one in self.endpoint.receive(message, station, now_s)]

    def tick(self, now_s: float) -> list[Any]:
        self.wake_at_s = now_s + 0.05
        return [one.message for one in self.endpoint.tick(now_s)] if self.is_alive else []

    def _plan_wake(self) -> None:
        pass

    def held(self, kind: MissionType) -> str:
        return figures(self.endpoint.missions.held[kind])


def figures(items: tuple[MissionItem, ...]) -> str:
    """As 32-bit floats carry them."""
    return repr(
        [(one.command, [f"{value:.6g}" for value in (*one.parameters, one.altitude_m)], one.longitude_e7, one.latitude_e7) for one in items]
    )


def reported(vehicle: OnChannel) -> VehicleState:
    state = VehicleState(SYSTEM)
    for message in vehicle.tick(0.0):
        state.receive(over_the_wire(message, SYSTEM, 1), 0.0)
    return state


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("loss", [0.0, 0.3])
@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_a_load_arrives_over_a_bad_link_and_is_read_back(autopilot_type, loss, seed):
    vehicle = OnChannel(autopilot_type)
    keeper = MissionSync(NEW, reported(vehicle), ADDRESSING, TransferRules(), known=[OLD])
    outcome = Channel(keeper, vehicle, Link(loss, duplicates=0.1, reordered=0.1), seed).run(until_s=7_200.0)
    assert (outcome.state, outcome.sha256, outcome.mixes) == (SyncState.READY, NEW.content_sha256, ()), outcome
    for kind in MissionType:
        assert vehicle.held(kind) == figures(tuple(as_kept(item, kind, autopilot_type) for item in NEW.of(kind)))


@pytest.mark.parametrize("dies_after", range(1, 150, 11))
@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_a_station_that_dies_leaves_each_list_old_or_new(autopilot_type, dies_after):
    vehicle = OnChannel(autopilot_type)
    keeper = MissionSync(NEW, reported(vehicle), ADDRESSING, TransferRules(), known=[OLD])
    channel = Channel(keeper, vehicle, Link(0.1), seed=dies_after, ground_dies_after=dies_after)
    channel.run(until_s=7_200.0)
    channel.let_pass(30.0)
    for kind in MissionType:
        assert vehicle.held(kind) in [
            figures(tuple(as_kept(item, kind, autopilot_type) for item in one.of(kind))) for one in (OLD, NEW)
        ] + ["[]"]
    assert not vehicle.endpoint.missions.is_uploading
