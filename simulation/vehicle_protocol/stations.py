"""Who talks to a vehicle, and what goes to whom."""

from dataclasses import dataclass
from typing import Any

from mavlink.frames import Message

AUTOPILOT = 1  # MAV_COMP_ID_AUTOPILOT1, the one component there is


@dataclass(frozen=True, slots=True)
class Station:
    """A component of another system, and the link by which it was heard: two stations may bear the same ids."""

    system: int
    component: int
    link: int = 0

    @property
    def ends(self) -> tuple[int, int]:
        """As messages name whom they are for."""
        return (self.system, self.component)


@dataclass(frozen=True, slots=True)
class Outgoing:
    """`to` is None for what everybody is told."""

    message: Message
    to: Station | None = None


def is_for(message: Any, system: int) -> bool:
    """Whether a vehicle with this system id has to do with it: 0 names all, a message without a target is for all."""
    return getattr(message, "target_system", 0) in (0, system) and getattr(message, "target_component", 0) in (0, AUTOPILOT)
