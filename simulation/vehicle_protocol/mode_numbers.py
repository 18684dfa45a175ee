"""The modes as heartbeats bear them.

Sources: PX4's px4_custom_mode.h (main mode and sub mode), ArduCopter's mode.h.
"""

from dataclasses import dataclass
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from simulation.flight.states import Mode


class Flavour(StrEnum):
    """PX4 flies item 0 of its list; on ArduPilot item 0 is home, and is not flown."""

    PX4 = "px4"
    ARDUPILOT = "ardupilot"

    @property
    def autopilot(self) -> int:
        """MAV_AUTOPILOT."""
        return int(mavlink.MAV_AUTOPILOT_PX4 if self is Flavour.PX4 else mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA)

    @property
    def first_item(self) -> int:
        """The number of the first item that is flown."""
        return 0 if self is Flavour.PX4 else 1


PX4_AUTO, PX4_POSITION = 4, 3
PX4_SUB_MODES = {Mode.TAKE_OFF: 2, Mode.HOLD: 3, Mode.GO_TO: 3, Mode.MISSION: 4, Mode.RETURN: 5, Mode.LAND: 6}
PX4_ORDERED = {2: Mode.TAKE_OFF, 3: Mode.HOLD, 4: Mode.MISSION, 5: Mode.RETURN, 6: Mode.LAND}

STABILIZE, AUTO, GUIDED, LOITER, BRAKE = 0, 3, 4, 5, 17
COPTER_MODES = {
    Mode.TAKE_OFF: GUIDED, Mode.HOLD: BRAKE, Mode.GO_TO: GUIDED, Mode.MISSION: AUTO, Mode.RETURN: 6, Mode.LAND: 9,
}  # fmt: skip
COPTER_ORDERED = {
    STABILIZE: Mode.HOLD, 2: Mode.HOLD, AUTO: Mode.MISSION, GUIDED: Mode.HOLD, LOITER: Mode.HOLD, 6: Mode.RETURN, 9: Mode.LAND,
    16: Mode.HOLD, BRAKE: Mode.HOLD,
}  # fmt: skip
COPTER_BY_HAND = frozenset({STABILIZE, 2})  # fall without a pilot: only on the ground
COPTER_NOT_ARMABLE = frozenset({AUTO, 6, 9, BRAKE})


def px4_number(main: int, sub: int = 0) -> int:
    return main << 16 | sub << 24


def usual_number(flavour: Flavour, mode: Mode) -> int:
    """The custom mode that shows a mode nobody asked for by a number."""
    return px4_number(PX4_AUTO, PX4_SUB_MODES[mode]) if flavour is Flavour.PX4 else COPTER_MODES[mode]


def ordered_mode(flavour: Flavour, number: int) -> Mode | None:
    """What a custom mode asks for; None for one that a simulated UAV does not fly, as nobody holds its sticks."""
    if flavour is Flavour.ARDUPILOT:
        return COPTER_ORDERED.get(number)
    main, sub = number >> 16 & 0xFF, number >> 24 & 0xFF
    if main == PX4_AUTO:
        return PX4_ORDERED.get(sub)
    return Mode.HOLD if main == PX4_POSITION else None


@dataclass
class ShownMode:
    """The number in the heartbeat: the one that was asked for, as long as the vehicle still does what it means."""

    flavour: Flavour
    asked: int

    @classmethod
    def at_start(cls, flavour: Flavour) -> "ShownMode":
        return cls(flavour, STABILIZE if flavour is Flavour.ARDUPILOT else usual_number(flavour, Mode.HOLD))

    def number(self, mode: Mode, *, is_in_air: bool) -> int:
        """ArduPilot stands in a mode from which it can be armed, as if its switch had been put back after the landing."""
        if ordered_mode(self.flavour, self.asked) is mode:
            return self.asked
        if self.flavour is Flavour.ARDUPILOT and mode is Mode.HOLD and not is_in_air:
            return LOITER
        return usual_number(self.flavour, mode)
