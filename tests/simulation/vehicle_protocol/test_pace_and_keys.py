"""The clock on the wall, and the keys."""

from collections import Counter

import pytest

from mavlink.frames import frames_of_datagram
from mavlink.signing import FrameWriter, SignatureCheck
from simulation.vehicle_endpoint.fleet import StepTimer
from simulation.vehicle_protocol.signed_link import SignedLink
from tests.telemetry.gateway.station import heartbeat

NOW_S = 1_800_000_000.0
KEY = bytes(range(32))


def run(step_timer, *, until_s, takes_s=0.0, busy=()):
    """A loop that sleeps until the next step; in the spans of `busy` it is kept from its work."""
    now_s = 0.0
    while now_s < until_s:
        now_s = next((end for begin, end in busy if begin <= now_s < end), now_s)
        if step_timer.begin(now_s):
            now_s += takes_s
        else:
            now_s = step_timer.next_s
    return step_timer


@pytest.mark.parametrize("speed", [1.0, 2.0, 5.0, 10.0])
def test_steps_are_as_many_as_the_pace_says_and_none_is_late(speed):
    step_timer = run(StepTimer(0.04, speed, 0.0), until_s=10.0, takes_s=0.5 * 0.04 / speed)
    assert step_timer.steps == pytest.approx(10.0 * speed / 0.04, abs=1)
    assert (step_timer.late_steps, step_timer.slipped_s) == (0, 0.0)


def test_a_short_delay_is_made_up_for_and_counted():
    step_timer = run(StepTimer(0.04, 1.0, 0.0), until_s=10.0, takes_s=0.01, busy=[(5.0, 5.3)])
    assert step_timer.steps == pytest.approx(250, abs=1) and step_timer.slipped_s == 0.0
    assert 5 <= step_timer.late_steps <= 10 and step_timer.latest_s == pytest.approx(0.3, abs=0.05)


def test_a_long_delay_is_given_up_and_counted():
    step_timer = run(StepTimer(0.04, 1.0, 0.0), until_s=10.0, takes_s=0.01, busy=[(2.0, 5.0)])
    assert step_timer.slipped_s == pytest.approx(3.0, abs=0.1) and step_timer.late_steps == 1
    assert step_timer.steps == pytest.approx((10.0 - 3.0) / 0.04, abs=3)


def test_steps_that_take_too_long_slow_time_down_and_end_in_no_spiral():
    step_timer = run(StepTimer(0.04, 10.0, 0.0), until_s=20.0, takes_s=0.008)
    assert step_timer.steps == pytest.approx(20.0 / 0.008, rel=0.01), "as fast as can be"
    assert step_timer.latest_s <= 1.0 + 0.02 and step_timer.slipped_s > 5.0


def test_another_pace_holds_from_then_on():
    step_timer = run(StepTimer(0.04, 1.0, 0.0), until_s=2.0)
    step_timer.change(10.0, 2.0)
    step_timer.steps = 0
    now_s = 2.0
    while now_s < 4.0:
        now_s = now_s if step_timer.begin(now_s) else step_timer.next_s
    assert step_timer.steps == pytest.approx(500, abs=2) and step_timer.late_steps == 0


def frame(writer, at_s):
    (found,) = frames_of_datagram(writer.frame_of(heartbeat(), at_s), Counter())
    return found


def test_without_a_key_everybody_is_believed_and_nothing_signed():
    link = SignedLink(7)
    assert link.is_believed(frame(FrameWriter(255, 190), NOW_S), NOW_S)
    (sent,) = frames_of_datagram(link.frame_of(heartbeat(), NOW_S), Counter())
    assert not sent.is_signed and sent.system == 7


def test_with_a_key_only_its_holders_are_and_only_once():
    link, ground = SignedLink(7, KEY), FrameWriter(255, 190, key=KEY)
    one = frame(ground, NOW_S)
    assert link.is_believed(one, NOW_S) and not link.is_believed(one, NOW_S)
    assert not link.is_believed(frame(FrameWriter(255, 190), NOW_S), NOW_S)
    assert not link.is_believed(frame(FrameWriter(255, 190, key=b"x" * 32), NOW_S), NOW_S)
    (sent,) = frames_of_datagram(link.frame_of(heartbeat(), NOW_S), Counter())
    assert SignatureCheck(KEY).refusal(sent, NOW_S) is None
    assert KEY.hex() not in repr(link) and repr(KEY) not in repr(link)


def test_a_slow_clock_is_set_by_who_has_the_key_and_by_nobody_else():
    link = SignedLink(7, KEY, clock_offset_s=-3_600.0)
    (sent,) = frames_of_datagram(link.frame_of(heartbeat(), NOW_S), Counter())
    assert SignatureCheck(KEY).refusal(sent, NOW_S) == "too-old"
    assert not link.is_believed(frame(FrameWriter(255, 190, key=b"x" * 32), NOW_S), NOW_S) and link.clock_offset_s == -3_600.0
    assert link.is_believed(frame(FrameWriter(255, 190, key=KEY), NOW_S), NOW_S)
    assert link.clock_offset_s == pytest.approx(0.0, abs=0.001)
    (sent,) = frames_of_datagram(link.frame_of(heartbeat(), NOW_S), Counter())
    assert SignatureCheck(KEY).refusal(sent, NOW_S) is None
