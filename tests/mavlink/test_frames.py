"""Every intact frame comes out, and nothing else, whatever lies around it."""

import random
from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.frames import MAX_FAULTS, MAX_FRAME_LENGTH, Damage, StreamParser, frames_of_datagram, message_of
from mavlink.signing import FrameWriter

NOW_S = 1_800_000_000.0


def messages(number: int) -> list:
    return [
        dialect.MAVLink_global_position_int_message(n, 550_000_000 + n, 100_000_000, 30_000, 20_000, 1, -2, 3, 9_000) for n in range(number)
    ]


def frames(number: int, *, key: bytes | None = None) -> list[bytes]:
    writer = FrameWriter(1, 1, key=key)
    return [writer.frame_of(message, NOW_S) for message in messages(number)]


def v1_frame() -> bytes:
    mav = dialect.MAVLink(None, 7, 1)
    return dialect.MAVLink_heartbeat_message(2, 3, 81, 4, 3, 3).pack(mav, force_mavlink1=True)


def raws(found) -> list[bytes]:
    return [frame.raw for frame in found]


@pytest.mark.parametrize("key", [None, b"k" * 32])
def test_frames_come_out_as_they_went_in(key):
    damages = Counter()
    sent = frames(5, key=key)
    found = frames_of_datagram(b"".join(sent), damages)
    assert raws(found) == sent and not damages
    assert [(f.version, f.system, f.component, f.sequence, f.message_id) for f in found] == [(2, 1, 1, n, 33) for n in range(5)]
    assert all(frame.is_signed is (key is not None) for frame in found)
    assert [message_of(frame).lat for frame in found] == [message.lat for message in messages(5)]


def test_mavlink_1_is_told_apart():
    (frame,) = frames_of_datagram(v1_frame(), Counter())
    assert (frame.version, frame.system, frame.message_id, frame.is_signed) == (1, 7, 0, False)
    assert (message_of(frame).type, message_of(frame).autopilot) == (2, 3)


@pytest.mark.parametrize(
    ("datagram", "damage"),
    [
        (b"", None),
        (b"GET / HTTP/1.1", Damage.NOT_MAVLINK),
        (b"\xfd", Damage.CUT),
        (frames(1)[0][:-1], Damage.CUT),
        (frames(1)[0][:-1] + b"!", Damage.CHECKSUM),
        (b"\xfd\x01\x02" + frames(1)[0][3:], Damage.UNKNOWN_FLAGS),
        (b"\xfd\x01\x00\x00\x00\x01\x01\xff\xff\xffx12", Damage.UNKNOWN_MESSAGE),
    ],
)
def test_damage_is_named(datagram, damage):
    damages = Counter()
    assert frames_of_datagram(datagram, damages) == []
    assert damages[damage] >= 1 or (damage is None and not damages)


def test_a_good_frame_behind_garbage_is_found_in_the_same_datagram():
    good = frames(1)[0]
    for garbage in (b"abc", good[:20], b"\xfd\xff\x00", good[:-1] + b"!", b"\xfe" * 9, b"\xfd" * 300):
        assert raws(frames_of_datagram(garbage + good, Counter())) == [good]


@given(st.integers(0, 2**32), st.integers(1, 400))
def test_a_stream_gives_the_same_frames_however_it_is_cut(seed, longest):
    chance = random.Random(seed)
    sent = [*frames(20), *frames(5, key=b"k" * 32), v1_frame()]
    stream = b"".join(sent)
    parser, found = StreamParser(), []
    while stream:
        size = chance.randint(1, longest)
        found += parser.receive(stream[:size])
        stream = stream[size:]
    assert raws(found) == sent and not parser.damages


def test_a_stream_recovers_from_garbage_and_keeps_no_more_than_a_frame():
    parser, chance, found = StreamParser(), random.Random(7), []
    good = frames(200)
    for frame in good:
        found += parser.receive(chance.randbytes(chance.randint(0, 100)) + frame)
        assert len(parser._rest) <= MAX_FRAME_LENGTH
    found += parser.receive(bytes(MAX_FRAME_LENGTH))
    assert [raw for raw in raws(found) if raw in set(good)] == good


@given(st.binary(max_size=600))
def test_nothing_makes_it_fail(data):
    for frame in frames_of_datagram(data, Counter()):
        message_of(frame)
    StreamParser().receive(data)


def test_a_message_of_any_content_is_read_or_none():
    chance = random.Random(3)
    for known in list(dialect.mavlink_map.values()):
        for length in (0, 1, known.unpacker.size, 255):
            body = bytes([length, 0, 0, 0, 1, 1]) + known.id.to_bytes(3, "little") + chance.randbytes(length)
            checksum = dialect.x25crc(body + bytes([known.crc_extra])).crc
            (frame,) = frames_of_datagram(b"\xfd" + body + checksum.to_bytes(2, "little"), Counter())
            message_of(frame)


@pytest.mark.parametrize("marker", [b"\xfe", b"\xfd", b"\xfe\xfd", b"\xfd\x00\x00"])
def test_markers_without_end_are_given_up(marker: bytes):
    damages: Counter = Counter()
    assert frames_of_datagram(marker * (65_000 // len(marker)), damages) == []
    assert damages.total() <= MAX_FAULTS


def test_a_stream_goes_on_after_a_piece_that_was_given_up():
    good, parser = frames(1)[0], StreamParser()
    assert parser.receive(b"\xfe" * 16_000) == []
    assert raws(parser.receive(good)) == [good]
