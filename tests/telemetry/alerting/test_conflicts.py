"""Two UAVs that come too near each other: told before they meet, by one alert for the pair."""

import math
from dataclasses import replace

import numpy as np
import pytest

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import LAND, Flight, FrozenWaypoint, TakeOff
from mavlink.decoding.measurement import Measurement
from planning.trajectory.waypoints import WaypointKind
from telemetry.alerting.conflicts import MAX_MET, NEAR_M, STEP_S, Moving, conflicts, ways_of
from telemetry.alerting.detection import CRITICAL, WARNING
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.detectors.converging import CODE, DETECTOR
from telemetry.alerting.route_line import RouteLine
from telemetry.alerting.surroundings import FlightModel
from telemetry.estimation.estimate import Ellipse, Estimate
from telemetry.estimation.report import Report
from tests.telemetry.alerting.faults import LIMITS
from tests.telemetry.alerting.truth import MISSION, START_S, Instruments, State, TrueFlight, true_flight
from tests.telemetry.alerting.watch import Watch


def flown_with_another(seed: int, *, passes_m: float, above_m: float = 0.0) -> tuple[list[Watch], int]:
    """Another UAV flies straight on and passes so far beside this one, and above it, at the second that is returned."""
    flight, random = true_flight(seed, least_leg_m=700.0), np.random.default_rng(seed)
    meets = int(random.choice([second for second in flight.cruising(30) if second >= 40])) + 25
    here = flight.states[meets]
    speed, course = float(random.uniform(5, 12)), math.atan2(here.north_mps, here.east_mps) + float(random.uniform(1.0, 5.0))
    east_mps, north_mps = speed * math.cos(course), speed * math.sin(course)
    # seen from this one the other comes along a straight line, which it passes beside
    between = np.array([east_mps - here.east_mps, north_mps - here.north_mps])
    beside = np.array([between[1], -between[0]]) / np.hypot(*between) * passes_m
    watches = [Watch(), Watch()]
    instruments = [Instruments(flight, seed), Instruments(flight, seed + 5_000)]
    for second in range(meets - 60, meets + 20):
        after_s = second - meets
        own = flight.states[second]
        east, north = here.east + beside[0] + after_s * east_mps, here.north + beside[1] + after_s * north_mps
        other = State(second, east, north, here.height_m + above_m, east_mps, north_mps)
        evaluate(flight, watches, [instruments[0].values(own), instruments[1].values(other) | {"waypoint_sequence": None}], second)
    return watches, meets


def evaluate(flight: TrueFlight, watches: list[Watch], reported: list[dict], second: int) -> None:
    now_s = START_S + second
    situations = []
    for number, (watch, values) in enumerate(zip(watches, reported, strict=True)):
        report = Report(now_s, now_s, Measurement(**values))
        uav = WatchedUav(number, 1, "Tern" if number == 0 else "Kite", MISSION, MISSION, newest=report, estimate=estimate(report))
        situations.append(watch.inputs(now_s, uav, **({"model": flight.model} if number == 0 else {})))
    moving = [way for inputs in situations for way in ways_of(inputs, LIMITS.converging_s)]
    met = conflicts(moving, LIMITS.converging_s)
    for number, (watch, inputs) in enumerate(zip(watches, situations, strict=True)):
        around = {name: getattr(inputs, name) for name in ("model", "held")}
        watch.evaluate(watch.inputs(now_s, inputs.uav, conflicts=tuple(met.get(number, ())), **around), [DETECTOR])


def estimate(report: Report) -> Estimate:
    reported = report.measurement
    return Estimate(
        at_s=report.measured_s, position=LonLat(reported.longitude_deg, reported.latitude_deg),
        altitude_relative_m=reported.altitude_relative_m, altitude_amsl_m=reported.altitude_amsl_m,
        speed_mps=10.0, heading_deg=0.0, bound=Ellipse(4.0, 3.0, 0.0), bound_height_m=2.0,
        bound_speed_mps=1.0, report_s=report.measured_s, is_measured=True, is_lost=False,
    )  # fmt: skip


def wrong_with(seed: int) -> str:
    watches, meets = flown_with_another(seed, passes_m=float(np.random.default_rng(seed).uniform(-6, 6)))
    first = watches[0].reached(CODE, (WARNING, CRITICAL))
    critical = watches[0].reached(CODE, (CRITICAL,))
    due_s = START_S + meets - LIMITS.converging_s + DETECTOR.delay_s(LIMITS) + STEP_S
    words = []
    if first is None or first > due_s:
        words.append(f"told {first and first - START_S - meets:+} s")
    if critical is None or critical > START_S + meets - 4:
        words.append("critical too late")
    if len(watches[0].opened()) != 1 or watches[1].opened():
        words.append(f"opened {[len(watch.opened()) for watch in watches]}")
    return f"seed {seed}: {', '.join(words)}" if words else ""


def test_two_that_meet_are_told_in_time_and_once():
    assert [words for seed in range(5) if (words := wrong_with(seed))] == []


@pytest.mark.long
def test_fifty_pairs_that_meet():
    assert [words for seed in range(300, 350) if (words := wrong_with(seed))] == []


@pytest.mark.parametrize(("passes_m", "above_m"), [(45.0, 0.0), (0.0, 25.0)], ids=["beside", "above"])
def test_two_that_pass_well_apart_alarm_nobody(passes_m, above_m):
    for seed in range(5):
        watches, _ = flown_with_another(seed, passes_m=passes_m, above_m=above_m)
        assert [event.level for watch in watches for event in watch.events] == []


def a_uav(key: int, *, lat_m: float = 0.0, height_m: float | None = 100.0, organisation: int = 1) -> Moving:
    place = (10.0, 56.0 + lat_m / 111_195.0)
    return Moving(key, f"UAV {key}", organisation, (place,) * 12, height_m, 0.0, 2.0, 2.0)


def test_of_a_pair_the_one_with_the_smaller_key_is_told():
    met = conflicts([a_uav(7), a_uav(3, lat_m=12.0)], 20.0)
    assert list(met) == [3] and (met[3][0].other_id, round(met[3][0].lateral_m)) == (7, 12)


def test_uavs_of_different_organisations_are_told_nothing_of_each_other():
    assert not conflicts([a_uav(1), a_uav(2, organisation=2)], 20.0)


def test_a_height_that_is_not_known_counts_as_the_same():
    assert conflicts([a_uav(1), a_uav(2, height_m=None)], 20.0)[1][0].height_m == 0.0
    assert not conflicts([a_uav(1), a_uav(2, height_m=300.0)], 20.0)


def test_pairs_far_away_from_each_other_are_found_among_many():
    """Against all pairs, looked at one by one."""
    chance = np.random.default_rng(8)
    moving = [a_uav(key, lat_m=float(chance.uniform(0.0, 20_000.0))) for key in range(60)]
    apart_m = {(one.uav_id, two.uav_id): abs(one.ahead[0][1] - two.ahead[0][1]) * 111_195.0 for one in moving for two in moving}
    near = {pair for pair, metres in apart_m.items() if pair[0] < pair[1] and metres <= NEAR_M}
    assert near and near == {(key, conflict.other_id) for key, met in conflicts(moving, 20.0).items() for conflict in met}


def test_in_a_crowd_each_is_told_of_those_that_come_nearest():
    crowd = [a_uav(key, lat_m=float(key)) for key in range(40)]
    met = conflicts(crowd, 20.0)
    reported = {(key, conflict.other_id) for key, conflicts_of in met.items() for conflict in conflicts_of}
    assert len(reported) <= 40 * MAX_MET
    assert {(key, key + 1) for key in range(39)} <= reported


LEG_M, CRUISE_MPS, LEVEL_M = 300.0, 10.0, 30.0
HERE = LonLat(10.0, 56.0)
FRAME = LocalFrame.around(HERE.lon, HERE.lat)


def a_line(*, from_east_m: float = 0.0, arrives_s: float = 14.0) -> RouteLine:
    """To the east along a straight leg, planned to be at its begin, LEVEL_M high, so long after take-off."""
    waypoints = tuple(
        FrozenWaypoint(
            sequence=place, position=at(from_east_m + east, 0.0), kind=WaypointKind.START if place == 0 else WaypointKind.END,
            altitude_agl_m=LEVEL_M, altitude_relative_m=LEVEL_M, altitude_amsl_m=LEVEL_M + 100.0, arrival_s=arrives_s + east / CRUISE_MPS,
        )
        for place, east in enumerate((0.0, LEG_M))
    )  # fmt: skip
    return RouteLine(Flight(0, TakeOff(waypoints[0].position, 100.0), waypoints, LAND))


def at(east: float, north: float) -> LonLat:
    return LonLat(*FRAME.to_degrees(np.array([[east, north]]))[0].tolist())


def reported(position: LonLat, height_m: float, *, north_mps: float = 0.0, climb_mps: float = 0.0) -> Measurement:
    return Measurement(
        longitude_deg=position.lon, latitude_deg=position.lat, altitude_relative_m=height_m, altitude_amsl_m=height_m + 100.0,
        velocity_north_mps=north_mps, velocity_east_mps=0.0, velocity_down_mps=-climb_mps, is_armed=True, is_in_air=True, mode="AUTO",
        waypoint_sequence=0,
    )  # fmt: skip


def ways(key: int, measured: Measurement, line: RouteLine | None) -> list[Moving]:
    report = Report(START_S, START_S, measured)
    uav = WatchedUav(key, 1, f"UAV {key}", MISSION, MISSION, newest=report, estimate=estimate(report))
    model = None if line is None else FlightModel(line, None, 15.0, 20.0)
    return ways_of(Watch().inputs(START_S, uav, model=model), LIMITS.converging_s)


def test_one_that_takes_off_is_seen_to_meet_another_on_its_leg_before_it_moves_there():
    """It stands 20 m high at the begin of its leg, at rest but for its climb; after 4 s of that and 8 s of its leg it is at the other."""
    climbing = ways(1, reported(at(0.0, 0.0), 20.0, climb_mps=2.5), a_line())
    crossing = ways(2, reported(at(80.0, -60.0), LEVEL_M, north_mps=5.0), None)
    nearest = conflicts([*climbing, *crossing], LIMITS.converging_s)[1][0]
    assert (nearest.in_s, nearest.lateral_m, nearest.height_m) == (pytest.approx(12.0, abs=1.0), pytest.approx(0.0, abs=3.0), 0.0)


def test_one_that_takes_off_under_the_others_way_is_seen_to_come_up_to_it():
    climbing = ways(1, reported(at(0.0, 0.0), 2.0, climb_mps=2.5), a_line())
    above = ways(2, reported(at(-110.0, 0.0), LEVEL_M), a_line(from_east_m=-200.0, arrives_s=0.0))
    nearest = conflicts([*climbing, *above], LIMITS.converging_s)[1][0]
    assert (nearest.in_s, nearest.lateral_m) == (pytest.approx(11.0, abs=2.0), pytest.approx(0.0, abs=3.0)) and nearest.height_m < 8.0


def test_simulated_twins_are_in_no_other_uavs_way():
    near = [ways(1, reported(at(0.0, 0.0), 29.0), None)[0], ways(2, reported(at(5.0, 3.0), 29.0), None)[0]]
    assert conflicts(near, LIMITS.converging_s)[1]
    assert not conflicts([near[0], replace(near[1], is_twin=True)], LIMITS.converging_s)[1]
    assert conflicts([replace(one, is_twin=True) for one in near], LIMITS.converging_s)[1]


def test_a_pair_with_several_ways_has_one_alert():
    both = [*ways(1, reported(at(0.0, 0.0), 29.0, climb_mps=1.0), a_line()), *ways(2, reported(at(5.0, 3.0), 29.0), a_line())]
    assert len(both) == 4
    met = tuple(conflicts(both, LIMITS.converging_s)[1])
    assert len(met) > 1
    report = Report(START_S, START_S, reported(at(0.0, 0.0), 29.0))
    uav = WatchedUav(1, 1, "UAV 1", MISSION, MISSION, newest=report)
    found = DETECTOR.detect(Watch().inputs(START_S, uav, conflicts=met))
    assert [(detection.subject, detection.level) for detection in found] == [("2", CRITICAL)]


def test_one_that_lands_is_not_taken_to_stay_at_the_end_of_its_route():
    line = a_line()
    landing = ways(1, reported(at(LEG_M, 0.0), 6.0, climb_mps=-1.0), line)
    assert len(landing) == 1
