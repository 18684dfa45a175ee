"""What a vehicle has flown, told from its messages alone."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.mavlink.content import FlightLoad, MissionItem
from telemetry.ground_station.flown import FlightWatch, Flown
from telemetry.ground_station.vehicle_state import VehicleState
from tests.telemetry.vehicles.loads import FLAVOURS, mission

MODES = {"px4": (4 << 16 | 4 << 24, 4 << 16 | 3 << 24), "ardupilot": (3, 17)}  # the mission's, and another
LAND = MissionItem(mavlink.MAV_CMD_NAV_LAND, 6, (0.0, 0.0, 0.0, 0.0))
LANDING = FlightLoad((*mission(7)[:-1], LAND))
HOVERING = FlightLoad(mission(8)[:-1])


class Watched:
    def __init__(self, flavour: str) -> None:
        self.flavour, self.offset = flavour, 1 if flavour == "ardupilot" else 0
        self.state, self.watch, self.told = VehicleState(7), FlightWatch(), []
        self._frames = mavlink.MAVLink(None, srcSystem=7, srcComponent=1)

    def hear(self, message) -> None:
        parsed = mavlink.MAVLink(None).parse_char(message.pack(self._frames))
        self.state.receive(parsed, 1.0)
        self.told += self.watch.look(self.state, parsed.get_type())

    def is_seen(self, *, armed: bool, in_air: bool, in_mission: bool = True) -> None:
        mode = MODES[self.flavour][0 if in_mission else 1]
        self.hear(mavlink.MAVLink_extended_sys_state_message(0, 2 if in_air else 1))
        self.hear(mavlink.MAVLink_heartbeat_message(2, FLAVOURS[self.flavour].autopilot, 1 | (128 if armed else 0), mode, 4, 3))

    def goes_to(self, item: int) -> None:
        self.hear(mavlink.MAVLink_mission_current_message(item + self.offset))

    def reaches(self, item: int) -> None:
        self.hear(mavlink.MAVLink_mission_item_reached_message(item + self.offset))


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_flight_down_after_its_landing_was_flown(flavour):
    uav = Watched(flavour)
    uav.is_seen(armed=True, in_air=True)
    uav.goes_to(5)
    uav.reaches(5)
    uav.goes_to(6)
    assert uav.told == [Flown(5)]
    uav.is_seen(armed=True, in_air=False)
    uav.is_seen(armed=False, in_air=False)
    uav.is_seen(armed=False, in_air=False)
    down = uav.told[-1]
    assert uav.told == [Flown(5), Flown(6, is_reached=False, is_down=True)] and down.is_whole(LANDING)
    assert not down.is_whole(HOVERING), "whose last place was not reached"


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_flight_that_hovers_was_flown_once_it_is_down(flavour):
    uav = Watched(flavour)
    uav.is_seen(armed=True, in_air=True)
    uav.goes_to(6)
    uav.reaches(6)
    uav.is_seen(armed=True, in_air=True, in_mission=False)
    uav.is_seen(armed=False, in_air=False, in_mission=False)
    assert uav.told[-1] == Flown(6, is_down=True) and uav.told[-1].is_whole(HOVERING)


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_flight_that_was_broken_off_was_not_flown(flavour):
    uav = Watched(flavour)
    uav.is_seen(armed=True, in_air=True)
    uav.goes_to(3)
    uav.is_seen(armed=False, in_air=False, in_mission=False)
    assert not uav.told[-1].is_whole(LANDING) and not uav.told[-1].is_whole(HOVERING)


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_flight_by_hand_tells_nothing_of_the_list(flavour):
    uav = Watched(flavour)
    uav.goes_to(6)
    uav.is_seen(armed=True, in_air=True, in_mission=False)
    uav.reaches(6)
    uav.is_seen(armed=False, in_air=False, in_mission=False)
    assert uav.told == []
