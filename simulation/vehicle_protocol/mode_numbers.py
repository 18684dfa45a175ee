"""Mode numbers in heartbeats.

Sources: PX4's px4_custom_mode.h (main mode and sub mode), ArduCopter's mode.h.
"""

from dataclasses import dataclass
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from simulation.flight.states import FlightMode


class SimulatedAutopilot(StrEnum):
    """PX4 flies item 0 of its list; on ArduPilot item 0 is home, and not flown."""

    PX4 = "px4"
    ARDUPILOT = "ardupilot"

    @property
    def autopilot(self) -> int:
        """Return the MAV_AUTOPILOT."""
        return int(mavlink.MAV_AUTOPILOT_PX4 if self is SimulatedAutopilot.PX4 else mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA)

    @property
    def first_item(self) -> int:
        """Return the number of the first flown item."""
        return 0 if self is SimulatedAutopilot.PX4 else 1


PX4_AUTO, PX4_POSITION = 4, 3
PX4_SUB_MODES = {
    FlightMode.TAKE_OFF: 2,
    FlightMode.HOLD: 3,
    FlightMode.GO_TO: 3,
    FlightMode.MISSION: 4,
    FlightMode.RETURN: 5,
    FlightMode.LAND: 6,
}
PX4_ORDERED = {2: FlightMode.TAKE_OFF, 3: FlightMode.HOLD, 4: FlightMode.MISSION, 5: FlightMode.RETURN, 6: FlightMode.LAND}

STABILIZE, AUTO, GUIDED, LOITER, BRAKE = 0, 3, 4, 5, 17
COPTER_MODES = {
    FlightMode.TAKE_OFF: GUIDED, FlightMode.HOLD: BRAKE, FlightMode.GO_TO: GUIDED, FlightMode.MISSION: AUTO,
    FlightMode.RETURN: 6, FlightMode.LAND: 9,
}  # fmt: skip
COPTER_ORDERED = {
    STABILIZE: FlightMode.HOLD, 2: FlightMode.HOLD, AUTO: FlightMode.MISSION, GUIDED: FlightMode.HOLD, LOITER: FlightMode.HOLD,
    6: FlightMode.RETURN, 9: FlightMode.LAND,
    16: FlightMode.HOLD, BRAKE: FlightMode.HOLD,
}  # fmt: skip
COPTER_BY_HAND = frozenset({STABILIZE, 2})  # these fall without a pilot: only on the ground
COPTER_NOT_ARMABLE = frozenset({AUTO, 6, 9, BRAKE})


def px4_number(main: int, sub: int = 0) -> int:
    return main << 16 | sub << 24


def usual_number(autopilot_type: SimulatedAutopilot, mode: FlightMode) -> int:
    """Return the custom mode number of a mode that was not requested by number."""
    return px4_number(PX4_AUTO, PX4_SUB_MODES[mode]) if autopilot_type is SimulatedAutopilot.PX4 else COPTER_MODES[mode]


def ordered_mode(autopilot_type: SimulatedAutopilot, number: int) -> FlightMode | None:
    """Return the mode of a custom mode number; None for modes that need a pilot's sticks."""
    if autopilot_type is SimulatedAutopilot.ARDUPILOT:
        return COPTER_ORDERED.get(number)
    main, sub = number >> 16 & 0xFF, number >> 24 & 0xFF
    if main == PX4_AUTO:
        return PX4_ORDERED.get(sub)
    return FlightMode.HOLD if main == PX4_POSITION else None


@dataclass
class ShownMode:
    """The number in the heartbeat: the requested one while the vehicle is in that mode."""

    autopilot_type: SimulatedAutopilot
    asked: int

    @classmethod
    def at_start(cls, autopilot_type: SimulatedAutopilot) -> "ShownMode":
        return cls(
            autopilot_type, STABILIZE if autopilot_type is SimulatedAutopilot.ARDUPILOT else usual_number(autopilot_type, FlightMode.HOLD)
        )

    def number(self, mode: FlightMode, *, is_in_air: bool) -> int:
        """Return the number. On the ground ArduPilot shows a mode that permits arming, as if its switch were reset after the landing."""
        if ordered_mode(self.autopilot_type, self.asked) is mode:
            return self.asked
        if self.autopilot_type is SimulatedAutopilot.ARDUPILOT and mode is FlightMode.HOLD and not is_in_air:
            return LOITER
        return usual_number(self.autopilot_type, mode)
