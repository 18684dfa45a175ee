"""Flights whose battery is not as planned: another capacity, another wind, ageing, and holds that nobody planned."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from mavlink.decoding.measurement import Measurement
from telemetry.alerting.detection import CRITICAL
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.detectors import battery
from telemetry.estimation.report import Report
from tests.telemetry.alerting.truth import MISSION, START_S, State, TrueFlight, true_flight
from tests.telemetry.alerting.watch import Watch

CLIMB_FACTOR = 1.3
AGES_BELOW_PERCENT = 40.0
SOON_S = 90.0  # below its reserve so soon, a critical alert was right
UNSURE_PERCENT = 3.0  # of the way home: within it, both are right
EMPTY_PERCENT = 0.5


@dataclass(frozen=True)
class Battery:
    """How it is in truth. `factor`: of the planned drain; `ages`: by how much faster the last percent go; wind to east and north [m/s]."""

    factor: float
    ages: float
    wind: tuple[float, float]


@dataclass(frozen=True)
class Moment:
    """One second of a flight. home_percent: what is left after a straight way home from here, in truth."""

    state: State
    left_percent: float
    home_percent: float
    mode: str


@dataclass(frozen=True)
class Flown:
    moments: tuple[Moment, ...]
    watch: Watch
    reserve_percent: float

    @property
    def first_critical_s(self) -> float | None:
        reached_s = self.watch.reached(battery.CODE, (CRITICAL,))
        return None if reached_s is None else reached_s - START_S

    @property
    def below_reserve_s(self) -> float | None:
        return next((one.state.seconds for one in self.moments if one.left_percent < self.reserve_percent and one.state.is_in_air), None)

    @property
    def was_warned_late(self) -> bool:
        """It was below its reserve before its critical alert had been open for 20 s."""
        below_s, critical_s = self.below_reserve_s, self.first_critical_s
        return below_s is not None and (critical_s is None or below_s < critical_s + 20.0)

    @property
    def was_false_alarm(self) -> bool:
        """Neither fell it below its reserve soon after its critical alert, nor was its way home too long."""
        critical_s, below_s = self.first_critical_s, self.below_reserve_s
        if critical_s is None or (below_s is not None and below_s <= critical_s + SOON_S):
            return False
        moment = next(one for one in self.moments if one.state.seconds >= critical_s)
        return moment.home_percent > self.watch.limits.battery_critical_percent + UNSURE_PERCENT


def battery_flight(seed: int) -> Flown:
    """A flight to its end, or until its battery is empty; nobody heeds any alert."""
    random = np.random.default_rng(seed + 40_000)
    flight = true_flight(seed)
    planned_east, planned_north = flight.conditions.wind_at(60.0)
    truth = Battery(
        float(random.uniform(0.85, 1.5)), float(random.uniform(0.0, 0.5)),
        (planned_east + float(random.normal(0, 1.5)), planned_north + float(random.normal(0, 1.5))),
    )  # fmt: skip
    interval_s = int(random.choice((1, 1, 2, 5)))
    watch, newest, moments = Watch(), None, tuple(_moments(flight, truth, random))
    for second, moment in enumerate(moments):
        now_s = START_S + moment.state.seconds
        if second % interval_s == 0:
            newest = Report(now_s, now_s, Measurement(**_reported(flight, moment, truth, random)))
        seen = WatchedUav(1, 1, "Tern", MISSION, MISSION, newest=newest)
        watch.evaluate(watch.inputs(now_s, seen, model=flight.model), (battery.DETECTOR,))
    return Flown(moments, watch, flight.model.reserve_percent)


def _moments(flight: TrueFlight, truth: Battery, random: np.random.Generator) -> Iterator[Moment]:
    left = 100.0
    for second, (state, mode) in enumerate(_with_holds(flight, random)):
        here = replace(state, seconds=float(second))
        if here.is_in_air:
            left -= _percent_per_s(flight, truth, here, left)
        if left < EMPTY_PERCENT:
            return
        yield Moment(here, left, _home_percent(flight, truth, here, left), mode)


def _with_holds(flight: TrueFlight, random: np.random.Generator) -> Iterator[tuple[State, str]]:
    """Up to three holds of up to two minutes on the way, at once one after the other now and then."""
    places = sorted(int(random.integers(20, len(flight.states) - 20)) for _ in range(int(random.integers(0, 4))))
    for second, state in enumerate(flight.states):
        yield state, "MISSION"
        for _ in range(places.count(second)):
            stands = replace(state, east_mps=0.0, north_mps=0.0, up_mps=0.0)
            for _ in range(int(random.integers(10, 120))):
                yield stands, "LOITER"


def _percent_per_s(flight: TrueFlight, truth: Battery, state: State, left: float) -> float:
    air_mps = math.hypot(state.east_mps - truth.wind[0], state.north_mps - truth.wind[1])
    ages = 1.0 + truth.ages * max(0.0, AGES_BELOW_PERCENT - left) / AGES_BELOW_PERCENT
    climbs = CLIMB_FACTOR if state.up_mps > 1.0 else 1.0
    return flight.model.consumption.percent_per_s(air_mps) * truth.factor * ages * climbs


def _home_percent(flight: TrueFlight, truth: Battery, state: State, left: float) -> float:
    flies_s, sinks_s, air_mps = flight.model.consumption.way(-state.east, -state.north, state.height_m, truth.wind)
    if math.isinf(flies_s):
        return -math.inf
    consumption, ages = flight.model.consumption, 1.0 + truth.ages * max(0.0, AGES_BELOW_PERCENT - left) / AGES_BELOW_PERCENT
    return left - (flies_s * consumption.percent_per_s(air_mps) + sinks_s * consumption.percent_per_s(0.0)) * truth.factor * ages


def _reported(flight: TrueFlight, moment: Moment, truth: Battery, random: np.random.Generator) -> dict:
    state = moment.state
    position = flight.position(state.east + random.normal(0, 1.2), state.north + random.normal(0, 1.2))
    return {
        "longitude_deg": position.lon, "latitude_deg": position.lat, "altitude_relative_m": state.height_m + random.normal(0, 0.6),
        "velocity_north_mps": state.north_mps + random.normal(0, 0.2), "velocity_east_mps": state.east_mps + random.normal(0, 0.2),
        "velocity_down_mps": -state.up_mps + random.normal(0, 0.1), "mode": moment.mode, "is_armed": state.is_in_air,
        "is_in_air": state.is_in_air, "battery_percent": float(max(0, round(moment.left_percent + random.normal(0, 0.2)))),
        "waypoint_sequence": state.vertex,
        "wind_north_mps": truth.wind[1] + random.normal(0, 0.5), "wind_east_mps": truth.wind[0] + random.normal(0, 0.5),
    }  # fmt: skip
