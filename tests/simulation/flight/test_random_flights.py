"""Whatever it is told, in whatever air, with whatever faults: it never raises, and never tells what is no number."""

import math
from dataclasses import fields
from random import Random

import pytest
from pymavlink.dialects.v20 import common as mavlink

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.faults import Faults, Weather
from simulation.flight.states import FlightMode, Gps, SimulatedState
from simulation.flight.uav import SimulatedUav
from tests.simulation.flight.lists import HOME, NAN, place, wind

COMMANDS = (16, 16, 16, 17, 18, 19, 20, 21, 22, 22, 93, 115, 177, 178, 178, 183, 195, 197, 203, 206, 2000, 2001, 31_000)
FRAMES = (0, 2, 3, 5, 6, 6, 6, 10, 11)
ODD = (NAN, math.inf, -math.inf, -1.0, 0.0, 0.0, 1.0, 2.5, 1e9)
SECONDS = 40


def odd_item(draw: Random) -> MissionItem:
    position = draw.choice([LonLat(0.0, 0.0), place(draw.uniform(-60, 60), draw.uniform(-60, 60)), LonLat(draw.uniform(-200, 200), 20.0)])
    likely = (draw.choice((0.0, 1.0, 2.0)), draw.choice((0.0, 4.0, 9.0)), 1.0, NAN)
    parameters = likely if draw.random() < 0.7 else tuple(draw.choice(ODD) for _ in range(4))
    height_m = draw.choice([draw.uniform(2, 40), draw.uniform(2, 40), NAN, -5.0, 3_000.0])
    return MissionItem(
        draw.choice(COMMANDS), draw.choice(FRAMES), parameters, round(position.lon * 1e7), round(position.lat * 1e7), height_m
    )


def likely_item(draw: Random) -> MissionItem:
    command = draw.choice((mavlink.MAV_CMD_NAV_WAYPOINT,) * 5 + (mavlink.MAV_CMD_NAV_LAND, mavlink.MAV_CMD_NAV_TAKEOFF))
    position = place(draw.uniform(-40, 40), draw.uniform(-40, 40))
    parameters = (draw.choice((0.0, 0.0, 2.0)), 0.0, 0.0, NAN)
    return MissionItem(command, 6, parameters, round(position.lon * 1e7), round(position.lat * 1e7), draw.uniform(3, 25))


def weather_of(draw: Random) -> Weather:
    strength = draw.choice((0.0, 5.0, 12.0, 30.0))
    return wind(
        strength, draw.uniform(0, 359), gusts_mps=draw.choice((0.0, 2.0, 8.0)), turbulence_mps_at_20ft=draw.choice((0.0, 8.0, 25.0))
    )


def faults_of(draw: Random, now_s: float) -> Faults:
    return Faults(
        gps_lost_until_s=now_s + draw.choice((0.0, 0.0, 15.0)),
        battery_wh_left=draw.choice((None, None, 0.1, 3.0)),
        motor_failed=draw.choice((None, None, None, 0, 3)),
        stuck_item=draw.choice((None, None, 1, 2)),
    )


def order(uav: SimulatedUav, draw: Random) -> None:
    """One order or change, more or less sensible."""
    number = draw.choice((*ODD, 5.0, 12.0))
    match draw.randrange(13):
        case 0:
            uav.load([odd_item(draw) for _ in range(draw.randrange(6))], is_home_first=draw.random() < 0.3)
        case 1:
            uav.load([likely_item(draw) for _ in range(draw.randrange(1, 6))])
        case 2:
            uav.arm()
        case 3:
            uav.disarm(force=draw.random() < 0.1)
        case 4:
            uav.take_off(number)
        case 5:
            uav.set_mode(draw.choice(list(FlightMode)))
        case 6:
            uav.go_to(LonLat(draw.choice((number, HOME.lon)), draw.choice((number, HOME.lat))), draw.choice((number, 10.0)), number)
        case 7:
            uav.change_speed(number)
        case 8:
            uav.set_current(draw.randrange(-1, 6))
        case 9:
            uav.weather = weather_of(draw)
        case 10:
            uav.faults = faults_of(draw, uav.now_s)
        case _:
            uav.set_mode(FlightMode.MISSION)


def numbers(state: SimulatedState) -> list[float]:
    found: list[float] = []
    for field in fields(state):
        value = getattr(state, field.name)
        if isinstance(value, Gps):
            found.append(value.hdop)
        elif isinstance(value, tuple):
            found += value
        elif isinstance(value, int | float):
            found.append(float(value))
    return found


@pytest.mark.parametrize("seed", range(12))
def test_random_flight_never_raises_and_never_tells_what_is_no_number(seed: int) -> None:
    draw = Random(seed)
    airframe = draw.choice(list(AIRFRAMES.values()))
    uav = SimulatedUav(airframe, HOME, weather=weather_of(draw), seed=seed, battery_percent=draw.choice((100.0, 20.0)))
    uav.load([likely_item(draw) for _ in range(5)])
    uav.set_mode(FlightMode.MISSION)
    uav.arm()
    for _ in range(SECONDS):
        if draw.random() < 0.35:
            order(uav, draw)
        for _ in range(25):
            uav.step()
        state = uav.state
        assert all(map(math.isfinite, numbers(state)))
        assert not (state.is_crashed and (state.is_in_air or state.is_armed))
        assert 0.0 <= state.battery_percent <= 100.0
        assert -90.0 <= state.position.lat <= 90.0
        assert state.is_in_air or state.is_crashed or state.altitude_agl_m < 1.0
        uav.take_events()


def test_two_uavs_step_by_step_fly_as_each_would_alone() -> None:
    def fresh(seed: int) -> SimulatedUav:
        uav = SimulatedUav(AIRFRAMES["iris"], HOME, weather=wind(6.0, 200.0, gusts_mps=2.0, turbulence_mps_at_20ft=8.0), seed=seed)
        uav.load([likely_item(Random(number)) for number in range(4)])
        uav.set_mode(FlightMode.MISSION)
        uav.arm()
        return uav

    alone = {}
    for seed in (1, 2):
        uav = fresh(seed)
        for _ in range(500):
            uav.step()
        alone[seed] = uav.state
    together = {seed: fresh(seed) for seed in (1, 2)}
    for _ in range(500):
        for uav in together.values():
            uav.step()
    assert {seed: uav.state for seed, uav in together.items()} == alone
    assert alone[1] != alone[2]


def test_asking_for_the_state_changes_nothing() -> None:
    asked, left = (SimulatedUav(AIRFRAMES["iris"], HOME, weather=wind(6.0, gusts_mps=2.0), seed=3) for _ in range(2))
    for uav in (asked, left):
        uav.take_off(5.0)
        uav.arm()
    for _ in range(250):
        asked.step()
        assert asked.state is asked.state
        left.step()
    assert asked.state == left.state


def test_model_that_comes_apart_is_a_crash_where_it_last_was() -> None:
    uav = SimulatedUav(AIRFRAMES["iris"], HOME)
    uav.take_off(5.0)
    uav.arm()
    for _ in range(100):
        uav.step()
    uav._body.plant.set_wind(NAN, 0.0, 0.0)
    uav.step()
    assert uav.is_crashed
    assert all(map(math.isfinite, numbers(uav.state)))


def test_set_points_that_are_no_numbers_are_not_taken() -> None:
    plant = SimulatedUav(AIRFRAMES["iris"], HOME)._body.plant
    assert plant.fly((1.0, 2.0, 3.0), (0.0, 0.0, 0.0), 1.0)
    for wrong in (NAN, math.inf):
        assert not plant.fly((wrong, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)
        assert not plant.fly((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), wrong)
    assert plant._model["setpoint/east-mps"] == 2.0
