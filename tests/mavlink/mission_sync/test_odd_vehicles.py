"""Vehicles that are broken in some way: the ground station always comes to an end, and what it says is so."""

import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.commands.actions import Order
from mavlink.commands.driver import CommandDriver
from mavlink.mission_sync.outcome import SyncState
from mavlink.mission_sync.sync import MissionSync
from mavlink.timeouts import CommandRules, TransferRules
from mavlink.vehicle_plan import MissionType
from tests.mavlink.mission_sync.test_lossy_upload import stated_what_is_there
from tests.telemetry.vehicles.channel import Channel, Link
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES, known, load, polygon
from tests.telemetry.vehicles.vehicle import GROUND, Vehicle

NEW = load(12, fence=polygon(0, 5))
OLD = load(9, east=40_000, fence=polygon(9_000))
RESULTS = [*range(1, 16), 77, 255]


@settings(max_examples=150, deadline=None)
@given(
    autopilot_type=st.sampled_from(sorted(AUTOPILOT_TYPES)),
    refuses=st.dictionaries(st.integers(1, 13), st.sampled_from(RESULTS), max_size=2),
    dies_after=st.none() | st.integers(1, 150),
    loss=st.sampled_from([0.0, 0.2, 0.5, 0.8]),
    seed=st.integers(0, 1_000),
)
def test_whatever_goes_wrong_the_outcome_says_what_is_on_the_vehicle(
    autopilot_type: str, refuses: dict[int, int], dies_after: int | None, loss: float, seed: int
):
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    for kind in MissionType:
        vehicle.lists[kind] += OLD.of(kind)
    vehicle.refuses = refuses  # type: ignore[attr-defined]
    keeper = MissionSync(NEW, known(vehicle), ADDRESSING, TransferRules(), known=[OLD])
    link = Link(loss, duplicates=0.1, reordered=0.1)
    outcome = Channel(keeper, vehicle, link, seed, vehicle_dies_after=dies_after).run(until_s=7_200.0)
    assert stated_what_is_there(outcome, vehicle, NEW, OLD), outcome


class Babbling(Vehicle):
    """Answers everything by anything, in the right form."""

    autopilot = mavlink.MAV_AUTOPILOT_PX4

    def __init__(self, seed: int) -> None:
        super().__init__()
        self.random = random.Random(seed)

    def receive(self, message: Any, now_s: float) -> list[Any]:
        return [self._anything() for _ in range(self.random.choice([0, 1, 1, 1, 2, 3]))]

    def _anything(self) -> Any:
        number = self.random.choice([0, 1, 2, 3, 11, 12, 13, 65_535])
        kind = self.random.choice([0, 0, 0, 1, 2, 7, 255])
        result = self.random.choice([0, 0, 0, 1, 5, 13, 14, 15, 200])
        nan = float("nan")
        return self.random.choice([
            mavlink.MAVLink_mission_request_int_message(*GROUND, number, kind),
            mavlink.MAVLink_mission_request_message(*GROUND, number, kind),
            mavlink.MAVLink_mission_count_message(*GROUND, number, kind),
            mavlink.MAVLink_mission_ack_message(*GROUND, result, kind),
            mavlink.MAVLink_mission_item_int_message(*GROUND, number, 6, 16, 0, 1, nan, 0, 0, nan, 1, 2, nan, kind),
            mavlink.MAVLink_command_ack_message(self.random.choice([176, 400]), result, 0, 0, *GROUND),
            mavlink.MAVLink_heartbeat_message(2, self.random.choice([3, 12, 0]), 129, number, 4, 3),
            mavlink.MAVLink_statustext_message(3, b"\xff\xfe"),
        ])  # fmt: skip


@pytest.mark.parametrize("seed", range(30))
def test_babbling_vehicle_is_never_ready_and_does_not_hold_the_ground_station_up(seed: int):
    vehicle = Babbling(seed)
    keeper = MissionSync(NEW, known(vehicle), ADDRESSING, TransferRules(), known=[OLD])
    channel = Channel(keeper, vehicle, seed=seed)
    outcome = channel.run(until_s=7_200.0)
    assert outcome.state is not SyncState.READY
    assert len(channel.to_vehicle) < 50_000


@pytest.mark.parametrize("seed", range(30))
def test_order_to_a_babbling_vehicle_comes_to_an_end(seed: int):
    vehicle = Babbling(seed)
    state = known(vehicle)
    channel = Channel(CommandDriver(Order.START, state, ADDRESSING, CommandRules()), vehicle, seed=seed, listeners=[state])
    assert channel.run(until_s=600.0) is not None
