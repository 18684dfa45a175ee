"""Parameters that are read from a vehicle."""

import struct
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.commands.command import CommandEnd
from mavlink.parameters import ParameterReading, ParameterSetting
from mavlink.timeouts import TransferRules
from operation.reasons import english
from tests.telemetry.vehicles.channel import Channel, Link
from tests.telemetry.vehicles.loads import ADDRESSING, known
from tests.telemetry.vehicles.px4 import Px4

RULES = TransferRules()


class WithParameters(Px4):
    """Knows one real and one whole one; of others it says nothing."""

    def _param_request_read(self, message: Any, now_s: float) -> list[Any]:
        bits = struct.unpack("<f", struct.pack("<i", 3))[0]
        values = {"MIS_DIST_WPS": (900.0, 9), "NAV_DLL_ACT": (bits, 6)}
        if message.param_id not in values:
            return []
        return [mavlink.MAVLink_param_value_message(message.param_id.encode(), *values[message.param_id], 2, 0)]


@pytest.mark.parametrize("seed", range(10))
def test_parameters_are_read_over_a_bad_link_and_whole_ones_are_whole(seed: int):
    vehicle = WithParameters()
    state = known(vehicle)
    reading = ParameterReading(["MIS_DIST_WPS", "NAV_DLL_ACT"], state, ADDRESSING, RULES)
    channel = Channel(reading, vehicle, Link(0.3, duplicates=0.1, reordered=0.1), seed, listeners=[state])
    assert channel.run() == {"MIS_DIST_WPS": 900.0, "NAV_DLL_ACT": 3.0}


def test_parameter_that_the_vehicle_does_not_have_is_missing_in_the_end():
    vehicle = WithParameters()
    state = known(vehicle)
    reading = ParameterReading(["MIS_DIST_1WP", "MIS_DIST_WPS"], state, ADDRESSING, RULES)
    channel = Channel(reading, vehicle, listeners=[state])
    assert channel.run() == {"MIS_DIST_WPS": 900.0}
    assert len(channel.to_vehicle) == 2 + RULES.retries


def test_nothing_to_read_is_read_at_once():
    reading = ParameterReading([], known(Px4()), ADDRESSING, RULES)
    assert (reading.start(0.0), reading.outcome) == ([], {})


@pytest.mark.parametrize("seed", range(10))
def test_a_parameter_is_set_over_a_bad_link_and_read_back(seed: int):
    vehicle = Px4(parameters={"RTL_RETURN_ALT": 60.0})
    state = known(vehicle)
    setting = ParameterSetting("RTL_RETURN_ALT", 85.0, state, ADDRESSING, RULES)
    outcome = Channel(setting, vehicle, Link(0.3, duplicates=0.1, reordered=0.1), seed, listeners=[state]).run()
    assert (outcome.state, vehicle.parameters["RTL_RETURN_ALT"]) == (CommandEnd.APPLIED, 85.0)
    assert "read back" in english(outcome.why)


def test_a_parameter_that_the_vehicle_keeps_as_it_was_is_not_set():
    vehicle = Px4(parameters={"RTL_RETURN_ALT": 60.0})
    vehicle.parameters_kept = {"RTL_RETURN_ALT"}
    state = known(vehicle)
    setting = ParameterSetting("RTL_RETURN_ALT", 85.0, state, ADDRESSING, RULES)
    outcome = Channel(setting, vehicle, Link(), 1, listeners=[state]).run()
    assert (outcome.state, outcome.code) == (CommandEnd.FAILED, "denied")
    assert "stays 60" in english(outcome.why)


def test_a_vehicle_that_does_not_answer_is_silent():
    vehicle = Px4()
    state = known(vehicle)
    setting = ParameterSetting("RTL_RETURN_ALT", 85.0, state, ADDRESSING, RULES)
    vehicle.parameters_kept = {"RTL_RETURN_ALT"}
    outcome = Channel(setting, vehicle, Link(), 1, listeners=[state]).run()
    assert (outcome.state, outcome.code) == (CommandEnd.FAILED, "silent")
