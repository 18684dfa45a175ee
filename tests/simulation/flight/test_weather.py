"""Wind, gusts and turbulence as they are felt, against what was asked for."""

import math

import numpy as np
import pytest

from planning.energy.conditions import Conditions, WindLayer
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.body import VERTICAL_SHARE, Gusts
from simulation.flight.faults import ImpossibleWeather, Weather
from simulation.flight.uav import SimulatedUav
from tests.simulation.flight.lists import HOME, airborne, step, wind

IRIS = AIRFRAMES["iris"]


@pytest.mark.parametrize("dt_s", [0.04, 0.2])
def test_gusts_have_their_deviation_and_last_their_time_however_they_are_stepped(dt_s: float) -> None:
    gusts = Gusts(5)
    drawn = np.array([gusts.step(dt_s, 2.0, 3.0) for _ in range(int(6_000 / dt_s))])
    assert drawn[:, :2].std(axis=0) == pytest.approx([2.0, 2.0], rel=0.06)
    assert drawn[:, 2].std() == pytest.approx(2.0 * VERTICAL_SHARE, rel=0.06)
    lag = round(3.0 / dt_s)
    kept = np.corrcoef(drawn[:-lag, 0], drawn[lag:, 0])[0, 1]
    assert kept == pytest.approx(math.exp(-1.0), abs=0.06)


def test_calm_air_has_no_gusts_and_draws_none() -> None:
    gusts = Gusts(5)
    assert gusts.step(0.04, 0.0, 3.0) == (0.0, 0.0, 0.0)


def test_wind_from_the_west_is_felt_from_the_west() -> None:
    """Hovering, it leans into the wind, and the air goes past it to the east."""
    uav = airborne(SimulatedUav(IRIS, HOME, weather=wind(6.0, 270.0), heading_deg=270.0))
    step(uav, 5.0)
    state = uav.state
    assert state.wind_ned_mps == pytest.approx((0.0, 6.0, 0.0), abs=1e-9)
    assert state.airspeed_mps == pytest.approx(6.0, abs=0.1)
    assert state.pitch_deg < -5.0
    assert abs(state.roll_deg) < 1.0


def test_wind_grows_with_height_as_the_conditions_have_it() -> None:
    layers = Conditions((WindLayer(0.0, 0.0, 0.0), WindLayer(20.0, 8.0, 180.0)))
    uav = airborne(SimulatedUav(IRIS, HOME, weather=Weather(layers)), 10.0)
    assert uav.state.wind_ned_mps[0] == pytest.approx(4.0, abs=0.1)
    uav.weather = Weather()
    step(uav, 0.04)
    assert uav.state.wind_ned_mps == (0.0, 0.0, 0.0)


def test_turbulence_shakes_more_the_stronger_it_is() -> None:
    """In wind: Dryden's turbulence stands still in the air, and whoever moves with the air feels none of it."""
    shaken = []
    for at_20ft_mps in (0.0, 5.0, 12.0):
        uav = airborne(SimulatedUav(IRIS, HOME, weather=wind(6.0, turbulence_mps_at_20ft=at_20ft_mps), seed=2), 20.0)
        speeds = []
        for _ in range(500):
            uav.step()
            speeds.append(uav.state.airspeed_mps)
        shaken.append(float(np.std(speeds)))
    assert shaken[0] < 0.02 < shaken[1] < shaken[2]


def test_thin_and_warm_air_takes_more_power() -> None:
    """At 2,000 m above sea level the air has 82 % of its density: power of the hover goes with one over its root."""

    class High:
        def elevation_m(self, position: object) -> float:
            return 2_000.0

    def hover_w(uav: SimulatedUav) -> float:
        airborne(uav, 5.0)
        before = uav.state.battery_used_wh
        step(uav, 10.0)
        return (uav.state.battery_used_wh - before) * 360.0 - 8.0  # without the avionics

    low, high = hover_w(SimulatedUav(IRIS, HOME)), hover_w(SimulatedUav(IRIS, HOME, ground=High(), weather=Weather(Conditions((), 2.0))))
    assert high / low == pytest.approx(1.0 / math.sqrt(0.8217), rel=0.01)
    hot = hover_w(SimulatedUav(IRIS, HOME, weather=Weather(Conditions((), 35.0))))
    assert hot / low == pytest.approx(math.sqrt(308.15 / 288.15), rel=0.01)


def test_air_that_cannot_be_is_refused() -> None:
    for wrong in ({"gusts_mps": -1.0}, {"gusts_mps": math.nan}, {"gust_time_s": 0.0}, {"turbulence_mps_at_20ft": math.inf}):
        with pytest.raises(ImpossibleWeather):
            Weather(**wrong)
