"""How far estimates are from the truth, beside two ways without a filter: the last position held, and flown on straight ahead."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from telemetry.estimation.estimate import Estimate
from telemetry.estimation.knowledge import Knowledge
from telemetry.estimation.report import Report
from telemetry.estimation.tracker import Tracker
from tests.telemetry.estimation.received import reports_of
from tests.telemetry.estimation.routes import drawn_route, knowledge_for, route_on_line
from tests.telemetry.estimation.truth import STEP_S, Truth, fly

BEGUN_S = 1_764_000_000.0
INTERVALS_S = (1.0, 5.0, 10.0, 30.0)


@dataclass
class Score:
    """Errors [m] of each second; whether the truth was within the bounds."""

    error_m: list[float] = field(default_factory=list)
    held_m: list[float] = field(default_factory=list)
    straight_m: list[float] = field(default_factory=list)
    inside: list[bool] = field(default_factory=list)
    height_inside: list[bool] = field(default_factory=list)
    speed_inside: list[bool] = field(default_factory=list)
    arrival_inside: list[bool] = field(default_factory=list)
    area_m2: list[float] = field(default_factory=list)
    age_s: list[float] = field(default_factory=list)
    phase: list[str] = field(default_factory=list)

    def add(self, other: "Score") -> None:
        for name in self.__dataclass_fields__:
            getattr(self, name).extend(getattr(other, name))


def rms(values: Sequence[float]) -> float:
    return math.sqrt(float(np.mean(np.square(values)))) if len(values) else 0.0


def share(values: Sequence[bool]) -> float:
    return float(np.mean(values)) if len(values) else math.nan


def score(truth: Truth, knowledge: Knowledge, reports: Sequence[Report]) -> Score:
    """Second by second, with what had come by then; from the first report in the air to the landing."""
    tracker, found, waiting = Tracker(knowledge), Score(), list(reports)
    newest: Report | None = None
    begun_s = reports[0].measured_s - (reports[0].measured_s - BEGUN_S)
    for second in range(1, int(truth.duration_s)):
        now_s = begun_s + second
        while waiting and waiting[0].received_s <= now_s:
            report = waiting.pop(0)
            tracker.take(report)
            newest = report if newest is None or report.measured_s > newest.measured_s else newest
        if newest is None or not truth.in_air[int(second / STEP_S)]:
            continue
        estimate = tracker.estimate(now_s)
        if estimate is None:
            continue
        _compare(found, truth, second, estimate, newest, now_s)
    return found


def _compare(found: Score, truth: Truth, second: float, estimate: Estimate, newest: Report, now_s: float) -> None:
    real = truth.at(second)
    reported, age_s = newest.measurement, now_s - newest.measured_s
    lon, lat = reported.longitude_deg, reported.latitude_deg
    here, held = truth.frame.to_metres(np.array([estimate.position, (lon, lat)]))
    straight = held + age_s * np.array([reported.velocity_east_mps, reported.velocity_north_mps])
    off = real[:2] - here
    found.error_m.append(float(np.hypot(*off)))
    found.held_m.append(float(np.hypot(*(real[:2] - held))))
    found.straight_m.append(float(np.hypot(*(real[:2] - straight))))
    found.inside.append(is_inside(off, estimate))
    found.height_inside.append(abs(float(real[2]) - (estimate.altitude_relative_m or 0.0)) <= estimate.bound_height_m)
    found.speed_inside.append(abs(float(np.hypot(real[3], real[4])) - estimate.speed_mps) <= estimate.bound_speed_mps)
    found.area_m2.append(math.pi * estimate.bound.along_m * estimate.bound.across_m)
    found.age_s.append(age_s)
    row = int(second / STEP_S)
    found.phase.append(truth.modes[row])
    if second % 20 == 0:
        for arrival in estimate.arrivals:
            if arrival.waypoint_sequence in truth.reached:
                at_s = truth.reached[arrival.waypoint_sequence] + BEGUN_S
                found.arrival_inside.append(arrival.earliest_s - 0.5 <= at_s <= arrival.latest_s + 0.5)


def is_inside(off: NDArray[np.float64], estimate: Estimate) -> bool:
    bearing = math.radians(estimate.bound.bearing_deg)
    along = off[0] * math.sin(bearing) + off[1] * math.cos(bearing)
    across = off[0] * math.cos(bearing) - off[1] * math.sin(bearing)
    return bool((along / estimate.bound.along_m) ** 2 + (across / estimate.bound.across_m) ** 2 <= 1.0)


def score_flights(seeds: Iterable[int], lines: Sequence[Sequence[LonLat]] = ()) -> dict[float, Score]:
    """By report interval. With lines every other flight is along a stretch of one of them."""
    found = {every_s: Score() for every_s in INTERVALS_S}
    for seed in seeds:
        route = route_on_line(seed, lines) if lines and seed % 2 else drawn_route(seed)
        flight = route.flights[0]
        knowledge = knowledge_for(route, flight, seed)
        truth = fly(flight, knowledge, seed)
        for every_s, so_far in found.items():
            so_far.add(score(truth, knowledge, reports_of(truth, every_s, seed, begun_s=BEGUN_S)))
    return found
