"""Whom messages are addressed to and who sends them: system and component of the vehicle and of the ground station."""

from dataclasses import dataclass
from typing import Any, TypeAlias

from pymavlink.dialects.v20 import ardupilotmega as mavlink

Message: TypeAlias = Any  # a message of pymavlink's, which has no types
Messages: TypeAlias = list[Any]

AUTOPILOT: int = mavlink.MAV_COMP_ID_AUTOPILOT1
GROUND_STATION: int = mavlink.MAV_COMP_ID_MISSIONPLANNER


@dataclass(frozen=True)
class Addressing:
    """Target system and component, and our own."""

    system: int
    component: int = AUTOPILOT
    own_system: int = 255
    own_component: int = GROUND_STATION

    def has_sent(self, message: Message) -> bool:
        """From the vehicle, to us: what it says to other ground stations is not ours."""
        if message.get_srcSystem() != self.system or message.get_srcComponent() != self.component:
            return False
        return getattr(message, "target_system", 0) in (0, self.own_system) and (
            getattr(message, "target_component", 0) in (0, self.own_component)
        )
