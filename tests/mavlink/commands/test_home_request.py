"""A vehicle is asked where its home is now: what it told before does not count."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing
from mavlink.commands.message_requests import HomeReading
from mavlink.timeouts import TransferRules
from mavlink.vehicle_state import VehicleState

NEWER, OLDER = mavlink.MAV_CMD_REQUEST_MESSAGE, mavlink.MAV_CMD_GET_HOME_POSITION


def home(state: VehicleState, now_s: float) -> mavlink.MAVLink_message:
    packer = mavlink.MAVLink(None, srcSystem=7, srcComponent=1)
    reported = mavlink.MAVLink_home_position_message(560_000_000, 100_000_000, 100_000, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0)
    message = mavlink.MAVLink(None).parse_char(reported.pack(packer))
    state.receive(message, now_s)
    return message


@pytest.mark.parametrize("answers", [NEWER, OLDER])
def test_a_home_is_asked_for_by_either_command(answers):
    state = VehicleState(7)
    home(state, 1.0)
    reading = HomeReading(state, Addressing(7), TransferRules())
    (asked,), now_s = reading.start(10.0), 10.0
    while asked.command != answers:
        assert reading.outcome is None, "the home that was told before is no answer"
        now_s = reading.wake_at_s
        (asked,) = reading.tick(now_s)
    reading.receive(home(state, now_s + 0.1), now_s + 0.1)
    assert reading.outcome is True and state.home_at_s == now_s + 0.1


def test_a_vehicle_that_says_nothing_is_given_up():
    rules = TransferRules()
    reading, asked = HomeReading(VehicleState(7), Addressing(7), rules), 1
    reading.start(0.0)
    while reading.wake_at_s is not None:
        asked += len(reading.tick(reading.wake_at_s))
    assert reading.outcome is False and asked == rules.retries + 1
