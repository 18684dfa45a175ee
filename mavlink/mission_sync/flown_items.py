"""What a vehicle has flown of the list that it holds, as its messages show it."""

from dataclasses import dataclass

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType, Mode
from mavlink.vehicle_plan import FlightLoad
from mavlink.vehicle_state import VehicleState

RESET_S = 5.0  # within which a vehicle that has landed tells that it is disarmed, also when some of its messages are lost


@dataclass(frozen=True)
class FlownMissionItem:
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
    """Asked after each message that the vehicle's state has taken. One flight lasts from being seen in the air until it is down.

    ArduPilot's list is at the beginning again as soon as it has landed, before or after it tells that it is disarmed and on the ground: the
    item that it was on its way to is remembered, and given up for the first one only where that is told for longer than `RESET_S`.
    """

    has_flown_list: bool = False
    _reached: int = -1
    _bound_for: int = -1  # as the vehicle counts
    _back_at_s: float | None = None  # since when its list is at the beginning again

    def take_up(self, *, was_in_mission: bool, mission_item: int | None) -> None:
        """What the gateway before has seen of a vehicle in the air; it may be down by now."""
        if was_in_mission:
            self.has_flown_list = True
            if self._bound_for < 0 and mission_item is not None:
                self._bound_for = mission_item

    def forget(self) -> None:
        """Another list was put on it: nothing of that one is flown yet."""
        self.has_flown_list, self._reached, self._bound_for, self._back_at_s = False, -1, -1, None

    def check(self, state: VehicleState, kind: str) -> list[FlownMissionItem]:
        """kind: the message's type."""
        if state.is_armed and state.is_in_air and state.is_in(Mode.MISSION):
            self.has_flown_list = True
        if not self.has_flown_list:
            return []
        offset = 1 if state.autopilot_type is AutopilotType.ARDUPILOT else 0
        if state.is_armed:
            self._note_bound_for(state, offset)
        if kind == "MISSION_ITEM_REACHED" and state.reached_item is not None and state.reached_item >= offset:
            self._reached = state.reached_item - offset
            return [FlownMissionItem(self._reached)]
        if state.is_armed is False and state.is_in_air is False:
            current = state.mission_item or 0 if self._bound_for < 0 else self._bound_for
            return self._ended(current - offset)
        return []

    def _note_bound_for(self, state: VehicleState, offset: int) -> None:
        if state.mission_item is None or state.received_at_s is None:
            return
        if state.mission_item > offset or self._bound_for <= offset:
            self._bound_for, self._back_at_s = state.mission_item, None
        elif self._back_at_s is None:
            self._back_at_s = state.received_at_s
        elif state.received_at_s - self._back_at_s > RESET_S:
            self._bound_for = state.mission_item

    def _ended(self, current: int) -> list[FlownMissionItem]:
        reached = self._reached
        self.forget()
        if max(reached, current) < 0:
            return []
        return [
            FlownMissionItem(reached, is_down=True) if reached >= current else FlownMissionItem(current, is_reached=False, is_down=True)
        ]
