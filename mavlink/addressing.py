"""System and component ids of the vehicle and of the ground station that exchange messages."""

from dataclasses import dataclass
from typing import Any, TypeAlias

from pymavlink.dialects.v20 import ardupilotmega as mavlink

Message: TypeAlias = Any  # a pymavlink message, which is untyped
Messages: TypeAlias = list[Any]

AUTOPILOT: int = mavlink.MAV_COMP_ID_AUTOPILOT1
GROUND_STATION: int = mavlink.MAV_COMP_ID_MISSIONPLANNER


@dataclass(frozen=True)
class Addressing:
    """The target system and component, and those of this ground station."""

    system: int
    component: int = AUTOPILOT
    own_system: int = 255
    own_component: int = GROUND_STATION

    def has_sent(self, message: Message) -> bool:
        """Return whether the vehicle sent the message to this ground station or to all."""
        if message.get_srcSystem() != self.system or message.get_srcComponent() != self.component:
            return False
        return getattr(message, "target_system", 0) in (0, self.own_system) and (
            getattr(message, "target_component", 0) in (0, self.own_component)
        )
