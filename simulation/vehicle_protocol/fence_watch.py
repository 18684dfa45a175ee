"""What a vehicle does at its fence: told once each time it comes out of it."""

from dataclasses import dataclass, field
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from simulation.flight.states import Mode
from simulation.vehicle_protocol.fence import Fence
from simulation.vehicle_protocol.flavour import Flavour
from simulation.vehicle_protocol.parameters import Parameters

INTERVAL_S = 0.4  # of simulated time


class FenceAction(StrEnum):
    NONE = "none"
    WARN = "warn"
    HOLD = "hold"
    LAND = "land"
    RETURN = "return"


MODES = {FenceAction.HOLD: Mode.HOLD, FenceAction.LAND: Mode.LAND, FenceAction.RETURN: Mode.RETURN}
PX4_ACTIONS = {0: FenceAction.NONE, 1: FenceAction.WARN, 2: FenceAction.HOLD, 3: FenceAction.RETURN}
COPTER_ACTIONS = {
    0: FenceAction.WARN, 1: FenceAction.RETURN, 2: FenceAction.LAND, 3: FenceAction.RETURN, 4: FenceAction.HOLD,
}  # fmt: skip


@dataclass
class FenceWatch:
    """Asked with where the UAV flies; tells the action to be taken now."""

    flavour: Flavour
    parameters: Parameters
    fence: Fence = field(default_factory=Fence)
    is_broken: bool = False
    _next_s: float = 0.0

    def look(self, place: LonLat, at_s: float, *, is_in_air: bool) -> FenceAction:
        """at_s: simulated seconds."""
        if at_s < self._next_s:
            return FenceAction.NONE
        self._next_s = at_s + INTERVAL_S
        was_broken = self.is_broken
        self.is_broken = is_in_air and self.is_enabled and self.fence.is_broken_at(place)
        return self.action if self.is_broken and not was_broken else FenceAction.NONE

    def switch(self, wanted: int | None) -> int:
        """As DO_FENCE_ENABLE asks: a MAV_RESULT. PX4 knows no such command."""
        if self.flavour is Flavour.PX4:
            return int(mavlink.MAV_RESULT_UNSUPPORTED)
        if wanted not in (0, 1):
            return int(mavlink.MAV_RESULT_DENIED)
        self.parameters.show("FENCE_ENABLE", float(wanted))
        return int(mavlink.MAV_RESULT_ACCEPTED)

    @property
    def is_enabled(self) -> bool:
        if self.flavour is Flavour.PX4:
            return self.action is not FenceAction.NONE
        return bool(self.parameters["FENCE_ENABLE"])

    @property
    def action(self) -> FenceAction:
        if self.flavour is Flavour.PX4:
            return PX4_ACTIONS.get(int(self.parameters["GF_ACTION"]), FenceAction.WARN)
        return COPTER_ACTIONS.get(int(self.parameters["FENCE_ACTION"]), FenceAction.WARN)
