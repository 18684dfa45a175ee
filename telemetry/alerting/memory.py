"""What is remembered of a UAV from one look to the next. It may be lost: then alerts come a little later."""

from collections import deque
from dataclasses import dataclass, field
from statistics import median

from telemetry.alerting.watched import Report

INTERVALS_KEPT = 5


@dataclass
class Cause:
    """Since when something is found at a level or above, and since when it is found no more."""

    since_s: dict[str, float] = field(default_factory=dict)
    gone_s: float | None = None


@dataclass
class Memory:
    """Of one UAV. `before` is the report before the newest one."""

    newest: Report | None = None
    before: Report | None = None
    causes: dict[tuple[str, str], Cause] = field(default_factory=dict)
    _intervals_s: deque[float] = field(default_factory=lambda: deque(maxlen=INTERVALS_KEPT))

    def take(self, report: Report | None) -> bool:
        """Whether it is a new one."""
        if report is None or (self.newest is not None and report.measured_s <= self.newest.measured_s):
            return False
        if self.newest is not None:
            self._intervals_s.append(report.received_s - self.newest.received_s)
        self.before, self.newest = self.newest, report
        return True

    @property
    def usual_interval_s(self) -> float:
        """Between reports, as the last few came; 0 as long as that is not known."""
        return median(self._intervals_s) if self._intervals_s else 0.0
