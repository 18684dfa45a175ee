"""Power in flight and the speed that the wind leaves."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.planning.energy_model import FLIGHTS, MAX_CALM_ERROR, POWERS_W, Flight, modelled
from planning.energy.performance import Performance
from planning.energy.power import AIRSPEED_STEP_MPS, CLIMBING, LEVEL, ground_speed_mps, power_table, power_w, watts

IRIS = Performance()
speeds = st.floats(0, 30)
courses = st.floats(0, 360, exclude_max=True)


def test_the_hover_is_momentum_theory_with_the_efficiency() -> None:
    """8 W + 4 T ** 1.5 / (sqrt(2 rho A) 0.52), T = 3.788 N of each rotor, A = 0.05147 m2: 8 + 4 * 39.93."""
    assert power_w(IRIS) == pytest.approx(167.7, abs=0.1)


def test_a_measured_hover_comes_out_as_measured() -> None:
    assert power_w(Performance(mass_kg=6.0, rotor_disk_m2=0.8, hover_power_w=700)) == pytest.approx(700, abs=0.01)


def test_a_climb_pays_for_its_height_but_is_spared_inflow() -> None:
    """2.5 m/s lift 15.15 N: 44.6 W with 0.85 of efficiency. The inflow falls from 5.48 to sqrt(5.48 ** 2 + 1.25 ** 2) - 1.25 = 4.37 m/s."""
    without_drag = Performance(drag_area_m2=0)
    assert power_w(without_drag, climb_mps=2.5) == pytest.approx(167.7 + 44.6 - 15.15 * (5.48 - 4.37) * 1.15 / 0.85, abs=0.2)


def test_a_descent_costs_what_level_flight_does() -> None:
    assert power_w(IRIS, airspeed_mps=6, climb_mps=-2) == power_w(IRIS, airspeed_mps=6)


def test_flying_slowly_takes_less_than_the_hover_and_flying_fast_more() -> None:
    assert power_w(IRIS, airspeed_mps=6) < power_w(IRIS) < power_w(IRIS, airspeed_mps=12)


@given(speeds, st.floats(0.6, 1.3), st.floats(0.5, 10))
def test_more_mass_takes_more_power(airspeed_mps: float, density: float, mass_kg: float) -> None:
    light, heavy = Performance(mass_kg=mass_kg), Performance(mass_kg=1.1 * mass_kg)
    at = {"airspeed_mps": airspeed_mps, "air_density": density}
    assert power_w(light, **at) < power_w(heavy, **at)


@given(st.floats(0.6, 1.3))
def test_thin_air_takes_more_power_in_the_hover(density: float) -> None:
    assert power_w(IRIS, air_density=0.9 * density) > power_w(IRIS, air_density=density)


@given(st.floats(0, 25), st.floats(0.7, 1.4), st.sampled_from([0.0, 1.0, 2.5, 5.0]))
def test_the_table_agrees_with_the_formula(airspeed_mps: float, density: float, climb_mps: float) -> None:
    table = power_table(IRIS, climb_mps)
    level, climbing = (power_w(IRIS, airspeed_mps=airspeed_mps, climb_mps=climb, air_density=density) for climb in (0.0, climb_mps))
    assert watts(table, LEVEL, airspeed_mps, density) == pytest.approx(level, rel=2e-3)
    assert watts(table, CLIMBING, airspeed_mps, density) == pytest.approx(climbing, rel=2e-3)


def test_beyond_its_last_column_the_table_stays() -> None:
    table = power_table(IRIS, 2.5)
    last_mps = (table.shape[2] - 1) * AIRSPEED_STEP_MPS
    assert watts(table, LEVEL, last_mps + 50, 1.225) == pytest.approx(watts(table, LEVEL, last_mps, 1.225))


@pytest.mark.parametrize("flight", [flight for flight in FLIGHTS if flight.is_steady], ids=lambda flight: flight.name)
def test_the_model_keeps_to_the_flights_measured(flight: Flight) -> None:
    found = modelled(flight)
    assert found.total_wh == pytest.approx(flight.used_wh, rel=flight.most)
    assert found.total_s == pytest.approx(flight.took_s, rel=0.15)


@pytest.mark.parametrize(("airspeed_mps", "measured_w"), POWERS_W)
def test_the_model_keeps_to_the_powers_measured(airspeed_mps: float, measured_w: float) -> None:
    assert power_w(IRIS, airspeed_mps=airspeed_mps) == pytest.approx(measured_w, rel=MAX_CALM_ERROR)


def test_within_the_limit_the_wanted_speed_over_ground_is_held() -> None:
    """5 m/s to the north against 6 m/s from there: 11 m/s through the air."""
    assert ground_speed_mps(0, 11, 5, (0, -6)) == 5


def test_against_a_strong_wind_the_limit_leaves_less() -> None:
    assert ground_speed_mps(0, 11, 8, (0, -6)) == pytest.approx(5)


def test_across_the_wind_part_of_the_airspeed_holds_the_course() -> None:
    """Of 10 m/s, 6 m/s hold against the wind from the side; 8 m/s remain."""
    assert ground_speed_mps(90, 10, 12, (0, 6)) == pytest.approx(8)


def test_down_a_wind_no_airspeed_is_needed_for_its_own_speed() -> None:
    assert ground_speed_mps(90, 3, 3, (3, 0)) == pytest.approx(3)


def test_a_wind_as_strong_as_the_limit_leaves_no_headway_against_it() -> None:
    assert ground_speed_mps(0, 8, 5, (0, -8)) is None


def test_in_a_wind_in_which_it_cannot_stay_a_uav_goes_nowhere() -> None:
    assert ground_speed_mps(0, 8, 12, (0, 9)) is None


@given(courses, st.floats(1, 20), st.floats(1, 20), courses, st.floats(0, 30))
def test_what_is_flown_needs_no_more_airspeed_than_the_limit(
    course_deg: float, limit_mps: float, wanted_mps: float, to_deg: float, wind_mps: float
) -> None:
    wind = wind_mps * math.sin(math.radians(to_deg)), wind_mps * math.cos(math.radians(to_deg))
    speed_mps = ground_speed_mps(course_deg, limit_mps, wanted_mps, wind)
    if speed_mps is None:
        assert wind_mps > limit_mps - 0.5
        return
    east, north = speed_mps * math.sin(math.radians(course_deg)), speed_mps * math.cos(math.radians(course_deg))
    assert math.hypot(east - wind[0], north - wind[1]) <= limit_mps + 1e-9
    assert 0 < speed_mps <= wanted_mps


def test_drag_that_is_not_stated_is_that_of_the_simulated_airframes() -> None:
    """Of the Inspector, with 0.032 m2 and 0.0156 s/m in its model file; an Iris without an airspeed is one with its own."""
    stated = Performance(mass_kg=3.77, rotor_disk_m2=0.5188, max_airspeed_mps=19.0, drag_area_m2=0.032, rotor_drag=0.01558)
    worked_out = replace(stated, drag_area_m2=None, rotor_drag=None)
    assert worked_out.body_drag_area_m2 == pytest.approx(0.032, rel=0.1)
    assert worked_out.disk_drag == pytest.approx(0.01558, rel=0.02)
    for airspeed_mps in (8.0, 10.0, 12.0, 14.0):
        own_w, true_w = (power_w(one, airspeed_mps=airspeed_mps) for one in (worked_out, stated))
        assert own_w == pytest.approx(true_w, rel=0.03)
    iris = Performance(max_airspeed_mps=11.0)
    assert (iris.body_drag_area_m2, iris.disk_drag) == pytest.approx((0.012, 0.0372))


@pytest.mark.parametrize("max_airspeed_mps", [5.0, 22.0, 40.0, 100.0])
def test_drag_at_the_maximum_airspeed_is_the_same_share_of_the_weight(max_airspeed_mps: float) -> None:
    """And at most half of it is the body's."""
    uav = Performance(mass_kg=6.0, max_airspeed_mps=max_airspeed_mps)
    body = 0.5 * 1.225 * uav.body_drag_area_m2 * max_airspeed_mps**2 / uav.weight_n
    assert body + uav.disk_drag * max_airspeed_mps == pytest.approx(0.468, abs=0.001)
    assert body <= 0.2341
