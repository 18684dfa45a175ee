"""What a detector is: a rule, and how patient it is."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.finding import Finding
from telemetry.alerting.limits import AlertLimits

POLL_INTERVAL_S = 1.0


def _none(_limits: AlertLimits, _interval_s: float) -> float:
    return 0.0


@dataclass(frozen=True, slots=True)
class Detector:
    """Finds the causes of one code.

    `detect` returns what is there now; None: that cannot be told now, and what was open stays open. A cause must last for `raise_after_s`
    before there is an alert, and be gone for `clear_after_s` before it is over. `reports` is how many reports it takes to see it at most.
    Of a UAV that is not `in_flight` nothing is found where it `needs_flight`. `suppressed_by` names what this would be a consequence of: as
    long as an alert of one of these codes is open, nothing is said of this. `own_delay_s` is what it takes by its limits, at an interval
    of reports [s].
    """

    code: str
    detect: Callable[[DetectorInput], Iterable[Finding] | None]
    raise_after_s: float
    clear_after_s: float
    reports: int = 1
    needs_flight: bool = True
    suppressed_by: tuple[str, ...] = ()
    own_delay_s: Callable[[AlertLimits, float], float] = _none

    def delay_s(self, limits: AlertLimits, report_interval_s: float = 1.0) -> float:
        """From a fault until its alert is open, at most, where reports come so often."""
        waits_s = self.own_delay_s(limits, report_interval_s) + self.raise_after_s
        return self.reports * report_interval_s + waits_s + POLL_INTERVAL_S
