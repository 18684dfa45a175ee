"""As which autopilot a simulated UAV presents itself."""

from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink


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
