"""S1: garbage between good datagrams costs none of these, and no memory."""

import random
import resource
from collections import Counter
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import frames_of_datagram
from mavlink.signing import FrameWriter
from telemetry.models import TelemetryRecord
from tests.telemetry.gateway.station import Link, gateway_at_work, heartbeat, port_of, position, unsigned_uav, wait_for

pytestmark = pytest.mark.django_db(transaction=True)

GOOD_EVERY = 50
LET_IT_CATCH_UP = 1_000
MAX_GROWTH_MIB = 24.0


def resident_mib() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 2**20


def malformed(chance: random.Random, frames: list[bytes]) -> bytes:
    """Flipped, cut, random, of a wrong checksum, of a message that nobody knows, of flags that nobody knows; never intact."""
    while True:
        frame = bytearray(chance.choice(frames))
        kind = chance.randrange(6)
        if kind == 0:
            for _ in range(chance.randint(1, 4)):
                frame[chance.randrange(len(frame))] ^= 1 << chance.randrange(8)
        elif kind == 1:
            del frame[chance.randrange(1, len(frame)) :]
        elif kind == 2:
            frame = bytearray(chance.randbytes(chance.randint(1, 280)))
        elif kind == 3:
            frame[-1] ^= 0x55
        elif kind == 4:
            frame[7:10] = (0xFFFFFF).to_bytes(3, "little")
        else:
            frame[2] = 0x80
        if not frames_of_datagram(bytes(frame), Counter()):
            return bytes(frame)


@pytest.mark.parametrize("number", [100_000, pytest.param(1_000_000, marks=pytest.mark.long)])
def test_malformed_datagrams(number, tmp_path, record_property):
    unsigned_uav()
    chance = random.Random(number)
    writer, signed = FrameWriter(1, 1), FrameWriter(1, 1, key=b"k" * 32)
    kinds = [
        heartbeat(),
        position(0),
        mavlink.MAVLink_statustext_message(4, b"x" * 50, 3, 0),
        mavlink.MAVLink_mission_count_message(255, 190, 3),
    ]
    frames = [maker.frame_of(message, 0.0) for maker in (writer, signed) for message in kinds]
    garbage = [malformed(chance, frames) for _ in range(20_000)]
    sent, began_mib = [], 0.0
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as link:
        link.send(heartbeat())
        wait_for(lambda: gateway.sessions and gateway.sessions[1].lease)
        for count in range(number):
            link.send_raw(garbage[chance.randrange(len(garbage))])
            if count % GOOD_EVERY == 0:
                sent.append(1_000 + count)
                link.send(position(sent[-1]))
            if count % LET_IT_CATCH_UP == 0:
                wait_for(lambda: gateway.sessions[1].time.boots and gateway.sessions[1].time.boots[-1].highest_s == sent[-1] / 1000)
            if count == number // 5:
                began_mib = resident_mib()
        wait_for(lambda: TelemetryRecord.objects.count() == len(sent))
        assert gateway.listeners.damages.total() >= number * 0.95
        assert resident_mib() - began_mib < MAX_GROWTH_MIB
        assert not gateway.damages
        dropped = gateway.listeners.damages.total()
        grown_mib = resident_mib() - began_mib
    record_property("figure", f"{dropped:,} of {number:,} dropped, {len(sent):,} of {len(sent):,} good ones stored, {grown_mib:+.1f} MiB")
    assert sorted(TelemetryRecord.objects.values_list("sequence", flat=True)) == sent
