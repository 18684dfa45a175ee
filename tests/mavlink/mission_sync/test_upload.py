"""Single messages, in the order in which a bad link or an odd vehicle may bring them."""

from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.mission_sync.upload import ListUpload, TransferState
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import MissionType
from tests.telemetry.vehicles.loads import ADDRESSING, mission
from tests.telemetry.vehicles.vehicle import GROUND

MISSION, FENCE = int(MissionType.MISSION), int(MissionType.FENCE)
ITEMS = mission(5)
RULES = TransferRules()


def received(message: Any, system: int = 7, component: int = 1) -> Any:
    """As it comes from the vehicle."""
    frames = mavlink.MAVLink(None, srcSystem=system, srcComponent=component)
    return mavlink.MAVLink(None).parse_char(message.pack(frames))


def request(number: int, kind: int = MISSION, **source: int) -> Any:
    return received(mavlink.MAVLink_mission_request_int_message(*GROUND, number, kind), **source)


def ack(result: int, kind: int = MISSION, to: tuple[int, int] = GROUND) -> Any:
    return received(mavlink.MAVLink_mission_ack_message(*to, result, kind))


def begun(items: tuple[Any, ...] = ITEMS) -> ListUpload:
    upload = ListUpload(items, MissionType.MISSION, ADDRESSING, RULES)
    (count,) = upload.start(0.0)
    assert (count.get_type(), count.count, count.mission_type) == ("MISSION_COUNT", len(items), MISSION)
    return upload


def sent_to(upload: ListUpload, last: int) -> ListUpload:
    """Asked for items up to this one."""
    for number in range(last + 1):
        upload.receive(request(number), 0.1)
    return upload


def numbers(messages: list[Any]) -> list[int]:
    return [message.seq for message in messages]


def test_all_items_and_a_yes_is_done():
    upload = sent_to(begun(), 4)
    upload.receive(ack(mavlink.MAV_MISSION_ACCEPTED), 0.2)
    assert upload.outcome is not None
    assert (upload.outcome.state, upload.items_done, upload.wake_at_s) == (TransferState.DONE, 5, None)


def test_old_float_request_is_answered_by_an_int_item():
    asked = received(mavlink.MAVLink_mission_request_message(*GROUND, 2, MISSION))
    (item,) = begun().receive(asked, 0.1)
    assert (item.get_type(), item.seq, item.x, item.y) == ("MISSION_ITEM_INT", 2, ITEMS[2].latitude_e7, ITEMS[2].longitude_e7)


def test_repeated_request_gets_the_same_item():
    upload = sent_to(begun(), 2)
    first, again = upload.receive(request(2), 0.2), upload.receive(request(2), 0.3)
    assert first[0].to_dict() == again[0].to_dict()


@pytest.mark.parametrize(
    "message",
    [
        ack(mavlink.MAV_MISSION_ACCEPTED, FENCE),
        ack(mavlink.MAV_MISSION_ACCEPTED, to=(254, 190)),
        ack(mavlink.MAV_MISSION_UNSUPPORTED, FENCE),
        received(mavlink.MAVLink_mission_ack_message(*GROUND, mavlink.MAV_MISSION_ACCEPTED, MISSION), system=8),
        received(mavlink.MAVLink_mission_ack_message(*GROUND, mavlink.MAV_MISSION_ACCEPTED, MISSION), component=100),
        request(3, FENCE),
        request(3, system=8),
        request(17),
    ],
)
def test_messages_of_others_and_of_other_lists_change_nothing(message: Any):
    upload = sent_to(begun(), 4)
    assert upload.receive(message, 0.2) == []
    upload.tick(0.2)
    assert upload.outcome is None
    assert numbers(upload.tick(0.5)) == [4]


def test_yes_of_an_earlier_transfer_is_not_believed():
    upload = sent_to(begun(), 2)
    upload.receive(ack(mavlink.MAV_MISSION_ACCEPTED), 0.2)
    assert upload.outcome is None
    assert numbers(upload.receive(request(3), 0.3)) == [3]


def test_vehicle_that_finished_a_shorter_announcement_is_told_the_length_again():
    upload = sent_to(begun(), 2)
    upload.receive(ack(mavlink.MAV_MISSION_ACCEPTED), 0.2)
    assert [message.get_type() for message in upload.tick(0.2 + RULES.timeout_s)] == ["MISSION_COUNT"]


def test_no_of_an_earlier_transfer_is_not_believed_where_the_vehicle_asks_on():
    upload = sent_to(begun(), 2)
    upload.receive(ack(mavlink.MAV_MISSION_UNSUPPORTED), 0.2)
    upload.receive(request(3), 0.9)
    upload.tick(5.0)
    assert upload.outcome is None


def test_definite_no_ends_it_when_nothing_follows():
    upload = sent_to(begun(), 2)
    upload.receive(ack(mavlink.MAV_MISSION_INVALID_PARAM7), 0.2)
    assert upload.tick(0.5) == []
    upload.tick(0.2 + RULES.timeout_s)
    assert upload.outcome is not None
    assert (upload.outcome.state, upload.outcome.code, upload.outcome.item) == (TransferState.REFUSED, "invalid-param7", 2)


def test_invalid_sequence_is_not_the_end_and_the_next_item_is_offered():
    upload = sent_to(begun(), 2)
    assert upload.receive(ack(mavlink.MAV_MISSION_INVALID_SEQUENCE), 0.2) == []
    assert numbers(upload.tick(0.4)) == [2, 3]
    assert upload.outcome is None


def test_error_after_the_last_item_leaves_it_unsure():
    """ArduPilot says so to a last item that comes again after its yes was lost."""
    upload = sent_to(begun(), 4)
    upload.receive(ack(mavlink.MAV_MISSION_ERROR), 0.3)
    upload.tick(0.3 + RULES.timeout_s)
    assert upload.outcome is not None
    assert upload.outcome.state is TransferState.UNSURE


def test_error_in_the_middle_begins_anew_when_nothing_follows():
    upload = sent_to(begun(), 2)
    upload.receive(ack(mavlink.MAV_MISSION_ERROR), 0.3)
    assert [message.get_type() for message in upload.tick(0.3 + RULES.timeout_s)] == ["MISSION_COUNT"]
    assert numbers(upload.receive(request(0), 2.0)) == [0]


def test_busy_vehicle_is_asked_as_often_as_there_are_retries():
    upload = begun()
    now_s, announced = 0.0, 1
    while upload.outcome is None:
        upload.receive(ack(mavlink.MAV_MISSION_DENIED), now_s)
        now_s += RULES.timeout_s
        announced += len(upload.tick(now_s))
    assert (upload.outcome.state, upload.outcome.code, announced) == (TransferState.REFUSED, "denied", 1 + RULES.retries)


def test_silent_vehicle_is_announced_to_every_timeout():
    upload = begun()
    times = []
    while upload.wake_at_s is not None:
        now_s = upload.wake_at_s
        times += [now_s] * len(upload.tick(now_s))
    assert times == [1.5, 3.0, 4.5, 6.0, 7.5]
    assert upload.outcome is not None
    assert upload.outcome.state is TransferState.SILENT


def test_item_is_repeated_every_item_timeout_until_the_silence_is_too_long():
    upload = sent_to(begun(), 2)
    count = 0
    while upload.wake_at_s is not None:
        now_s = upload.wake_at_s
        count += len(upload.tick(now_s))
    assert count == pytest.approx(RULES.silence_s / RULES.item_timeout_s, abs=1)
    assert upload.outcome is not None
    assert (upload.outcome.state, upload.outcome.item) == (TransferState.SILENT, 2)


def test_vehicle_that_asks_for_ever_is_given_up():
    upload = begun()
    now_s = 0.0
    while upload.outcome is None and now_s < 1_000:
        now_s += 0.2
        upload.receive(request(int(now_s * 5) % 2), now_s)
        upload.tick(now_s)
    assert upload.outcome is not None
    assert now_s == pytest.approx(RULES.longest_s(len(ITEMS)), abs=0.5)


def test_items_are_still_answered_after_the_end():
    """A doubled announcement makes a vehicle ask again, after all was done."""
    upload = sent_to(begun(), 4)
    upload.receive(ack(mavlink.MAV_MISSION_ACCEPTED), 0.2)
    assert numbers(upload.receive(request(0), 0.3)) == [0]
    assert upload.outcome is not None
    assert upload.outcome.state is TransferState.DONE


def test_cancelling_tells_the_vehicle():
    upload = sent_to(begun(), 2)
    (stated,) = upload.cancel(0.3)
    assert (stated.get_type(), stated.type, stated.mission_type) == ("MISSION_ACK", mavlink.MAV_MISSION_OPERATION_CANCELLED, MISSION)
    assert upload.outcome is not None
    assert upload.outcome.state is TransferState.CANCELLED
    assert upload.cancel(0.4) == []


def test_empty_list_is_an_announcement_of_nothing():
    upload = begun(())
    upload.receive(ack(mavlink.MAV_MISSION_ACCEPTED), 0.1)
    assert upload.outcome is not None
    assert upload.outcome.state is TransferState.DONE
