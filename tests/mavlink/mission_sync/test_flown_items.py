"""What a vehicle has flown, told from its messages alone."""

from itertools import permutations

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.mission_sync.flown_items import FlightWatch, FlownMissionItem
from mavlink.vehicle_plan import FlightLoad, MissionItem
from mavlink.vehicle_state import VehicleState
from tests.telemetry.vehicles.loads import AUTOPILOT_TYPES, mission

MODES = {"px4": (4 << 16 | 4 << 24, 4 << 16 | 3 << 24), "ardupilot": (3, 17)}  # the mission's, and another
LAND = MissionItem(mavlink.MAV_CMD_NAV_LAND, 6, (0.0, 0.0, 0.0, 0.0))
LANDING = FlightLoad((*mission(7)[:-1], LAND))
HOVERING = FlightLoad(mission(8)[:-1])


class Watched:
    def __init__(self, autopilot_type: str) -> None:
        self.now_s = 1.0
        self.autopilot_type, self.offset = autopilot_type, 1 if autopilot_type == "ardupilot" else 0
        self.state, self.watch, self.reported = VehicleState(7), FlightWatch(), []
        self._frames = mavlink.MAVLink(None, srcSystem=7, srcComponent=1)

    def feed(self, message) -> None:
        parsed = mavlink.MAVLink(None).parse_char(message.pack(self._frames))
        self.state.receive(parsed, self.now_s)
        self.reported += self.watch.check(self.state, parsed.get_type())

    def is_seen(self, *, armed: bool, in_air: bool, in_mission: bool = True) -> None:
        mode = MODES[self.autopilot_type][0 if in_mission else 1]
        self.feed(mavlink.MAVLink_extended_sys_state_message(0, 2 if in_air else 1))
        self.feed(
            mavlink.MAVLink_heartbeat_message(2, AUTOPILOT_TYPES[self.autopilot_type].autopilot, 1 | (128 if armed else 0), mode, 4, 3)
        )

    def goes_to(self, item: int) -> None:
        self.feed(mavlink.MAVLink_mission_current_message(item + self.offset))

    def reaches(self, item: int) -> None:
        self.feed(mavlink.MAVLink_mission_item_reached_message(item + self.offset))


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_flight_down_after_its_landing_was_flown(autopilot_type):
    uav = Watched(autopilot_type)
    uav.is_seen(armed=True, in_air=True)
    uav.goes_to(5)
    uav.reaches(5)
    uav.goes_to(6)
    assert uav.reported == [FlownMissionItem(5)]
    uav.is_seen(armed=True, in_air=False)
    uav.is_seen(armed=False, in_air=False)
    uav.is_seen(armed=False, in_air=False)
    down = uav.reported[-1]
    assert uav.reported == [FlownMissionItem(5), FlownMissionItem(6, is_reached=False, is_down=True)] and down.is_whole(LANDING)
    assert not down.is_whole(HOVERING), "whose last place was not reached"


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_flight_that_hovers_was_flown_once_it_is_down(autopilot_type):
    uav = Watched(autopilot_type)
    uav.is_seen(armed=True, in_air=True)
    uav.goes_to(6)
    uav.reaches(6)
    uav.is_seen(armed=True, in_air=True, in_mission=False)
    uav.is_seen(armed=False, in_air=False, in_mission=False)
    assert uav.reported[-1] == FlownMissionItem(6, is_down=True) and uav.reported[-1].is_whole(HOVERING)


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_flight_that_was_broken_off_was_not_flown(autopilot_type):
    uav = Watched(autopilot_type)
    uav.is_seen(armed=True, in_air=True)
    uav.goes_to(3)
    uav.is_seen(armed=False, in_air=False, in_mission=False)
    assert not uav.reported[-1].is_whole(LANDING) and not uav.reported[-1].is_whole(HOVERING)


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_flight_by_hand_tells_nothing_of_the_list(autopilot_type):
    uav = Watched(autopilot_type)
    uav.goes_to(6)
    uav.is_seen(armed=True, in_air=True, in_mission=False)
    uav.reaches(6)
    uav.is_seen(armed=False, in_air=False, in_mission=False)
    assert uav.reported == []


BEAT, ITEM, DOWN = "disarmed", "item", "on the ground"


@pytest.mark.parametrize("item", [0, 1], ids=["back to 0", "back to 1"])
@pytest.mark.parametrize("order", list(permutations((BEAT, ITEM, DOWN))), ids=" then ".join)
def test_an_ardupilot_that_has_landed_has_flown_its_list_in_whatever_order_it_tells(order: tuple[str, ...], item: int):
    """It disarms, its list is at the beginning again, and it is on the ground: each told once a second."""
    uav = Watched("ardupilot")
    uav.is_seen(armed=True, in_air=True)
    uav.goes_to(5)
    uav.reaches(5)
    uav.goes_to(6)
    says = {
        BEAT: mavlink.MAVLink_heartbeat_message(2, AUTOPILOT_TYPES["ardupilot"].autopilot, 1, 3, 3, 3),
        ITEM: mavlink.MAVLink_mission_current_message(item),
        DOWN: mavlink.MAVLink_extended_sys_state_message(0, 1),
    }
    for number, what in enumerate(order):
        uav.now_s += 0.9 * bool(number)
        uav.feed(says[what])
    assert [flown for flown in uav.reported if flown.is_down] == [FlownMissionItem(6, is_reached=False, is_down=True)]
    assert uav.reported[-1].is_whole(LANDING)


def test_a_list_begun_anew_in_the_air_and_broken_off_was_not_flown():
    uav = Watched("ardupilot")
    uav.is_seen(armed=True, in_air=True)
    uav.goes_to(6)
    for _ in range(10):
        uav.goes_to(0)
        uav.is_seen(armed=True, in_air=True)
        uav.now_s += 1.0
    uav.is_seen(armed=False, in_air=False)
    assert uav.reported[-1].is_down and not uav.reported[-1].is_whole(LANDING)


def test_a_gateway_that_takes_over_before_the_touch_down_knows_where_the_vehicle_was_bound():
    uav = Watched("ardupilot")
    uav.watch.take_up(was_in_mission=True, mission_item=7)
    uav.goes_to(0)
    uav.is_seen(armed=False, in_air=False)
    assert uav.reported[-1].is_whole(LANDING)
