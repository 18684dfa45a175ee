"""What makes it doubtful that a vehicle still holds what was read back from it: it booted anew, or somebody else changes its lists."""

import math
from dataclasses import dataclass, field

from mavlink.frames import Message
from mavlink.vehicle_state import VehicleState
from telemetry.gateway.options import OWN_COMPONENT, OWN_SYSTEM
from telemetry.services.loads import Doubt

TO_WHO_SENDS_A_LIST = frozenset({"MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"})  # reading one draws none of these
QUIET_S = 10.0  # so long after a transfer of ours its answers may still come


@dataclass
class ListWatch:
    """Of one vehicle. Times are monotonic seconds; `found` is for whoever tells it on to take out."""

    found: list[tuple[Doubt, float]] = field(default_factory=list)
    _transferred_s: float = -math.inf
    _total: int | None = None
    _boot: str | None = None

    def note_sent(self, message: Message, now_s: float) -> None:
        """By us."""
        if message.get_type().startswith("MISSION_"):
            self._transferred_s = now_s

    def look(self, message: Message, state: VehicleState, now_s: float) -> None:
        """After the vehicle's state has taken the message."""
        is_ours = now_s - self._transferred_s <= QUIET_S
        if message.get_type() in TO_WHO_SENDS_A_LIST and not (is_ours and _is_to_us(message)):
            self._doubt(Doubt.OTHER_STATION, now_s)
        if state.mission_total is not None and state.mission_total != self._total:
            if self._total is not None and not is_ours:
                self._doubt(Doubt.OTHER_LENGTH, now_s)
            self._total = state.mission_total

    def look_at_boot(self, boot: str, now_s: float) -> None:
        """boot: what names the present run of the vehicle's clock."""
        if self._boot not in (None, boot):
            self._doubt(Doubt.REBOOTED, now_s)
        self._boot = boot

    def _doubt(self, doubt: Doubt, now_s: float) -> None:
        self.found = [*(one for one in self.found if one[0] is not doubt), (doubt, now_s)]


def _is_to_us(message: Message) -> bool:
    return message.target_system in (0, OWN_SYSTEM) and message.target_component in (0, OWN_COMPONENT)
