"""Whatever comes in, by whatever order: each command has one answer, each list is whole, and nothing that goes out cannot be packed."""

import random
import struct
from collections import Counter
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import frames_of_datagram, message_of
from mavlink.signing import FrameWriter
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.uav import SimulatedUav
from simulation.vehicle_protocol.endpoint import Endpoint
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.streams import CAMERA, Station
from tests.simulation.kinematic_uav import HOME, KinematicUav

SEEDS = [*range(6), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(6, 60))]
MESSAGES = 1_500
FLOATS = (0.0, -1.0, 1.0, 21_196.0, 4.0, 3.0, 55.0, 10.0, 1e9, -1e9, 3.4e38, float("nan"), float("inf"), float("-inf"))
TALKED = (
    "COMMAND_LONG", "COMMAND_INT", "SET_MODE", "MISSION_COUNT", "MISSION_ITEM_INT", "MISSION_ITEM", "MISSION_REQUEST_LIST",
    "MISSION_REQUEST_INT", "MISSION_REQUEST", "MISSION_ACK", "MISSION_CLEAR_ALL", "MISSION_SET_CURRENT", "PARAM_SET", "PARAM_REQUEST_READ",
    "PARAM_REQUEST_LIST", "FILE_TRANSFER_PROTOCOL", "TIMESYNC", "PING", "REQUEST_DATA_STREAM", "MISSION_WRITE_PARTIAL_LIST", "HEARTBEAT",
    "MANUAL_CONTROL", "SET_POSITION_TARGET_GLOBAL_INT", "GPS_RTCM_DATA", "SETUP_SIGNING",
)  # fmt: skip
COMMANDS = (
    400, 22, 21, 20, 300, 176, 192, 193, 178, 179, 189, 224, 410, 510, 511, 512, 519, 520, 16, 0, 65_535, 246, 209,
    195, 197, 201, 205, 115, 1000, 2000, 2001, 203, 206, 521, 527, 530,
)  # fmt: skip
ITEMS = (16, 17, 19, 20, 21, 22, 93, 177, 178, 195, 201, 205, 115, 1000, 2000, 2001, 5001, 5002, 5003, 5100, 12_345)
BY_NAME = {known.msgname: known for known in mavlink.mavlink_map.values()}


def drawn(chance: random.Random, name: str) -> Any:
    """A message of this kind with figures that its fields can bear, most of them nonsense."""
    known, fields = BY_NAME[name], []
    for field, kind, length in zip(
        known.fieldnames,
        known.fieldtypes,
        (known.array_lengths[known.ordered_fieldnames.index(name)] for name in known.fieldnames),
        strict=True,
    ):
        fields.append(
            [_value(chance, name, field, kind) for _ in range(length)] if length and kind != "char" else _value(chance, name, field, kind)
        )
    return known(*fields)


def _value(chance: random.Random, name: str, field: str, kind: str) -> Any:
    if field.startswith("target_"):
        return chance.choice((7, 7, 7, 0, 9)) if field == "target_system" else chance.choice((1, 1, 0, 100))
    if kind == "char":
        return chance.choice((b"RTL_RETURN_ALT", b"GF_ACTION", b"RTL_ALT", b"", b"\xff\xfe", b"NO_SUCH"))
    if kind in ("float", "double"):
        return chance.choice(FLOATS) if chance.random() < 0.8 else chance.uniform(-200, 200)
    if field == "command":
        return chance.choice(ITEMS if "ITEM" in name else COMMANDS)
    if field in ("count", "seq", "start_index", "end_index", "mission_type", "frame") and chance.random() < 0.9:
        return chance.randrange(4)
    bits = {"8": 8, "1": 16, "3": 32, "6": 64}[kind.lstrip("uint")[0]]
    low, high = (0, 2**bits - 1) if kind.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return (
        chance.choice((low, high, 0, chance.randint(low, high)))
        if low == 0
        else chance.choice((low, high, 0, 1, chance.randint(low, high)))
    )


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_nothing_that_comes_in_makes_it_fail_or_leaves_a_command_without_its_one_answer(autopilot_type, seed):
    chance = random.Random(seed)
    uav: Any = SimulatedUav(AIRFRAMES["iris"], HOME) if seed % 3 == 0 else KinematicUav()
    endpoint = Endpoint(uav, autopilot_type=autopilot_type, system=7, unix_at_zero_s=1.8e9)
    writer, ground = FrameWriter(7, 1), FrameWriter(255, 190)
    for number in range(MESSAGES):
        now_s = number * 0.01
        frame = bytearray(ground.frame_of(drawn(chance, chance.choice(TALKED)), 0.0))
        if chance.random() < 0.05:
            frame[chance.randrange(len(frame))] ^= 1 << chance.randrange(8)
        for intact in frames_of_datagram(bytes(frame), Counter()):
            message = message_of(intact)
            if message is None:
                continue
            station = Station(chance.choice((255, 255, 254)), 190, chance.choice((1, 1, 2)))
            before = uav.items
            answers = endpoint.receive(message, station, now_s)
            _check(message, answers, station)
            assert uav.items is before or message.get_type() in ("MISSION_ITEM_INT", "MISSION_ITEM", "MISSION_COUNT", "MISSION_CLEAR_ALL")
            _packed(writer, answers)
        uav.step()
        _packed(writer, endpoint.tick(now_s))
        assert len(endpoint.missions.held[0]) == len(uav.items)


def _check(message: Any, answers: list[Any], station: Station) -> None:
    is_ours = (
        message.get_type() in ("COMMAND_LONG", "COMMAND_INT")
        and message.target_system in (0, 7)
        and message.target_component in (0, 1, CAMERA)
    )
    acks = [one for one in answers if one.message.get_type() == "COMMAND_ACK"]
    if is_ours:
        (ack,) = acks
        assert (ack.message.command, ack.to) == (message.command, station)
        assert ack.component == (message.target_component or 1)
    elif message.get_type() != "SET_MODE":
        assert acks == []


def _packed(writer: FrameWriter, outgoing: list[Any]) -> None:
    for one in outgoing:
        try:
            assert writer.frame_of(one.message, 0.0)
        except struct.error as error:
            raise AssertionError(f"cannot be packed: {one.message}") from error
