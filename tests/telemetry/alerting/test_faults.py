"""Generated faults: each is told within the delay that its detector states, by one alert; and flights without faults alarm nobody."""

from dataclasses import replace

import numpy as np
import pytest

from mavlink.decoding.measurement import Measurement
from telemetry.alerting.detection import CRITICAL
from telemetry.alerting.detector import POLL_INTERVAL_S
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.detectors import DETECTORS
from telemetry.alerting.detectors.link import lost_after_s
from telemetry.alerting.surroundings import LinkFacts
from telemetry.estimation.report import Report
from tests.telemetry.alerting.faults import FAULTS, LIMITS, Fault, link_lost
from tests.telemetry.alerting.truth import MISSION, START_S, Instruments, TrueFlight, true_flight
from tests.telemetry.alerting.watch import Watch

BY_CODE = {detector.code: detector for detector in DETECTORS}
INTERVALS_S = (1, 1, 1, 2, 5, 10)
BEFORE_S = 40  # of flight are watched before a fault
FAST = 10


def flown_fast(flight: TrueFlight, seed: int, *, clock_rate: float) -> Watch:
    """Ten times as fast as its instruments tell, looked at once a second of the watch's clock."""
    watch, instruments = Watch(), Instruments(flight, seed)
    for second, state in enumerate(flight.states):
        values = instruments.values(state)
        if second % FAST:
            continue
        now_s = START_S + state.seconds / FAST
        seen = WatchedUav(1, 1, "Tern", MISSION, MISSION, newest=Report(now_s, now_s, Measurement(**values)))
        watch.evaluate(watch.inputs(now_s, seen, model=flight.model, link=LinkFacts(now_s, clock_rate=clock_rate)))
    return watch


def flown(flight: TrueFlight, seed: int, fault: Fault | None, *, interval_s: int) -> Watch:
    watch, instruments = Watch(), Instruments(flight, seed)
    uav = WatchedUav(1, 1, "Tern", MISSION, MISSION)
    last_message_s, newest = None, None
    begins, ends = (0, len(flight.states)) if fault is None else (max(fault.begins_s - BEFORE_S, 0), fault.begins_s + fault.lasts_s)
    for second in range(begins, ends):
        state = flight.states[min(second, len(flight.states) - 1)]
        state = fault.truth(state) if fault else state
        now_s = START_S + state.seconds
        values = instruments.values(state)
        if (second + seed) % interval_s == 0:
            reported = fault.reported(state, values) if fault else values
            if reported is not None:
                newest = Report(now_s, now_s, Measurement(**reported))
        last_message_s = now_s if fault is None or fault.is_received(state) else last_message_s
        seen = WatchedUav(uav.uav_id, 1, uav.name, MISSION, MISSION, newest=newest)
        around = {"model": flight.model, "link": LinkFacts(last_message_s if interval_s < 5 else None)}
        watch.evaluate(watch.inputs(now_s, seen, **{**around, **(fault.around(state, seen) if fault else {})}))
    return watch


def wrong_with(make, seed: int) -> str:
    """In words; empty: it was told in time, and nothing else was."""
    flight = true_flight(seed, least_leg_m=700.0 if make.__name__ == "zone_ahead" else 250.0)
    random = np.random.default_rng(seed)
    fault = make(flight, random)
    interval_s = min(int(random.choice(INTERVALS_S)), fault.extra.get("most_interval_s", 99))
    watch = flown(flight, seed, fault, interval_s=interval_s)
    words = []
    for code, levels, from_s in fault.due:
        reached_s = watch.reached(code, levels)
        late_s = np.inf if reached_s is None else reached_s - START_S - from_s - BY_CODE[code].delay_s(LIMITS, interval_s)
        if late_s > 0:
            words.append(f"{code} {'/'.join(levels)} {late_s:.1f} s late")
        if reached_s is not None and reached_s - START_S < fault.begins_s - 1:
            words.append(f"{code} told before it began")
    if make is link_lost:
        lost_s = watch.reached("link-lost", (CRITICAL,))
        if lost_s is None or lost_s > START_S + fault.begins_s + lost_after_s(LIMITS, interval_s) + POLL_INTERVAL_S:
            words.append("lost too late")
    wanted = {code for code, _, _ in fault.due}
    opened = [(event.code, event.subject) for event in watch.opened()]
    if (wanted and len(opened) != 1) or (not wanted and {code for code, _ in opened} - {"battery-short"}):
        words.append(f"opened {opened}")
    return f"{fault.name}, seed {seed}, reports each {interval_s} s: {', '.join(words)}" if words else ""


def alarms_of_calm_flight(seed: int) -> list[tuple[str, str]]:
    flight = true_flight(seed)
    watch = flown(flight, seed, None, interval_s=INTERVALS_S[seed % len(INTERVALS_S)])
    return [(event.code, event.level) for event in watch.events if event.what != "closed"]


@pytest.mark.parametrize("make", FAULTS, ids=lambda make: make.__name__)
def test_a_fault_is_told_in_time_and_once(make):
    assert [words for seed in range(5) if (words := wrong_with(make, seed))] == []


@pytest.mark.long
@pytest.mark.parametrize("make", FAULTS, ids=lambda make: make.__name__)
def test_each_fault_fifty_times(make):
    assert [words for seed in range(100, 150) if (words := wrong_with(make, seed))] == []


def test_flights_at_ten_times_real_time_alarm_nobody():
    """By their own clock; by the server's they would jump, at more than a hundred metres a second."""
    flights = {seed: true_flight(seed) for seed in range(5)}

    def alarms(clock_rate: float) -> set[str]:
        return {event.code for seed, flight in flights.items() for event in flown_fast(flight, seed, clock_rate=clock_rate).opened()}

    assert alarms(float(FAST)) == set()
    assert "gps" in alarms(1.0)


def test_who_does_not_come_on_is_told_by_its_own_clock():
    """It stands still for 60 s of its own, which are 6 s of the watch's."""
    flight = true_flight(0, least_leg_m=250.0)
    stands = flight.states[flight.cruising(20)[0]]
    states = tuple(replace(stands, seconds=float(second), east_mps=0.0, north_mps=0.0, holds=True) for second in range(60))
    opened = flown_fast(replace(flight, states=states), 0, clock_rate=float(FAST)).opened()
    assert [event.code for event in opened] == ["no-progress"]


def test_flights_without_faults_alarm_nobody():
    assert {seed: alarms for seed in range(5) if (alarms := alarms_of_calm_flight(seed))} == {}


@pytest.mark.long
def test_fifty_flights_without_faults():
    alarms = {seed: found for seed in range(200, 250) if (found := alarms_of_calm_flight(seed))}
    assert not [found for of_flight in alarms.values() for found in of_flight if found[1] == CRITICAL]
    assert len(alarms) <= 1, alarms  # a warning for nothing in one of fifty flights at most
