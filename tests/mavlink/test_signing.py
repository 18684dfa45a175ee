"""A signature is believed once, in its minute, from whoever has the key."""

from collections import Counter

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.frames import Frame, frames_of_datagram
from mavlink.signing import MAX_STREAMS, FrameRefusal, FrameWriter, SignatureCheck, timestamp_at

KEY, OTHER_KEY = b"k" * 32, b"o" * 32
NOW_S = 1_800_000_000.0


def beat() -> dialect.MAVLink_heartbeat_message:
    return dialect.MAVLink_heartbeat_message(2, 3, 81, 4, 3, 3)


def frame(*, now_s: float = NOW_S, key: bytes | None = KEY, link_id: int = 0, component: int = 1) -> Frame:
    (found,) = frames_of_datagram(FrameWriter(1, component, link_id, key).frame_of(beat(), now_s), Counter())
    return found


def test_frames_of_the_reference_implementation_are_believed():
    mav = dialect.MAVLink(None, 1, 1)
    mav.signing.secret_key, mav.signing.sign_outgoing, mav.signing.timestamp = KEY, True, timestamp_at(NOW_S)
    (found,) = frames_of_datagram(beat().pack(mav), Counter())
    assert SignatureCheck(KEY).refusal(found, NOW_S) is None


def test_the_reference_implementation_believes_ours():
    mav = dialect.MAVLink(None)
    mav.signing.secret_key, mav.signing.timestamp = KEY, timestamp_at(NOW_S)
    writer = FrameWriter(255, 190, 3, KEY)
    for _ in range(3):
        assert mav.decode(bytearray(writer.frame_of(beat(), NOW_S))).get_signed()


def test_the_epoch_is_2015():
    assert timestamp_at(1_420_070_400 + 1) == 100_000


@pytest.mark.parametrize(
    ("received", "refusal"),
    [
        (frame(), None),
        (frame(key=None), FrameRefusal.UNSIGNED),
        (frame(key=OTHER_KEY), FrameRefusal.WRONG_SIGNATURE),
        (frame(now_s=NOW_S - 60), None),
        (frame(now_s=NOW_S - 61), FrameRefusal.TOO_OLD),
        (frame(now_s=NOW_S + 60), None),
        (frame(now_s=NOW_S + 61), FrameRefusal.FROM_THE_FUTURE),
    ],
)
def test_what_is_refused_and_why(received, refusal):
    check = SignatureCheck(KEY)
    assert check.refusal(received, NOW_S) == refusal
    assert bool(check.last) is (refusal is None)


def test_a_frame_counts_once():
    check, received = SignatureCheck(KEY), frame()
    assert check.refusal(received, NOW_S) is None
    assert check.refusal(received, NOW_S) == FrameRefusal.REPLAYED
    assert SignatureCheck(KEY, dict(check.last)).refusal(received, NOW_S) == FrameRefusal.REPLAYED, "nor after a restart"


def test_time_goes_forward_by_component_and_link():
    check = SignatureCheck(KEY)
    assert check.refusal(frame(), NOW_S) is None
    assert check.refusal(frame(now_s=NOW_S - 1), NOW_S) == FrameRefusal.REPLAYED
    assert check.refusal(frame(now_s=NOW_S - 1, link_id=1), NOW_S) is None
    assert check.refusal(frame(now_s=NOW_S - 1, component=2), NOW_S) is None


def test_who_has_no_key_moves_no_clock():
    check = SignatureCheck(KEY)
    assert check.refusal(frame(key=OTHER_KEY, now_s=NOW_S + 50), NOW_S) == FrameRefusal.WRONG_SIGNATURE
    assert check.refusal(frame(now_s=NOW_S + 1_000), NOW_S) == FrameRefusal.FROM_THE_FUTURE
    assert check.refusal(frame(), NOW_S) is None


def test_a_changed_byte_anywhere_is_seen():
    raw = frame().raw
    for place in (4, 5, 12, len(raw) - 13, len(raw) - 10, len(raw) - 1):
        changed = bytearray(raw)
        changed[place] ^= 1
        for found in frames_of_datagram(bytes(changed), Counter()):
            assert SignatureCheck(KEY).refusal(found, NOW_S) is not None


def test_our_times_go_forward_whatever_the_clock_does():
    writer = FrameWriter(255, 190, key=KEY)
    clock = (NOW_S, NOW_S - 3_600, NOW_S, NOW_S + 1)
    times = [frames_of_datagram(writer.frame_of(beat(), now_s), Counter())[0].timestamp for now_s in clock]
    assert times == sorted(set(times))
    restarted = FrameWriter(255, 190, key=KEY, last_timestamp=writer.last_timestamp)
    assert frames_of_datagram(restarted.frame_of(beat(), 0.0), Counter())[0].timestamp > times[-1]


def test_streams_are_bounded():
    check = SignatureCheck(KEY)
    refusals = [check.refusal(frame(link_id=n % 256, component=n // 256), NOW_S) for n in range(MAX_STREAMS + 1)]
    assert refusals == [None] * MAX_STREAMS + [FrameRefusal.TOO_MANY_STREAMS]


def test_a_key_shows_in_no_words():
    assert "kkkk" not in repr(SignatureCheck(KEY)) + repr(FrameWriter(1, 1, key=KEY))
