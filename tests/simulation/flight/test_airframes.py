"""Model files against the rows and figures that name them."""

import math

import numpy as np
import pytest

from simulation.flight.airframe import AIRFRAMES, Airframe
from simulation.flight.plant import AXES, MODELS, ROTORS, Plant, flight_model, mixer_of
from simulation.flight.states import FlightMode
from simulation.flight.uav import SimulatedUav
from tests.simulation.flight.lists import HOME, airborne, step, wind

EACH = pytest.mark.parametrize("airframe", AIRFRAMES.values(), ids=list(AIRFRAMES))


@EACH
def test_row_and_model_file_say_the_same(airframe: Airframe) -> None:
    model = flight_model(airframe.code, 0.004, 1)
    model["ic/h-agl-ft"] = 1.0
    model.run_ic()
    assert model["inertia/mass-slugs"] * 14.593903 == pytest.approx(airframe.mass_kg, rel=1e-5)
    assert model["figure/mass-kg"] == airframe.mass_kg
    for axis in ("xx", "yy", "zz"):
        assert model[f"inertia/i{axis}-slugs_ft2"] * 1.3558179 == pytest.approx(model[f"figure/i{axis}-kgm2"], rel=1e-4)


def test_every_model_file_has_a_row() -> None:
    assert {path.parent.name for path in MODELS.glob("*/*.xml")} - {"systems"} == set(AIRFRAMES)


@EACH
def test_mixer_undoes_what_the_rotors_do(airframe: Airframe) -> None:
    """One newton metre about an axis is what the four rotors, each at its arm, then make: by hand for the Iris."""
    mixer = np.array(mixer_of(airframe.code))
    assert mixer.shape == (len(AXES), ROTORS)
    assert mixer[0].sum() == pytest.approx(1.0)
    assert mixer[1:].sum(axis=1) == pytest.approx(np.zeros(3), abs=1e-12)
    if airframe.code == "iris":
        forward_m, right_m = np.array([0.13, -0.13, 0.13, -0.13]), np.array([0.22, -0.20, -0.22, 0.20])
        turning = np.array([1.0, 1.0, -1.0, -1.0])
        effects = np.array([np.ones(4), -right_m, forward_m, 0.06 * turning])
        assert effects @ mixer.T == pytest.approx(np.eye(4), abs=1e-12)


@EACH
def test_battery_lasts_as_long_as_the_source_says(airframe: Airframe) -> None:
    """Iris+: some 20 minutes. The inspection quadrotor: 36 minutes in the hover."""
    uav = airborne(SimulatedUav(airframe, HOME))
    before_wh = uav.state.battery_used_wh
    step(uav, 10.0)
    minutes = 60.0 * airframe.battery_wh / ((uav.state.battery_used_wh - before_wh) * 360.0)
    least, most = {"iris": (18.0, 22.0), "inspector": (35.0, 37.0)}[airframe.code]
    assert least < minutes < most


@EACH
def test_airspeed_of_the_row_can_be_flown_and_not_much_more(airframe: Airframe) -> None:
    """Into this wind it still holds its place; in 1.6 times this wind it is blown away, and keeps its height."""
    uav = airborne(SimulatedUav(airframe, HOME))
    uav.weather = wind(airframe.max_airspeed_mps, 0.0)
    step(uav, 12.0)
    assert uav.state.ground_speed_mps < 0.2
    assert uav.state.airspeed_mps == pytest.approx(airframe.max_airspeed_mps, abs=0.3)
    uav.weather = wind(1.6 * airframe.max_airspeed_mps, 0.0)
    step(uav, 15.0)
    assert uav.state.ground_speed_mps > 1.0
    assert abs(uav.state.pitch_deg) < 45.0
    assert uav.state.altitude_relative_m > 7.0


@EACH
def test_stands_still_on_the_ground(airframe: Airframe) -> None:
    uav = SimulatedUav(airframe, HOME, heading_deg=123.0, weather=wind(8.0))
    uav.arm()
    step(uav, 5.0)
    state = uav.state
    assert math.hypot(state.velocity_ned_mps[0], state.velocity_ned_mps[1]) < 0.01
    assert abs(state.altitude_relative_m - uav._body.plant.leg_m) < 0.01
    assert state.heading_deg == pytest.approx(123.0, abs=1.0)
    assert state.mode is FlightMode.HOLD


def test_steps_that_are_too_coarse_for_the_legs_are_refused() -> None:
    with pytest.raises(ValueError, match="not 50"):
        Plant(AIRFRAMES["iris"], HOME, ground_m=0.0, heading_deg=0.0, seed=1, physics_hz=50)


def test_an_airframe_without_a_model_file_is_refused() -> None:
    with pytest.raises(ValueError, match="no model file"):
        flight_model("none", 0.004, 1)
