"""What a vehicle has flown of the list that it holds, as its messages show it."""

from dataclasses import dataclass

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.mavlink.content import FlightLoad
from telemetry.ground_station.flavour import Flavour, Mode
from telemetry.ground_station.vehicle_state import VehicleState


@dataclass(frozen=True)
class Flown:
    """`item` counts from 0 without home. `is_down`: it has landed and is disarmed; `item` is then the last one it was at or on its way to.

    `is_reached` tells which of the two.
    """

    item: int
    is_reached: bool = True
    is_down: bool = False

    def is_whole(self, load: FlightLoad) -> bool:
        """Whether the flight was flown to its end: on its way to the landing everything before is behind it, else the last is reached."""
        last = len(load.mission) - 1
        if not self.is_down or self.item != last or last < 0:
            return False
        return self.is_reached or load.mission[last].command == mavlink.MAV_CMD_NAV_LAND


@dataclass
class FlightWatch:
    """Asked after each message that the vehicle's state has taken. One flight lasts from being seen in the air until it is down."""

    has_flown_list: bool = False  # also as the gateway before has seen it
    _reached: int = -1

    def forget(self) -> None:
        """Another list was put on it: nothing of that one is flown yet."""
        self.has_flown_list, self._reached = False, -1

    def look(self, state: VehicleState, kind: str) -> list[Flown]:
        """kind: the message's type."""
        if state.is_armed and state.is_in_air and state.is_in(Mode.MISSION):
            self.has_flown_list = True
        if not self.has_flown_list:
            return []
        offset = 1 if state.flavour is Flavour.ARDUPILOT else 0
        if kind == "MISSION_ITEM_REACHED" and state.reached_item is not None and state.reached_item >= offset:
            self._reached = state.reached_item - offset
            return [Flown(self._reached)]
        if state.is_armed is False and state.is_in_air is False:
            return self._ended((state.mission_item or 0) - offset)
        return []

    def _ended(self, current: int) -> list[Flown]:
        reached, self._reached, self.has_flown_list = self._reached, -1, False
        if max(reached, current) < 0:
            return []
        return [Flown(reached, is_down=True) if reached >= current else Flown(current, is_reached=False, is_down=True)]
