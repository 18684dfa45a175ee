"""Estimates of flights that JSBSim flew: another autopilot, another air than those that the estimator's figures were set on."""

import pytest

from tests.telemetry.estimation.routes import lines_of
from tests.telemetry.estimation.scoring import Score, rms, share
from tests.telemetry.estimation.simulated import fly_simulated, score_simulated, simulated_flight
from tests.telemetry.estimation.truth import Events


def is_better_than_both(score: Score) -> bool:
    return rms(score.error_m) < min(rms(score.held_m), rms(score.straight_m))


def test_a_simulated_flight_passes_its_waypoints_and_is_heard_of_as_a_vehicle_is() -> None:
    case = simulated_flight(3)
    truth = fly_simulated(case, 3, Events(0.0, 0.0, 0.0), physics_hz=100)
    assert sorted(truth.reached) == [waypoint.sequence for waypoint in case.flight.waypoints]
    assert set(truth.modes) <= {"MISSION", "LOITER", "AUTO", "BRAKE"}
    assert not truth.in_air[0] and not truth.armed[0] and any(truth.in_air)
    assert list(truth.reached.values()) == sorted(truth.reached.values())


@pytest.mark.long
def test_a_few_simulated_flights_are_estimated_well() -> None:
    for every_s, score in score_simulated(range(6), intervals_s=(10.0,), physics_hz=100).items():
        assert len(score.error_m) > 1_500
        assert is_better_than_both(score), every_s
        assert 0.88 <= share(score.inside) <= 0.995, (every_s, share(score.inside))  # of six flights: errors of GPS are shared by reports
        assert share(score.height_inside) >= 0.85


@pytest.mark.long
@pytest.mark.parametrize(
    "names",
    [
        pytest.param(["elme-valley.osm.pbf", "quillmoor.osm.pbf"], id="generated"),
        pytest.param(["columbus-ohio.osm.pbf", "nepal-power-2025.osm.pbf", "liechtenstein-2021-infra.osm.pbf"], id="real"),
    ],
)
def test_100_simulated_flights_keep_the_bars(names, region_file) -> None:
    lines = [line for name in names for line in lines_of(region_file(name))]
    scores = score_simulated(range(100), lines)
    assert all(is_better_than_both(score) for score in scores.values())
    assert 0.90 <= share(scores[10.0].inside) <= 0.98, share(scores[10.0].inside)
    assert share(scores[10.0].height_inside) >= 0.90
    assert share(scores[10.0].arrival_inside) >= 0.88
