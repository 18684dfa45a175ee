"""What one vehicle is asked for by itself: its messages where they do not come, and what is told once where it was not told."""

import math
from dataclasses import dataclass, field

from missions.mavlink.frames import Message
from telemetry.gateway import greeting
from telemetry.gateway.own_return import OwnReturn
from telemetry.ground_station.flavour import Flavour
from telemetry.ground_station.limits import PARAMETERS
from telemetry.ground_station.vehicle_state import VehicleState

ASK_AGAIN_S = 5.0  # for positions that do not come; for what is told once after ever longer
ASK_SELDOM_S = 60.0
LIMIT_QUESTIONS = 3  # a vehicle that has no such parameters says nothing


@dataclass
class Questions:
    """Times are monotonic seconds."""

    limits_left: int = LIMIT_QUESTIONS
    own_return: OwnReturn = field(default_factory=OwnReturn)
    _asked_s: float = -math.inf
    _questioned_s: float = -math.inf
    _question_again_s: float = ASK_AGAIN_S

    def due(self, state: VehicleState, now_s: float, *, has_position: bool) -> list[Message]:
        """Of a vehicle that is heard; `has_position`: it has told where it is a moment ago."""
        if state.flavour is None:
            return []
        wanted = []
        if not has_position and now_s - self._asked_s >= ASK_AGAIN_S:
            self._asked_s = now_s
            wanted += greeting.requests(state.system, state.flavour)
        wanted += self.own_return.questions(state, now_s)
        once = self._once(state)
        if once and now_s - self._questioned_s >= self._question_again_s:
            self._questioned_s = now_s
            self._question_again_s = min(2 * self._question_again_s, ASK_SELDOM_S)
            self.limits_left -= self.may_ask_limits(state)
            wanted += once
        return wanted

    def may_ask_limits(self, state: VehicleState) -> bool:
        return state.flavour is Flavour.PX4 and self.limits_left > 0 and any(name not in state.parameters for name in PARAMETERS)

    def _once(self, state: VehicleState) -> list[Message]:
        is_told = state.firmware is not None and state.home is not None
        limits = greeting.limit_questions(state.system) if self.may_ask_limits(state) else []
        return [*([] if is_told else greeting.questions(state.system)), *limits]
