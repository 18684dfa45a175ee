"""Derives which items of its mission a vehicle has flown, from its messages."""

from dataclasses import dataclass

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType, Mode
from mavlink.vehicle_plan import FlightLoad
from mavlink.vehicle_state import VehicleState

RESET_S = 5.0  # by then a landed vehicle has reported that it is disarmed, even if some messages are lost


@dataclass(frozen=True)
class FlownMissionItem:
    """Progress of a flight. `item` counts from 0 without home.

    `is_down`: the vehicle has landed and is disarmed; `item` is then the last one that it reached or flew towards. `is_reached` is whether
    it reached `item`.
    """

    item: int
    is_reached: bool = True
    is_down: bool = False

    def is_whole(self, load: FlightLoad) -> bool:
        """Return whether the whole flight was flown: the last item was reached, or is the landing."""
        last = len(load.mission) - 1
        if not self.is_down or self.item != last or last < 0:
            return False
        return self.is_reached or load.mission[last].command == mavlink.MAV_CMD_NAV_LAND


@dataclass
class FlightWatch:
    """Tracks one flight, from the first report in the air until the vehicle is down.

    Call `check` after each message that the state has received. ArduPilot resets its list to the beginning on landing, before or after it
    reports disarmed and on the ground. The item that it flew towards is therefore kept, and replaced by the first one only if that is
    reported for longer than `RESET_S`.
    """

    has_flown_list: bool = False
    _reached: int = -1
    _bound_for: int = -1  # counted as the vehicle does
    _back_at_s: float | None = None  # when its list was reset to the beginning

    def take_up(self, *, was_in_mission: bool, mission_item: int | None) -> None:
        """Adopt what the previous gateway observed of a vehicle in the air, which may have landed since."""
        if was_in_mission:
            self.has_flown_list = True
            if self._bound_for < 0 and mission_item is not None:
                self._bound_for = mission_item

    def forget(self) -> None:
        """Reset after another list was uploaded: none of it is flown yet."""
        self.has_flown_list, self._reached, self._bound_for, self._back_at_s = False, -1, -1, None

    def check(self, state: VehicleState, kind: str) -> list[FlownMissionItem]:
        """Return the progress that a message of this type shows."""
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
