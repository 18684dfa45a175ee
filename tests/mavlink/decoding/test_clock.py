"""A vehicle's clock is learnt from when its messages arrive, however late, early or doubled these are."""

import random
from dataclasses import dataclass, field
from itertools import accumulate

import pytest

from mavlink.decoding.boots import VehicleTime

START_S = 1_800_000_000.0


@dataclass
class Vehicle:
    """Reports five times a second of the server's time; its clock runs at `rate`."""

    rate: float = 1.0
    booted_s: float = START_S - 100.0
    chance: random.Random = field(default_factory=lambda: random.Random(5))

    def reports(self, start_s: float, duration_s: float, *, every_s: float = 0.2) -> list[tuple[int, float]]:
        """Time since boot [ms] and when it arrives: 20 to 70 ms later, at times half a second."""
        times = [start_s + number * every_s for number in range(round(duration_s / every_s))]
        sent = [(self.boot_ms(at_s), at_s + 0.02 + self.chance.random() * 0.05 + 0.5 * (self.chance.random() < 0.05)) for at_s in times]
        arrivals = accumulate((arrives_s for _, arrives_s in sent), max)  # in order
        return [(boot_ms, arrives_s) for (boot_ms, _), arrives_s in zip(sent, arrivals, strict=True)]

    def boot_ms(self, at_s: float) -> int:
        return round((at_s - self.booted_s) * self.rate * 1000)

    def true_s(self, boot_ms: int) -> float:
        return self.booted_s + boot_ms / 1000 / self.rate


def run(time: VehicleTime, reports: list[tuple[int, float]]) -> list[tuple[int, float, str]]:
    return [(boot_ms, stamp.measured_s, stamp.stream) for boot_ms, now_s in reports for stamp in [time.receive(boot_ms, now_s)]]


def worst_error_s(vehicle: Vehicle, stamped: list[tuple[int, float, str]]) -> float:
    return max(abs(measured_s - vehicle.true_s(boot_ms)) for boot_ms, measured_s, _ in stamped)


@pytest.mark.parametrize("rate", [1.0, 0.5, 2.0, 10.0, 60.0])
def test_offset_and_rate_are_learnt(rate):
    vehicle, time = Vehicle(rate), VehicleTime()
    first = run(time, vehicle.reports(START_S, 30))
    later = run(time, vehicle.reports(START_S + 30, 30))
    assert time.clock.rate == pytest.approx(rate, rel=0.03)
    assert worst_error_s(vehicle, first) < 6.0, "while it is learnt"
    assert worst_error_s(vehicle, later) < 0.5
    assert len({stream for *_, stream in first + later}) == 1


@pytest.mark.parametrize("rate", [1.0, 10.0, 60.0])
def test_records_stay_in_the_vehicles_order_while_its_clock_is_learnt(rate):
    stamped = run(VehicleTime(), Vehicle(rate).reports(START_S, 60, every_s=0.05))
    times = [measured_s for _, measured_s, _ in sorted(stamped)]
    assert times == sorted(times)
    assert len(set(times)) > 0.7 * len(times), "which arrive one by one"


def test_a_real_clock_is_exactly_one():
    time = VehicleTime()
    run(time, Vehicle().reports(START_S, 120))
    assert time.clock.rate == 1.0


def test_an_early_message_sets_a_late_first_one_right():
    vehicle, time = Vehicle(), VehicleTime()
    time.receive(vehicle.boot_ms(START_S), START_S + 8.0)
    stamped = run(time, vehicle.reports(START_S + 10, 20))
    assert worst_error_s(vehicle, stamped[50:]) < 0.2


@pytest.mark.parametrize("rate", [1.0, 10.0])
@pytest.mark.parametrize("lost_s", [5, 60, 600])
@pytest.mark.parametrize("order", ["kept first", "live first", "mixed"])
def test_what_was_kept_while_the_link_was_lost_is_of_its_own_time(rate, lost_s, order):
    vehicle, time = Vehicle(rate), VehicleTime()
    before = run(time, vehicle.reports(START_S, 60))
    back_s = START_S + 60 + lost_s
    kept_ms = [boot_ms for boot_ms, _ in vehicle.reports(START_S + 60, lost_s)]
    speed = 100  # records a second
    kept = [(boot_ms, back_s + 0.05 + number / speed) for number, boot_ms in enumerate(kept_ms)]
    live = vehicle.reports(back_s, len(kept) / speed + 5)
    arrivals = {
        "kept first": kept + [(boot_ms, max(now_s, kept[-1][1])) for boot_ms, now_s in live],
        "live first": live[:3] + kept + [(boot_ms, max(now_s, kept[-1][1])) for boot_ms, now_s in live[3:]],
        "mixed": sorted(kept + live, key=lambda report: report[1]),
    }[order]
    after = run(time, arrivals)
    assert len({stream for *_, stream in before + after}) == 1, "the same boot"
    assert time.clock.rate == pytest.approx(rate, rel=0.03)
    assert worst_error_s(vehicle, after) < 0.6 + 0.002 * lost_s * (rate != 1.0)


def test_a_reboot_is_another_stream():
    time, first = VehicleTime(), Vehicle()
    before = run(time, first.reports(START_S, 60))
    second = Vehicle(booted_s=START_S + 65)
    after = run(time, second.reports(START_S + 70, 60))
    assert {stream for *_, stream in before}.isdisjoint({stream for *_, stream in after})
    assert len({stream for *_, stream in after}) == 1
    assert worst_error_s(second, after) < 0.6


def test_a_day_time_tells_a_replay_that_looks_like_a_reboot():
    time, vehicle = VehicleTime(), Vehicle()
    time.receive(vehicle.boot_ms(START_S), START_S, unix_s=START_S)
    back_s = START_S + 1_000
    kept = vehicle.boot_ms(START_S - 50)
    assert time.receive(kept, back_s, unix_s=START_S - 50).stream == time.boots[0].key
    assert len(time.boots) == 1


def test_a_day_time_tells_a_reboot_that_looks_like_a_replay():
    time, vehicle = VehicleTime(), Vehicle(booted_s=START_S - 1_000)
    time.receive(vehicle.boot_ms(START_S), START_S, unix_s=START_S)
    assert time.receive(500_000, START_S + 1, unix_s=START_S + 1).stream != time.boots[0].key


def test_a_day_time_that_is_set_in_flight_is_no_reboot():
    time, vehicle = VehicleTime(), Vehicle()
    for number, (boot_ms, now_s) in enumerate(vehicle.reports(START_S, 20)):
        time.receive(boot_ms, now_s, unix_s=0.0 if number < 50 else now_s + 315_360_000.0)
    assert len(time.boots) == 1


def test_records_of_the_boot_before_are_known_after_a_reboot():
    time, first = VehicleTime(), Vehicle()
    (_, _, stream), *_ = run(time, first.reports(START_S, 60))
    second = Vehicle(booted_s=START_S + 70)
    run(time, second.reports(START_S + 75, 20))
    kept = run(time, [(first.boot_ms(START_S + 60 + n), START_S + 96) for n in range(8)])
    assert {key for *_, key in kept} == {stream}
    live = run(time, second.reports(START_S + 97, 5))
    assert {key for *_, key in live} == {time.boots[-1].key} != {stream}


def test_a_simulation_may_change_its_pace():
    time = VehicleTime()
    slow = Vehicle(1.0)
    run(time, slow.reports(START_S, 40))
    fast = Vehicle(10.0, booted_s=START_S + 40 - 14.0)
    run(time, fast.reports(START_S + 40, 60))
    assert time.clock.rate == pytest.approx(10.0, rel=0.03)
    slow_again = Vehicle(1.0, booted_s=START_S + 100 - 740.0)
    stamped = run(time, slow_again.reports(START_S + 100, 60))
    assert time.clock.rate == 1.0
    assert worst_error_s(slow_again, stamped[-50:]) < 0.6
    assert len(time.boots) == 1


@pytest.mark.parametrize("after_s", [0.5, 30])
def test_another_gateway_goes_on_where_one_ended(after_s):
    time, vehicle = VehicleTime(), Vehicle(10.0)
    run(time, vehicle.reports(START_S, 40))
    again = VehicleTime.from_json(time.to_json())
    assert again.to_json() == time.to_json()
    stamped = run(again, vehicle.reports(START_S + 40 + after_s, 10))
    assert {stream for *_, stream in stamped} == {time.boots[0].key}
    assert worst_error_s(vehicle, stamped) < 0.6


def test_the_same_message_twice_is_the_same_stamp_name():
    time, vehicle = VehicleTime(), Vehicle()
    one = time.receive(vehicle.boot_ms(START_S), START_S + 0.1)
    two = time.receive(vehicle.boot_ms(START_S), START_S + 0.3)
    assert (one.stream, one.sequence) == (two.stream, two.sequence)


@pytest.mark.parametrize("boot_ms", [4_000_000_000, 170_000])
def test_one_wrong_time_teaches_nothing(boot_ms):
    vehicle, time = Vehicle(), VehicleTime()
    run(time, vehicle.reports(START_S, 20.0))
    glitch = time.receive(boot_ms, START_S + 20.0)
    assert glitch.measured_s == START_S + 20.0
    stamped = run(time, vehicle.reports(START_S + 20.1, 60.0))
    assert worst_error_s(vehicle, stamped) < 0.1
    assert {stream for _, _, stream in stamped} == {glitch.stream}


def test_a_leap_that_goes_on_is_believed():
    vehicle, time = Vehicle(), VehicleTime()
    run(time, vehicle.reports(START_S, 20.0))
    ahead = Vehicle(booted_s=vehicle.booted_s - 86_400.0)
    stamped = run(time, ahead.reports(START_S + 20.1, 60.0))
    assert worst_error_s(ahead, stamped[100:]) < 0.2


@pytest.mark.parametrize("ran_s", [5.0, 9.0, 30.0])
def test_a_vehicle_that_boots_again_at_once_has_two_streams(ran_s):
    first, second, time = Vehicle(booted_s=START_S - 0.5), Vehicle(booted_s=START_S + ran_s + 1.5), VehicleTime()
    before = run(time, first.reports(START_S, ran_s))
    after = run(time, second.reports(START_S + ran_s + 2.0, 30.0))
    assert not {(stream, boot_ms) for boot_ms, _, stream in before} & {(stream, boot_ms) for boot_ms, _, stream in after}
