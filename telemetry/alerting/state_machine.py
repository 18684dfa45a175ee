"""Alert state machine: converts detections to changes of alerts, with delays to open and close and one alert per cause."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from telemetry.alerting.detection import RANK, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput, Key
from telemetry.alerting.detector_state import AlertCause
from telemetry.alerting.detectors import down

CLEARED, LANDED = "cleared", "landed"  # reasons why an alert is closed


@dataclass(frozen=True, slots=True)
class Opened:
    """An alert to open, or an open one with a higher level or newer values. `is_held`: it keeps a level from when its cause was worse."""

    detection: Detection
    is_held: bool = False


@dataclass(frozen=True, slots=True)
class Closed:
    code: str
    subject: str
    reason: str


Change = Opened | Closed


def changes(inputs: DetectorInput, detectors: Sequence[Detector]) -> list[Change]:
    """Return the changes of alerts at this poll. An open alert that continues at the same level is Opened again with its newest values.

    The level of an alert only rises, so that an operator sees what was critical. No alert of a UAV that is down off plan closes. Updates
    the detector state.
    """
    found: list[Change] = []
    open_codes = {code for code, _ in inputs.open_levels}
    is_down_away = not inputs.is_in_flight and down.is_down_away(inputs)
    for detector in detectors:
        if open_codes.intersection(detector.suppressed_by):
            continue
        is_over = detector.needs_flight and not inputs.is_in_flight
        if is_over and is_down_away:
            continue
        detections = () if is_over else detector.detect(inputs)
        if detections is None:
            continue
        of_detector = _changes_of(detector, inputs, detections, LANDED if is_over else CLEARED)
        open_codes |= {change.detection.code for change in of_detector if isinstance(change, Opened)}
        found += of_detector
    return found


def _changes_of(detector: Detector, inputs: DetectorInput, detections: Iterable[Detection], over: str) -> list[Change]:
    """over: the reason to close alerts whose cause is gone."""
    causes, now_s = inputs.detector_state.causes, inputs.now_s
    by_key: dict[Key, Detection] = {(detection.code, detection.subject): detection for detection in detections}
    found: list[Change] = []
    for key, detection in by_key.items():
        level = _lasting_level(causes.setdefault(key, AlertCause()), detection.level, now_s, detector.raise_after_s)
        is_open = inputs.open_levels.get(key)
        if is_open is not None or level is not None:
            highest = max((entry for entry in (is_open, level) if entry is not None), key=RANK.__getitem__)
            is_held = RANK[detection.level] < RANK[highest]
            found.append(Opened(detection if detection.level == highest else replace(detection, level=highest), is_held))
    for key in {*causes, *inputs.open_levels}:
        if key[0] != detector.code or key in by_key:
            continue
        cause = causes.setdefault(key, AlertCause())
        cause.since_s.clear()
        cause.gone_s = now_s if cause.gone_s is None else cause.gone_s
        if key not in inputs.open_levels:
            del causes[key]
        elif over == LANDED or now_s - cause.gone_s >= detector.clear_after_s:
            del causes[key]
            found.append(Closed(*key, over))
    return found


def _lasting_level(cause: AlertCause, level: str, now_s: float, raise_after_s: float) -> str | None:
    """Return the highest level found continuously for long enough; None if there is none."""
    cause.gone_s = None
    for name, rank in RANK.items():
        if rank <= RANK[level]:
            cause.since_s.setdefault(name, now_s)
        else:
            cause.since_s.pop(name, None)
    lasting = [name for name, since_s in cause.since_s.items() if now_s - since_s >= raise_after_s]
    return max(lasting, key=RANK.__getitem__) if lasting else None
