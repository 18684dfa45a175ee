"""The type of a detector: a rule with its delays."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from telemetry.alerting.detection import Detection
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.limits import AlertLimits

POLL_INTERVAL_S = 1.0


def _none(_limits: AlertLimits, _interval_s: float) -> float:
    return 0.0


@dataclass(frozen=True, slots=True)
class Detector:
    """Finds the causes of one code.

    `detect` returns the present detections; None if it cannot decide, which leaves open alerts unchanged. A cause must last `raise_after_s`
    to open an alert and be gone for `clear_after_s` to close it. `reports` is the maximum number of reports needed to detect it. With
    `needs_flight`, nothing is found for a UAV that is not in flight. While an alert with a code in `suppressed_by` is open, this detector
    is skipped, as its detection would be a consequence. `own_delay_s` is the delay that its limits add, at an interval of reports [s].
    """

    code: str
    detect: Callable[[DetectorInput], Iterable[Detection] | None]
    raise_after_s: float
    clear_after_s: float
    reports: int = 1
    needs_flight: bool = True
    suppressed_by: tuple[str, ...] = ()
    own_delay_s: Callable[[AlertLimits, float], float] = _none

    def delay_s(self, limits: AlertLimits, report_interval_s: float = 1.0) -> float:
        """Return the maximum time from a fault to its open alert, at this interval of reports."""
        waits_s = self.own_delay_s(limits, report_interval_s) + self.raise_after_s
        return self.reports * report_interval_s + waits_s + POLL_INTERVAL_S
