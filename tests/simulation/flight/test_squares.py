"""The square of 4 x 500 m at 5 m/s that each change of model, gains and guidance has to fly."""

import numpy as np
import pytest

from simulation.flight.airframe import AIRFRAMES
from simulation.flight.faults import Weather
from simulation.flight.flown import Ending
from simulation.flight.route_flight import RouteFile, RouteFlight, fly_route
from tests.simulation.flight.lists import HOME, off_m, place, wind
from tests.simulation.flight.track_oracle import beside_m


def square(side_m: float) -> RouteFile:
    corners = (HOME, place(side_m, 0.0), place(side_m, side_m), place(0.0, side_m), HOME)
    return RouteFile(corners, (30.0,) * 5, 5.0)


def judged(flight: RouteFlight, route: RouteFile) -> np.ndarray:
    """Beside the route, from the first waypoint to the last: while it was at the height of the route."""
    samples = [sample for sample in flight.flown.samples if sample.altitude_relative_m > 29.5]
    return beside_m(np.array([(sample.lon, sample.lat) for sample in samples]), list(route.positions))


@pytest.mark.long
@pytest.mark.parametrize(
    ("weather", "most_rms_m", "most_m", "seed"),
    [
        pytest.param(Weather(), 0.3, 2.0, 1, id="calm", marks=pytest.mark.long),
        pytest.param(wind(8.0, 270.0), 0.4, 2.0, 2, id="wind", marks=pytest.mark.long),
        pytest.param(wind(8.0, 200.0, turbulence_mps_at_20ft=8.0), 0.5, 2.0, 3, id="turbulence", marks=pytest.mark.long),
        pytest.param(wind(8.0, 45.0, gusts_mps=2.0), 1.0, 3.0, 4, id="gusts"),
    ],
)
def test_square_of_two_kilometres_is_kept(weather: Weather, most_rms_m: float, most_m: float, seed: int) -> None:
    route = square(500.0)
    flight = fly_route(route, AIRFRAMES["iris"], weather=weather, seed=seed)
    reported, found = flight.as_json(), judged(flight, route)
    assert reported["assessment"] == {"result": "pass", "reasons": []}
    assert np.sqrt(np.mean(found**2)) < most_rms_m
    assert found.max() < most_m
    assert reported["cross_track_rms_m"] == pytest.approx(np.sqrt(np.mean(found**2)), abs=0.03)
    assert reported["cross_track_max_m"] == pytest.approx(found.max(), abs=0.1)  # the judge sees some seconds before and after
    touched_down_at = flight.flown.touched_down_at
    assert touched_down_at is not None
    assert off_m(touched_down_at, HOME) < 1.0


@pytest.mark.long
@pytest.mark.parametrize("seed", range(20))
def test_gusts_from_any_side_are_borne(seed: int) -> None:
    route = square(150.0)
    flight = fly_route(route, AIRFRAMES["iris"], weather=wind(8.0, 18.0 * seed, gusts_mps=2.0), seed=seed)
    reported, touched_down_at = flight.as_json(), flight.flown.touched_down_at
    assert reported["assessment"]["result"] == "pass"
    assert reported["cross_track_rms_m"] < 1.0
    assert reported["cross_track_max_m"] < 3.0
    assert touched_down_at is not None
    assert off_m(touched_down_at, HOME) < 1.0


@pytest.mark.long
@pytest.mark.parametrize("physics_hz", [125, 100])
def test_coarser_steps_fly_the_same_square(physics_hz: int) -> None:
    route = square(60.0)
    fine, coarse = (fly_route(route, AIRFRAMES["iris"], weather=wind(5.0), seed=1, physics_hz=hz) for hz in (250, physics_hz))
    assert coarse.flown.ending is Ending.LANDED
    assert coarse.flown.end.battery_used_wh == pytest.approx(fine.flown.end.battery_used_wh, rel=0.02)
    assert coarse.as_json()["cross_track_max_m"] < 1.0


def test_larger_airframe_flies_fast_in_a_gale() -> None:
    route = RouteFile((HOME, place(150.0, 0.0), place(150.0, 150.0)), (30.0, 40.0, 30.0), 10.0)
    flight = fly_route(route, AIRFRAMES["inspector"], weather=wind(12.0, 300.0, gusts_mps=2.0), seed=5)
    reported = flight.as_json()
    assert reported["assessment"]["result"] == "pass"
    assert reported["cross_track_max_m"] < 1.0


def test_same_seed_is_the_same_flight_to_the_last_bit_and_another_seed_is_not() -> None:
    route, weather = square(40.0), wind(6.0, 10.0, gusts_mps=2.0, turbulence_mps_at_20ft=6.0)
    first, again, other = (fly_route(route, AIRFRAMES["iris"], weather=weather, seed=seed).flown for seed in (7, 7, 8))
    assert first.samples == again.samples
    assert first.end == again.end
    assert first.events == again.events
    assert first.samples != other.samples
