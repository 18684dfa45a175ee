"""A watch without rows: looks once a second, and keeps what is open."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from telemetry.alerting.detector_input import DetectorInput, WatchedUav
from telemetry.alerting.detector_state import DetectorState
from telemetry.alerting.detectors import DETECTORS
from telemetry.alerting.limits import AlertLimits
from telemetry.alerting.state_machine import RANK, Closed, changes
from telemetry.alerting.surroundings import OnboardState


@dataclass
class Event:
    """An alert that opened, rose or closed."""

    at_s: float
    what: str
    code: str
    subject: str
    level: str


@dataclass
class Watch:
    """Of one UAV."""

    limits: AlertLimits = field(default_factory=AlertLimits)
    detector_state: DetectorState = field(default_factory=DetectorState)
    open_levels: dict[tuple[str, str], str] = field(default_factory=dict)
    events: list[Event] = field(default_factory=list)

    def inputs(self, now_s: float, uav: WatchedUav, **around) -> DetectorInput:
        model = around.get("model")
        self.detector_state.take(uav.newest, None if model is None else model.line)
        around.setdefault("held", OnboardState(approval_id=uav.approval_id, is_approved=True))
        return DetectorInput(
            now_s=now_s, uav=uav, limits=self.limits, detector_state=self.detector_state, open_levels=dict(self.open_levels), **around
        )

    def evaluate(self, inputs: DetectorInput, detectors=DETECTORS) -> None:
        for change in changes(inputs, detectors):
            if isinstance(change, Closed):
                level = self.open_levels.pop((change.code, change.subject))
                self.events.append(Event(inputs.now_s, "closed", change.code, change.subject, level))
                continue
            detection = change.detection
            key = detection.code, detection.subject
            before = self.open_levels.get(key)
            if before is None or RANK[detection.level] > RANK[before]:
                self.events.append(Event(inputs.now_s, "opened" if before is None else "rose", *key, detection.level))
            self.open_levels[key] = detection.level
            detection.message % detection.values  # every value is there

    def opened(self) -> list[Event]:
        return [event for event in self.events if event.what == "opened"]

    def reached(self, code: str, levels: Iterable[str]) -> float | None:
        """When an alert of the code was first open at one of the levels."""
        return next((event.at_s for event in self.events if event.what != "closed" and event.code == code and event.level in levels), None)
