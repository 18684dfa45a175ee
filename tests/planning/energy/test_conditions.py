"""Wind by height, the air's density, and what a UAV may be."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.energy.conditions import (
    Conditions,
    InvalidConditions,
    WindLayer,
    conditions_from_json,
    conditions_to_json,
)
from planning.energy.performance import InvalidPerformance, Performance, performance_from_json, performance_to_json


def test_a_west_wind_moves_the_air_to_the_east() -> None:
    assert Conditions((WindLayer(10, 8, 270),)).wind_at(50) == pytest.approx((8, 0), abs=1e-12)


def test_a_north_wind_moves_the_air_to_the_south() -> None:
    assert Conditions((WindLayer(10, 8, 0),)).wind_at(50) == pytest.approx((0, -8), abs=1e-12)


def test_without_layers_the_air_is_still() -> None:
    assert Conditions().wind_at(50) == (0.0, 0.0)
    assert Conditions().is_calm


def test_wind_between_layers_is_interpolated_as_a_vector() -> None:
    """4 m/s from the west at 10 m and from the east at 30 m: still air in the middle, not 4 m/s from somewhere."""
    conditions = Conditions((WindLayer(10, 4, 270), WindLayer(30, 4, 90)))
    assert conditions.wind_at(20) == pytest.approx((0, 0), abs=1e-12)
    assert conditions.wind_at(15) == pytest.approx((2, 0), abs=1e-12)


def test_wind_is_held_below_the_lowest_and_above_the_highest_layer() -> None:
    conditions = Conditions((WindLayer(10, 4, 270), WindLayer(30, 6, 270)))
    assert conditions.wind_at(0) == pytest.approx((4, 0), abs=1e-12)
    assert conditions.wind_at(90) == pytest.approx((6, 0), abs=1e-12)


def test_density_is_that_of_the_standard_atmosphere() -> None:
    """ISO 2533: 1.225 kg/m3 at sea level; at 1,000 m 1.1117 kg/m3, where it has 8.5 °C."""
    assert Conditions().air_density(0.0) == pytest.approx(1.225, abs=1e-4)
    assert Conditions(temperature_c=8.5).air_density(1000.0) == pytest.approx(1.1117, abs=1e-4)


@given(st.floats(-430, 11_000), st.floats(-60, 45))
def test_density_follows_the_power_law_of_the_troposphere(amsl_m: float, temperature_c: float) -> None:
    pressure_pa = 101_325 * (1 - 0.0065 * amsl_m / 288.15) ** 5.25588
    density = pressure_pa / (287.05287 * (temperature_c + 273.15))
    assert Conditions(temperature_c=temperature_c).air_density(amsl_m) == pytest.approx(density, rel=1e-6)


def test_density_without_a_known_height_is_that_of_sea_level() -> None:
    assert Conditions().air_density(None) == Conditions().air_density(0.0)


@given(st.floats(-400, 4000), st.floats(1, 1000), st.floats(-40, 45))
def test_air_is_thinner_higher_up_and_where_it_is_warmer(amsl_m: float, rise_m: float, temperature_c: float) -> None:
    here = Conditions(temperature_c=temperature_c).air_density(amsl_m)
    assert Conditions(temperature_c=temperature_c).air_density(amsl_m + rise_m) < here
    assert Conditions(temperature_c=temperature_c + 5).air_density(amsl_m) < here


@given(
    st.lists(st.floats(0, 500), max_size=10, unique=True),
    st.data(),
    st.floats(-40, 45),
)
def test_conditions_come_back_from_their_json(heights_m: list[float], data: st.DataObject, temperature_c: float) -> None:
    speeds, directions = st.floats(0, 60), st.floats(0, 360, exclude_max=True)
    wind = tuple(WindLayer(agl_m, data.draw(speeds), data.draw(directions)) for agl_m in sorted(heights_m))
    conditions = Conditions(wind, temperature_c)
    assert conditions_from_json(json.loads(json.dumps(conditions_to_json(conditions)))) == conditions


def test_nothing_given_is_calm_air_of_15_degrees() -> None:
    assert conditions_from_json(None) == conditions_from_json({}) == conditions_from_json({"wind": None}) == Conditions()


LAYER = {"altitude_agl_m": 10, "speed_mps": 5, "from_deg": 90}


@pytest.mark.parametrize(
    ("value", "place"),
    [
        ([], "conditions"),
        ({"wind": 5}, "wind"),
        ({"winds": []}, "conditions.winds"),
        ({"wind": [LAYER] * 11}, "wind"),
        ({"wind": [LAYER, LAYER]}, "wind[1].altitude_agl_m"),
        ({"wind": [LAYER | {"altitude_agl_m": 20}, LAYER]}, "wind[1].altitude_agl_m"),
        ({"wind": [LAYER | {"speed_mps": 60.1}]}, "wind[0].speed_mps"),
        ({"wind": [LAYER | {"speed_mps": -1}]}, "wind[0].speed_mps"),
        ({"wind": [LAYER | {"speed_mps": math.nan}]}, "wind[0].speed_mps"),
        ({"wind": [LAYER | {"speed_mps": "5"}]}, "wind[0].speed_mps"),
        ({"wind": [LAYER | {"speed_mps": True}]}, "wind[0].speed_mps"),
        ({"wind": [LAYER | {"from_deg": 360}]}, "wind[0].from_deg"),
        ({"wind": [{"altitude_agl_m": 10, "speed_mps": 5}]}, "wind[0].from_deg"),
        ({"wind": [LAYER | {"speed_mps": 10**400}]}, "wind[0].speed_mps"),
        ({"temperature_c": 99}, "temperature_c"),
        ({"temperature_c": math.inf}, "temperature_c"),
    ],
)
def test_what_cannot_be_is_refused_with_its_place(value: object, place: str) -> None:
    with pytest.raises(InvalidConditions) as raised:
        conditions_from_json(value)
    assert raised.value.place == place


def test_performance_comes_back_from_its_json() -> None:
    performance = Performance(battery_wh=56.6, mass_kg=2.0, reserve_percent=25, max_airspeed_mps=11, rotor_disk_m2=0.3, hover_power_w=190)
    assert performance_from_json(json.loads(json.dumps(performance_to_json(performance)))) == performance


def test_performance_without_figures_is_the_iris_without_a_battery() -> None:
    assert performance_from_json(None) == performance_from_json({"mass_kg": None}) == Performance()
    assert Performance().usable_wh is None


def test_the_reserve_is_not_usable() -> None:
    assert Performance(battery_wh=50, reserve_percent=20).usable_wh == pytest.approx(40)


def test_a_measured_hover_sets_the_efficiency() -> None:
    """The Iris lifts with 83 W (15.15 N, 0.206 m2); of 174 W, 8 of them for avionics, that is one half."""
    assert Performance(hover_power_w=174).hover_efficiency == pytest.approx(0.5, abs=0.001)


@pytest.mark.parametrize(
    ("value", "place"),
    [
        ({"battery_wh": 0}, "battery_wh"),
        ({"mass_kg": math.nan}, "mass_kg"),
        ({"mass_kg": 10**400}, "mass_kg"),
        ({"reserve_percent": 100}, "reserve_percent"),
        ({"max_airspeed_mps": "11"}, "max_airspeed_mps"),
        ({"hover_power_w": 50}, "hover_power_w"),
        ({"hover_power_w": 5}, "hover_power_w"),
        ({"wings": 2}, "wings"),
    ],
)
def test_what_no_uav_has_is_refused_with_its_place(value: object, place: str) -> None:
    with pytest.raises(InvalidPerformance) as raised:
        performance_from_json(value)
    assert raised.value.place == place
