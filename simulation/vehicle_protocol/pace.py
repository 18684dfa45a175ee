"""How simulated time follows the clock on the wall: at a pace, step by step, and never in a spiral of ever later steps."""

import math
from dataclasses import dataclass

RESYNC_AFTER_S = 1.0  # of wall time: what is further behind is given up


@dataclass
class Pace:
    """`speed` simulated seconds a second of the wall. Times are monotonic wall seconds.

    A step is late when it begins more than a whole step after it was due. Behind by more than RESYNC_AFTER_S the rest is not made up for:
    `slipped_s` counts what simulated time has lost so. `limit` is a speed that holds while it is below the wanted one.
    """

    step_s: float
    speed: float
    next_s: float
    steps: int = 0
    late_steps: int = 0
    latest_s: float = 0.0
    slipped_s: float = 0.0
    limit: float = math.inf

    @property
    def interval_s(self) -> float:
        """Between two steps, on the wall."""
        return self.step_s / min(self.speed, self.limit)

    def begin(self, now_s: float) -> bool:
        """Whether a step is due; it counts as taken then."""
        behind_s = now_s - self.next_s
        if behind_s < 0:
            return False
        self.steps += 1
        self.late_steps += behind_s > self.interval_s
        self.latest_s = max(self.latest_s, behind_s)
        self.next_s += self.interval_s
        if behind_s > RESYNC_AFTER_S:
            self.slipped_s += behind_s
            self.next_s = now_s + self.interval_s
        return True

    def change(self, speed: float, now_s: float) -> None:
        """From now on."""
        self.speed = speed
        self.next_s = now_s + self.interval_s
