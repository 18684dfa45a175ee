"""What goes wrong, and what the autopilot makes of it."""

import math
from dataclasses import replace

import pytest

from inspection.geodesy import LonLat
from simulation.flight.airframe import AIRFRAMES, OwnAction, Settings
from simulation.flight.events import Crashed, ModeChanged, StatusTextSent
from simulation.flight.faults import Faults, ImpossibleFault
from simulation.flight.flown import Ending, fly_mission
from simulation.flight.states import FlightMode, Landed, OrderRefused
from simulation.flight.uav import SimulatedUav
from tests.simulation.flight.lists import HOME, airborne, begin, land, off_m, place, reached, step, take_off, waypoint

IRIS = AIRFRAMES["iris"]


def own_modes(events: list[object]) -> list[FlightMode]:
    return [event.mode for event in events if isinstance(event, ModeChanged) and event.is_own]


def texts(events: list[object]) -> str:
    return " | ".join(str(event.text) for event in events if isinstance(event, StatusTextSent))


def test_weak_battery_returns_in_time_and_lands_at_home() -> None:
    uav = SimulatedUav(IRIS, HOME, battery_percent=17.0)
    uav.load([take_off(), waypoint(0.0, 0.0), waypoint(300.0, 0.0), land(300.0, 0.0)])
    flown = fly_mission(uav)
    assert own_modes(list(flown.events))[0] is FlightMode.RETURN
    assert "Battery low: 15 %" in texts(list(flown.events))
    assert flown.ending is Ending.LANDED
    assert off_m(flown.end.true_position, HOME) < 0.5
    assert 3 not in reached(list(flown.events))


def test_battery_that_suddenly_holds_little_lands_at_once() -> None:
    uav = airborne(SimulatedUav(IRIS, HOME))
    uav.faults = Faults(battery_wh_left=0.05 * IRIS.battery_wh)
    events = step(uav, 15.0)
    assert uav.state.landed is Landed.ON_GROUND
    assert own_modes(list(events))[0] is FlightMode.LAND
    assert 3.0 < uav.state.battery_percent < 5.0
    assert not uav.arm().is_done
    uav.faults = replace(uav.faults, battery_wh_left=None)
    assert uav.state.battery_percent < 5.0  # taking the fault away charges nothing


def test_what_the_battery_does_by_itself_can_be_switched_off_until_it_is_empty() -> None:
    quiet = Settings(battery_low_action=OwnAction.NONE, battery_critical_action=OwnAction.NONE)
    uav = airborne(SimulatedUav(IRIS, HOME, settings=quiet))
    uav.faults = Faults(battery_wh_left=0.3)
    events = step(uav, 5.0)
    assert uav.state.mode is FlightMode.HOLD
    assert own_modes(list(events)) == []
    events = step(uav, 10.0)
    assert uav.is_crashed
    assert "Battery empty" in texts(list(events))
    assert next(event for event in events if isinstance(event, Crashed)).reason


def test_without_gps_it_drifts_lands_after_its_patience_and_says_so() -> None:
    uav = airborne(SimulatedUav(IRIS, HOME, seed=4))
    uav.faults = Faults(gps_lost_until_s=uav.now_s + 60.0)
    events = step(uav, 9.0)
    state = uav.state
    assert (state.gps.fix, state.gps.satellites, state.mode) == (0, 0, FlightMode.HOLD)
    off = off_m(state.position, state.true_position)
    assert 0.3 < off < 15.0
    assert off_m(state.position, HOME) < 0.5  # where it takes itself to be, it holds
    events += step(uav, 25.0)
    assert own_modes(list(events))[-2:] == [FlightMode.LAND, FlightMode.HOLD]
    assert uav.state.landed is Landed.ON_GROUND
    assert isinstance(uav.arm(), OrderRefused)


def test_gps_that_comes_back_in_time_brings_the_uav_back() -> None:
    uav = airborne(SimulatedUav(IRIS, HOME, seed=4))
    uav.faults = Faults(gps_lost_until_s=uav.now_s + 8.0)
    events = step(uav, 25.0)
    assert off_m(uav.state.true_position, HOME) < 0.5
    assert uav.state.position == uav.state.true_position
    assert "GPS fix again" in texts(list(events))
    assert uav.state.mode is FlightMode.HOLD


def test_motor_failure_in_the_air_is_a_crash_that_stays_one() -> None:
    uav = airborne(SimulatedUav(IRIS, HOME))
    uav.faults = Faults(motor_failed=2)
    events = step(uav, 10.0)
    assert [event for event in events if isinstance(event, Crashed)]
    assert texts(events).startswith("Motor 3 has failed"), "the report names it as the cause"
    where = uav.state.true_position
    assert math.isfinite(where.lon + where.lat + uav.state.altitude_amsl_m)
    step(uav, 5.0)
    assert uav.state.true_position == where
    assert not uav.state.is_armed
    assert not uav.state.is_in_air
    for outcome in (uav.arm(), uav.take_off(10.0), uav.hold(), uav.set_mode(FlightMode.LAND)):
        assert isinstance(outcome, OrderRefused)


def test_motors_stopped_in_the_air_by_force_let_it_fall() -> None:
    uav = airborne(SimulatedUav(IRIS, HOME))
    assert not uav.disarm().is_done
    assert uav.state.is_armed
    assert uav.disarm(force=True).is_done
    step(uav, 5.0)
    assert uav.is_crashed


def test_flight_into_a_hillside_is_a_crash_there() -> None:
    class Hill:
        def elevation_m(self, position: LonLat) -> float:
            return 0.5 * max(off_m(HOME, position) - 30.0, 0.0)

    uav = SimulatedUav(IRIS, HOME, ground=Hill())
    uav.load([take_off(), waypoint(0.0, 0.0), waypoint(150.0, 0.0)])
    flown = fly_mission(uav)
    assert flown.ending is Ending.CRASHED
    assert off_m(flown.end.true_position, place(50.0, 0.0)) < 3.0  # where the hill is 10 m high
    assert "hit the ground" in (str(flown.crash.reason) if flown.crash else "")


def test_landing_on_higher_ground_ends_there() -> None:
    class Step:
        def elevation_m(self, position: LonLat) -> float:
            return 6.0 if position.lon > place(20.0, 0.0).lon else 0.0

    uav = SimulatedUav(IRIS, HOME, ground=Step())
    uav.load([take_off(12.0), waypoint(40.0, 0.0, 12.0), land(40.0, 0.0)])
    flown = fly_mission(uav)
    assert flown.ending is Ending.LANDED
    assert flown.end.altitude_relative_m == pytest.approx(6.1, abs=0.1)
    assert flown.end.altitude_agl_m == pytest.approx(0.1, abs=0.1)


def test_ground_that_is_not_known_is_taken_as_before() -> None:
    class Unknown:
        def elevation_m(self, position: LonLat) -> float:
            return math.nan if off_m(HOME, position) > 5.0 else 80.0

    uav = SimulatedUav(IRIS, HOME, ground=Unknown())
    uav.load([take_off(), waypoint(20.0, 0.0), land(20.0, 0.0)])
    flown = fly_mission(uav)
    assert flown.ending is Ending.LANDED
    assert flown.end.altitude_amsl_m == pytest.approx(80.1, abs=0.1)


def test_faults_that_cannot_be_are_refused() -> None:
    for wrong in ({"motor_failed": 4}, {"motor_failed": -1}, {"battery_wh_left": -1.0}, {"battery_wh_left": math.nan}):
        with pytest.raises(ImpossibleFault):
            Faults(**wrong)
    with pytest.raises(ImpossibleFault):
        Faults(gps_lost_until_s=math.nan)


def test_lost_link_and_wrong_clock_are_told_and_change_nothing_in_flight() -> None:
    ways = []
    for faults in (Faults(), Faults(link_lost_until_s=20.0, clock_offset_s=3_600.0)):
        uav = SimulatedUav(IRIS, HOME, seed=1, faults=faults)
        uav.load([take_off(), waypoint(10.0, 0.0), land(10.0, 0.0)])
        begin(uav)
        step(uav, 15.0)
        ways.append(uav.true_place)
        assert uav.faults.is_link_lost(19.9) is (faults.link_lost_until_s > 0.0)
        assert not uav.faults.is_link_lost(20.0)
    assert ways[0] == ways[1]
