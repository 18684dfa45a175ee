"""Bringing a flight's load onto a vehicle, and what is done after a failure."""

from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import PX4_AUTO, AutopilotType
from mavlink.mission_sync.compare import ReadbackMatch, differences
from mavlink.mission_sync.outcome import SyncOutcome, SyncState
from mavlink.mission_sync.sync import MissionSync
from mavlink.mission_sync.wire import onboard_list
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import FlightLoad, MissionItem, MissionType
from mavlink.vehicle_state import VehicleState
from operation.reasons import english
from tests.telemetry.vehicles.ardupilot import AUTO, BRAKE, ArduPilot
from tests.telemetry.vehicles.channel import Channel, Link
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES, known, load, mission, polygon, rally
from tests.telemetry.vehicles.px4 import HOLD, MISSION, Px4
from tests.telemetry.vehicles.vehicle import Vehicle

OLD = load(9, east=40_000, fence=polygon(9_000))
NEW = load(12, fence=polygon(0, 5), rally=rally())
WRITES = {"MISSION_COUNT", "MISSION_ITEM_INT", "MISSION_CLEAR_ALL"}


def holding(autopilot_type: str, load: FlightLoad) -> Vehicle:
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    for kind in MissionType:
        vehicle.lists[kind] += load.of(kind)
    return vehicle


def keeper_for(vehicle: Vehicle, new: FlightLoad = NEW, *, known_loads: tuple[FlightLoad, ...] = (OLD,)) -> MissionSync:
    return MissionSync(new, known(vehicle), ADDRESSING, TransferRules(), known=known_loads)


def bring(vehicle: Vehicle, new: FlightLoad = NEW) -> tuple[SyncOutcome, Channel]:
    channel = Channel(keeper_for(vehicle, new), vehicle)
    return channel.run(), channel


def sent(channel: Channel) -> list[str]:
    return [message.get_type() for message in channel.to_vehicle]


def holds(vehicle: Vehicle, wanted: FlightLoad) -> bool:
    autopilot_type = AutopilotType(type(vehicle).__name__.lower())
    return not any(
        differences(wanted.of(kind), onboard_list(tuple(vehicle.held(kind)), kind, autopilot_type), autopilot_type) for kind in MissionType
    )


def holds_no_mission(vehicle: Vehicle) -> bool:
    return len(vehicle.lists[MissionType.MISSION]) == (1 if isinstance(vehicle, ArduPilot) else 0)


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_vehicle_is_ready_by_the_hash_of_what_it_holds(autopilot_type: str):
    vehicle = holding(autopilot_type, OLD)
    outcome, _ = bring(vehicle)
    assert (outcome.state, outcome.sha256) == (SyncState.READY, NEW.content_sha256)
    assert holds(vehicle, NEW)


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_fence_is_sent_before_the_mission_and_rally_points_last(autopilot_type: str):
    _, channel = bring(holding(autopilot_type, OLD))
    order = [message.mission_type for message in channel.to_vehicle if message.get_type() == "MISSION_COUNT"]
    assert order == [MissionType.FENCE, MissionType.MISSION, MissionType.RALLY]


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_nothing_is_sent_to_a_vehicle_that_holds_it_already(autopilot_type: str):
    outcome, channel = bring(holding(autopilot_type, NEW))
    assert outcome.state is SyncState.READY
    assert not WRITES & set(sent(channel))


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_empty_load_takes_everything_off(autopilot_type: str):
    vehicle = holding(autopilot_type, OLD)
    outcome, _ = bring(vehicle, FlightLoad(()))
    assert outcome.state is SyncState.READY
    assert holds(vehicle, FlightLoad(()))


def test_vehicle_without_fence_gets_a_mission_without_one():
    vehicle = ArduPilot(has_fence=False)
    outcome, channel = bring(vehicle, load(12))
    assert outcome.state is SyncState.READY
    assert {message.mission_type for message in channel.to_vehicle if message.get_type() in WRITES} == {MissionType.MISSION}


def test_vehicle_without_fence_is_not_ready_for_a_mission_with_one():
    vehicle = ArduPilot(has_fence=False)
    outcome, channel = bring(vehicle, load(12, fence=polygon(0)))
    assert (outcome.state, outcome.code) == (SyncState.INTACT, "unsupported")
    assert MissionType.MISSION not in {message.mission_type for message in channel.to_vehicle if message.get_type() in WRITES}


def test_other_autopilot_is_refused():
    state = VehicleState(7)
    state.autopilot_type = AutopilotType.OTHER
    keeper = MissionSync(NEW, state, ADDRESSING, TransferRules())
    assert keeper.start(0.0) == []
    assert keeper.outcome is not None
    assert (keeper.outcome.state, keeper.outcome.code) == (SyncState.INTACT, "autopilot")


def test_vehicle_that_has_not_spoken_is_refused():
    keeper = MissionSync(NEW, VehicleState(7), ADDRESSING, TransferRules())
    keeper.start(0.0)
    assert keeper.outcome is not None
    assert keeper.outcome.code == "not-heard"


@pytest.mark.parametrize(("autopilot_type", "mode"), [("ardupilot", AUTO), ("px4", MISSION << 24 | 4 << 16)])
def test_nothing_is_sent_to_a_vehicle_in_its_mission(autopilot_type: str, mode: int):
    vehicle = holding(autopilot_type, OLD)
    vehicle.is_armed, vehicle.is_in_air, vehicle.custom_mode = True, True, mode
    outcome, channel = bring(vehicle)
    assert (outcome.code, channel.to_vehicle) == ("not-held", [])


@pytest.mark.parametrize(("autopilot_type", "mode"), [("ardupilot", BRAKE), ("px4", HOLD << 24 | 4 << 16)])
def test_held_vehicle_in_the_air_gets_its_mission(autopilot_type: str, mode: int):
    vehicle = holding(autopilot_type, OLD)
    vehicle.is_armed, vehicle.is_in_air, vehicle.custom_mode = True, True, mode
    assert bring(vehicle)[0].state is SyncState.READY


def test_list_that_is_too_long_is_not_begun():
    vehicle = holding("ardupilot", OLD)
    outcome, channel = bring(vehicle, load(650))
    assert (outcome.code, channel.to_vehicle) == ("too-many-items", [])


def test_count_that_the_vehicle_refuses_leaves_the_old_mission():
    vehicle = holding("px4", OLD)
    outcome, _ = bring(vehicle, load(12, fence=polygon(0, 70)))
    assert (outcome.state, outcome.code) == (SyncState.INTACT, "no-space")
    assert holds(vehicle, OLD)


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_silent_vehicle_is_not_blamed_for_a_mix(autopilot_type: str):
    vehicle = holding(autopilot_type, OLD)
    vehicle.is_alive = False
    state = known(vehicle)
    outcome = Channel(MissionSync(NEW, state, ADDRESSING, TransferRules()), vehicle).run()
    assert (outcome.state, outcome.code, outcome.is_critical) == (SyncState.INTACT, "silent", False)


def test_mix_that_cannot_be_taken_off_is_critical_and_named_by_items():
    """ArduPilot refuses item 4, and then, switched to AUTO by its pilot, to clear the list."""
    vehicle = holding("ardupilot", OLD)
    assert isinstance(vehicle, ArduPilot)
    vehicle.refuses = {4: mavlink.MAV_MISSION_INVALID_PARAM7}
    keeper = keeper_for(vehicle, load(12))
    vehicle.is_armed, vehicle.is_in_air, vehicle.custom_mode = True, True, AUTO
    outcome = Channel(keeper, vehicle).run()
    assert (outcome.state, outcome.code, outcome.is_critical, outcome.sha256) == (SyncState.MIXED, "invalid-param7", True, "")
    assert "0-2 are new" in english(outcome.why) and "3-8 are of the list before" in english(outcome.why)
    assert outcome.differences[0].item == 3
    assert [mix.kind for mix in outcome.mixes] == [MissionType.MISSION]


def test_mix_is_told_while_it_is_being_put_right():
    vehicle = holding("ardupilot", OLD)
    assert isinstance(vehicle, ArduPilot)
    vehicle.refuses = {4: mavlink.MAV_MISSION_UNSUPPORTED}
    keeper = keeper_for(vehicle, load(12))
    channel = Channel(keeper, vehicle)
    reported = []

    class Watch:
        def receive(self, message: object, now_s: float) -> None:
            reported.append(bool(keeper.mixes) and keeper.outcome is None and "MISSION_CLEAR_ALL" in sent(channel))

    channel.listeners.append(Watch())
    assert channel.run().state is SyncState.CLEARED
    assert any(reported)


def test_list_that_nobody_approved_is_seen_from_the_beginning():
    vehicle = holding("ardupilot", load(9, east=99_999))
    keeper = keeper_for(vehicle)
    Channel(keeper, vehicle).run()
    assert keeper.found_before[MissionType.MISSION] is ReadbackMatch.FOREIGN


def test_mix_of_an_earlier_ground_station_is_named_from_the_beginning():
    vehicle = holding("ardupilot", OLD)
    vehicle.lists[MissionType.MISSION][1:5] = NEW.mission[:4]
    keeper = keeper_for(vehicle)
    outcome = Channel(keeper, vehicle).run()
    assert keeper.found_before[MissionType.MISSION] is ReadbackMatch.MIXED
    assert (outcome.state, len(outcome.mixes)) == (SyncState.READY, 1)


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_cancelling_at_any_message_leaves_the_old_mission_or_none(autopilot_type: str):
    vehicle = holding(autopilot_type, OLD)
    whole = Channel(keeper_for(vehicle), vehicle)
    whole.run()
    for number in range(len(whole.to_vehicle)):
        vehicle = holding(autopilot_type, OLD)
        keeper = keeper_for(vehicle)
        channel = Channel(keeper, vehicle, ground_dies_after=number)
        channel.run()
        channel.ground_dies_after = None
        channel.send(keeper.cancel(channel.now_s))
        outcome = channel.go_on()
        if outcome.state is SyncState.READY:
            assert holds(vehicle, NEW)
            continue
        assert outcome.code == "cancelled"
        assert outcome.state in (SyncState.INTACT, SyncState.CLEARED)
        assert holds(vehicle, OLD) if outcome.state is SyncState.INTACT else holds_no_mission(vehicle)


def test_cancelled_upload_gets_no_more_items_though_the_vehicle_asks_for_them():
    """ArduPilot knows no cancelling, and asks on for 8 s."""
    vehicle = holding("ardupilot", OLD)
    keeper = keeper_for(vehicle, load(12, fence=OLD.fence))
    channel = Channel(keeper, vehicle, ground_dies_after=26)
    channel.run()
    assert keeper.progress.stage == "sending"
    channel.ground_dies_after = None
    items = sent(channel).count("MISSION_ITEM_INT")
    channel.send(keeper.cancel(channel.now_s))
    assert channel.go_on().state is SyncState.CLEARED
    assert sent(channel).count("MISSION_ITEM_INT") == items > 0


@pytest.mark.parametrize(("autopilot_type", "mode"), [("px4", PX4_AUTO << 16 | MISSION << 24), ("ardupilot", AUTO)])
@pytest.mark.parametrize("is_sending", [False, True])
def test_a_vehicle_that_begins_to_fly_its_list_gets_none_or_a_whole_one(autopilot_type: str, mode: int, is_sending: bool):
    vehicle = holding(autopilot_type, OLD)
    state = known(vehicle)
    keeper = MissionSync(load(12, fence=OLD.fence), state, ADDRESSING, TransferRules(), known=[OLD])
    channel = Channel(keeper, vehicle, ground_dies_after=26 if is_sending else 4)
    channel.run()
    assert (keeper.progress.stage == "sending") == is_sending and not keeper.is_endangered
    state.is_armed, state.custom_mode = True, mode
    vehicle.is_armed, vehicle.custom_mode = True, mode
    assert keeper.is_endangered != (is_sending and autopilot_type == "ardupilot")
    channel.ground_dies_after = None
    if keeper.is_endangered:
        channel.send(keeper.cancel(channel.now_s))
        outcome = channel.go_on()
        assert (outcome.state, outcome.code) == (SyncState.INTACT, "left-hold") and holds(vehicle, OLD)
    else:
        assert channel.go_on().state is SyncState.READY


def test_cancelling_after_the_end_changes_nothing():
    vehicle = holding("px4", OLD)
    keeper = keeper_for(vehicle)
    outcome = Channel(keeper, vehicle).run()
    assert keeper.cancel(100.0) == []
    assert keeper.outcome is outcome


def test_progress_counts_the_items_that_the_vehicle_has():
    vehicle = holding("px4", OLD)
    keeper = keeper_for(vehicle)
    seen = []

    class Watch:
        def receive(self, message: object, now_s: float) -> None:
            progress = keeper.progress
            if progress.kind is MissionType.MISSION and progress.stage == "sending":
                seen.append(progress.done)
                assert progress.total == 12

    Channel(keeper, vehicle, listeners=[Watch()]).run()
    assert seen == sorted(seen)
    assert set(seen) == set(range(12))


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_reading_back_that_shows_something_else_twice_is_sent_again(autopilot_type: str):
    """A memory that loses a bit once."""
    vehicle = holding(autopilot_type, OLD)
    keeper = keeper_for(vehicle)

    class Fault:
        is_done = False

        def receive(self, message: object, now_s: float) -> None:
            if keeper.progress.stage == "reading" and len(vehicle.lists[MissionType.MISSION]) > 11 and not self.is_done:
                self.is_done = True
                del vehicle.lists[MissionType.MISSION][5]

    outcome = Channel(keeper, vehicle, listeners=[Fault()]).run()
    assert outcome.state is SyncState.READY
    assert len(outcome.mixes) == 1
    assert holds(vehicle, NEW)


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_two_ground_stations_after_one_another_do_not_confuse_each_other(autopilot_type: str):
    """The second begins while messages of the first are still under way, both ways."""
    for cut in range(5, 60, 5):
        vehicle = holding(autopilot_type, OLD)
        first = Channel(
            keeper_for(vehicle, load(30, east=77)), vehicle, Link(duplicates=0.3, reordered=0.3), seed=cut, ground_dies_after=cut
        )
        first.run()
        first.ground, first.ground_dies_after = keeper_for(vehicle), None
        assert first.run().state is SyncState.READY
        assert holds(vehicle, NEW)


class Forgetful(Px4):
    """A memory in which one item is always a metre too low, or only the next time it is read."""

    for_ever = True
    reads_wrong = 0

    def _as_read(self, item: MissionItem, number: int, kind: MissionType) -> Any:
        message = super()._as_read(item, number, kind)
        if kind is MissionType.MISSION and number == 3 and len(self.lists[kind]) == 12 and (self.for_ever or not self.reads_wrong):
            self.reads_wrong += 1
            message.z -= 1.0
        return message


def test_vehicle_that_keeps_something_else_is_not_ready_and_loses_the_mission():
    vehicle = Forgetful()
    vehicle.lists[MissionType.MISSION] += OLD.mission
    outcome, channel = bring(vehicle)
    assert (outcome.state, outcome.code, outcome.sha256) == (SyncState.CLEARED, "differs", "")
    assert str(outcome.mixes[0].what) == "12 items where 12 are approved: 0-2 are new, 3 is of neither list, 4-11 are new"
    assert [message.mission_type for message in channel.to_vehicle if message.get_type() == "MISSION_COUNT"].count(MissionType.MISSION) == 3
    assert vehicle.lists[MissionType.MISSION] == []


def test_one_wrong_reading_is_read_again_before_anything_is_said():
    vehicle = Forgetful()
    vehicle.for_ever = False
    outcome, channel = bring(vehicle)
    assert (outcome.state, outcome.mixes, vehicle.reads_wrong) == (SyncState.READY, (), 1)
    assert [message.mission_type for message in channel.to_vehicle if message.get_type() == "MISSION_COUNT"].count(MissionType.MISSION) == 1


def test_announcement_that_comes_twice_is_served_again_and_does_not_hold_up_the_reading():
    """ArduPilot begins to receive anew, and would deny to be read for 8 s."""
    vehicle = holding("ardupilot", OLD)
    keeper = keeper_for(vehicle, load(12, fence=OLD.fence))
    channel = Channel(keeper, vehicle)

    class Doubled:
        is_done = False

        def receive(self, message: Any, now_s: float) -> None:
            if message.get_type() == "MISSION_ACK" and message.type == mavlink.MAV_MISSION_ACCEPTED and not self.is_done:
                self.is_done = True
                channel.send([count for count in channel.to_vehicle if count.get_type() == "MISSION_COUNT"][-1:])

    channel.listeners.append(Doubled())
    assert channel.run().state is SyncState.READY
    assert holds(vehicle, load(12, fence=OLD.fence))
    assert [count.get_type() for count in channel.to_vehicle].count("MISSION_COUNT") == 2
    assert channel.now_s < 6.0


def test_mission_that_is_there_though_the_link_was_away_while_it_was_read_is_kept():
    vehicle = holding("px4", OLD)
    keeper = keeper_for(vehicle, load(12, fence=OLD.fence))
    channel = Channel(keeper, vehicle)

    class Outage:
        """From the vehicle's yes on it hears nothing, until the ground station has tried all that it does."""

        begun_s = 0.0

        def receive(self, message: Any, now_s: float) -> None:
            if message.get_type() == "MISSION_ACK" and message.mission_type == MissionType.MISSION and not self.begun_s:
                self.begun_s, vehicle.is_alive = now_s, False

    outage = Outage()
    channel.listeners.append(outage)
    with pytest.raises(AssertionError, match="nothing more happens"):
        channel.run(until_s=115.0)
    vehicle.restart()
    assert channel.go_on().state is SyncState.READY
    assert holds(vehicle, load(12, fence=OLD.fence))


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_fence_and_rally_points_of_somebody_else_are_left(autopilot_type):
    vehicle = holding(autopilot_type, FlightLoad(mission(5), fence=polygon(50_000), rally=rally()))
    outcome, _ = bring(vehicle, load(12))
    assert outcome.state is SyncState.READY and outcome.mixes == ()
    assert (len(vehicle.lists[MissionType.FENCE]), len(vehicle.lists[MissionType.RALLY])) == (4, 2)
    left = english(outcome.left_alone)
    assert "own fence 4 items" in left and "own rally points 2 items" in left


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
@pytest.mark.parametrize("wanted", [load(12), FlightLoad(())])
def test_a_fence_and_rally_points_of_an_earlier_mission_are_taken_off(autopilot_type, wanted):
    earlier = FlightLoad(mission(5), fence=polygon(9_000), rally=rally())
    vehicle = holding(autopilot_type, earlier)
    outcome = Channel(keeper_for(vehicle, wanted, known_loads=(earlier,)), vehicle).run()
    assert outcome.state is SyncState.READY and not outcome.left_alone
    assert not vehicle.lists[MissionType.FENCE] and not vehicle.lists[MissionType.RALLY]
