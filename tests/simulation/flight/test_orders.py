"""Orders from outside: what is done, what is refused with words, and that refused means untouched."""

import math

import pytest
from pymavlink.dialects.v20 import common as mavlink

from mavlink.vehicle_plan import MissionItem
from simulation.flight.airframe import AIRFRAMES, Settings
from simulation.flight.events import Armed, Disarmed
from simulation.flight.states import FlightMode, Landed, MissionItemState, OrderRefused
from simulation.flight.uav import SimulatedUav
from tests.simulation.flight.lists import HOME, airborne, at, off_m, place, plain, step, take_off, waypoint

IRIS = AIRFRAMES["iris"]
NAN, INF = math.nan, math.inf


@pytest.mark.parametrize(
    ("item", "code"),
    [
        pytest.param(MissionItem(mavlink.MAV_CMD_NAV_WAYPOINT, 6, (0, 0, 0, 0), 0, 910_000_000, 10.0), "invalid", id="beyond the pole"),
        pytest.param(MissionItem(mavlink.MAV_CMD_NAV_WAYPOINT, 6, (0, 0, 0, 0), 1_810_000_000, 0, 10.0), "invalid", id="longitude"),
        pytest.param(waypoint(0.0, 0.0, INF), "invalid", id="infinite height"),
        pytest.param(waypoint(0.0, 0.0, 1e6), "invalid", id="height in space"),
        pytest.param(waypoint(0.0, 0.0, 10.0, INF), "invalid", id="endless hold"),
        pytest.param(plain(mavlink.MAV_CMD_DO_CHANGE_SPEED, 1.0, INF), "invalid", id="infinite speed"),
        pytest.param(plain(mavlink.MAV_CMD_DO_JUMP, 7.0, 1.0), "invalid", id="jump out of the list"),
        pytest.param(plain(mavlink.MAV_CMD_DO_JUMP, NAN, 1.0), "invalid", id="jump to no number"),
        pytest.param(plain(31_999), "unsupported", id="unknown command"),
        pytest.param(at(mavlink.MAV_CMD_NAV_WAYPOINT, 0.0, 0.0, 10.0, frame=1), "frame", id="unknown frame"),
    ],
)
def test_list_that_cannot_be_flown_is_refused_whole(item: MissionItem, code: str) -> None:
    uav = SimulatedUav(IRIS, HOME)
    kept = [take_off(), waypoint(10.0, 0.0)]
    assert uav.load(kept).is_done
    outcome = uav.load([take_off(), item])
    assert isinstance(outcome, OrderRefused)
    assert outcome.code == code
    assert "Item 1" in outcome.words
    assert uav.items == tuple(kept)
    assert uav.state.mission_state is MissionItemState.NOT_STARTED


def test_what_is_left_open_is_filled_in() -> None:
    """NaN is "as you like", and a place of 0, 0 is here, as MAVLink has it."""
    uav = SimulatedUav(IRIS, HOME, settings=Settings(take_off_height_m=6.0))
    here = MissionItem(mavlink.MAV_CMD_NAV_TAKEOFF, 6, (NAN, NAN, NAN, NAN), 0, 0, NAN)
    stay = MissionItem(mavlink.MAV_CMD_NAV_WAYPOINT, 6, (NAN, NAN, NAN, NAN), 0, 0, NAN)
    assert uav.load([here, stay]).is_done
    assert uav.set_mode(FlightMode.MISSION).is_done
    assert uav.arm().is_done
    step(uav, 12.0)
    assert uav.state.mission_state is MissionItemState.COMPLETE
    assert uav.state.altitude_relative_m == pytest.approx(6.0, abs=0.3)
    assert off_m(uav.state.position, HOME) < 0.3


def test_armed_without_a_take_off_it_disarms_itself() -> None:
    uav = SimulatedUav(IRIS, HOME)
    uav.arm()
    events = step(uav, 11.0)
    assert [type(event) for event in events if isinstance(event, Armed | Disarmed)] == [Armed, Disarmed]
    assert uav.state.altitude_relative_m < 0.12


def test_take_off_that_is_ordered_disarmed_waits_for_arming() -> None:
    uav = SimulatedUav(IRIS, HOME)
    assert uav.take_off(8.0).is_done
    step(uav, 3.0)
    assert uav.state.landed is Landed.ON_GROUND
    assert uav.state.mode is FlightMode.TAKE_OFF
    uav.arm()
    step(uav, 9.0)
    assert uav.state.mode is FlightMode.HOLD
    assert uav.state.altitude_relative_m == pytest.approx(8.0, abs=0.2)


def test_go_to_flies_there_and_return_comes_home_and_lands() -> None:
    uav = airborne(SimulatedUav(IRIS, HOME, settings=Settings(return_height_m=15.0)))
    assert uav.go_to(place(20.0, 10.0), 12.0, heading_deg=300.0).is_done
    step(uav, 12.0)
    state = uav.state
    assert state.mode is FlightMode.GO_TO
    assert off_m(state.position, place(20.0, 10.0)) < 0.3
    assert state.altitude_relative_m == pytest.approx(12.0, abs=0.2)
    assert state.heading_deg == pytest.approx(300.0, abs=2.0)
    assert uav.return_home().is_done
    highest_m = 0.0
    for _ in range(1_500):
        uav.step()
        highest_m = max(highest_m, uav.state.altitude_relative_m)
    assert highest_m == pytest.approx(15.0, abs=0.3)
    assert uav.state.landed is Landed.ON_GROUND
    assert off_m(uav.state.true_position, HOME) < 0.3
    assert uav.state.mode is FlightMode.HOLD


def test_speed_can_be_changed_on_the_way() -> None:
    uav = airborne(SimulatedUav(IRIS, HOME))
    uav.go_to(place(200.0, 0.0), 10.0)
    step(uav, 5.0)
    assert uav.state.ground_speed_mps == pytest.approx(5.0, abs=0.3)
    assert uav.change_speed(2.0).is_done
    step(uav, 5.0)
    assert uav.state.ground_speed_mps == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("number", [NAN, INF, -INF])
def test_orders_with_what_is_no_number_are_refused(number: float) -> None:
    uav = airborne(SimulatedUav(IRIS, HOME), 3.0)
    wrong = [
        uav.take_off(number),
        uav.change_speed(number),
        uav.go_to(place(1.0, 1.0)._replace(lon=number), 5.0),
        uav.go_to(place(1.0, 1.0), number),
    ]
    assert not any(outcome.is_done for outcome in wrong)
    step(uav, 1.0)
    assert uav.state.mode is FlightMode.HOLD
    assert math.isfinite(uav.state.altitude_amsl_m)


def test_orders_that_make_no_sense_on_the_ground_are_refused() -> None:
    uav = SimulatedUav(IRIS, HOME)
    assert not uav.go_to(place(1.0, 1.0), 5.0).is_done
    assert not uav.set_mode(FlightMode.MISSION).is_done
    assert not uav.set_current(0).is_done
    assert not uav.change_speed(0.0).is_done


def test_places_and_batteries_that_cannot_be_are_refused() -> None:
    for home, percent in ((HOME._replace(lat=95.0), 50.0), (HOME._replace(lon=NAN), 50.0), (HOME, 101.0), (HOME, NAN)):
        with pytest.raises(ValueError, match="somewhere on earth"):
            SimulatedUav(IRIS, home, battery_percent=percent)
