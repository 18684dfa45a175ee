"""Sources of the event log: what happened to missions, as each app stores it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any
from uuid import UUID

from django.utils.module_loading import import_string


class EventKind(StrEnum):
    MISSION_APPROVED = "mission-approved"
    APPROVAL_REVOKED = "approval-revoked"
    MISSION_STARTED = "mission-started"
    MISSION_ABORTED = "mission-aborted"
    MISSION_CLOSED = "mission-closed"
    MISSION_ENDED = "mission-ended"
    STARTS_BEGUN = "starts-begun"
    STARTS_STOPPED = "starts-stopped"
    TAKE_OFF = "take-off"
    LANDING = "landing"
    CRASH = "crash"
    DROP_OUT = "drop-out"
    COMMAND_GIVEN = "command-given"
    COMMAND_SENT = "command-sent"
    COMMAND_ACKNOWLEDGED = "command-acknowledged"
    COMMAND_DONE = "command-done"
    COMMAND_FAILED = "command-failed"
    COMMAND_EXPIRED = "command-expired"
    ALERT_OPENED = "alert-opened"
    ALERT_RAISED = "alert-raised"
    ALERT_ACKNOWLEDGED = "alert-acknowledged"
    ALERT_RESOLVED = "alert-resolved"
    TARGET_STARTED = "target-started"
    TARGET_COMPLETE = "target-complete"
    TARGET_SKIPPED = "target-skipped"
    TARGET_FAILED = "target-failed"
    OFFER_MADE = "offer-made"
    OFFER_ACCEPTED = "offer-accepted"
    OFFER_DECLINED = "offer-declined"
    OFFER_EXPIRED = "offer-expired"
    OFFER_IMPOSSIBLE = "offer-impossible"
    SIMULATION_STARTED = "simulation-started"
    SIMULATION_CHANGED = "simulation-changed"
    SIMULATION_ENDED = "simulation-ended"
    FAULT_INJECTED = "fault-injected"


@dataclass(frozen=True, slots=True)
class EventPlace:
    """Place of a stored event: its source, the row, and the step of that row. Places are ordered by `at` and `key`, which are unique."""

    source: str
    row: str
    step: str
    at: datetime
    mission_id: UUID

    @property
    def key(self) -> str:
        return f"{self.source}:{self.row}:{self.step}"


@dataclass(frozen=True, slots=True)
class MissionEvent:
    """One event. `message` is English; pages build their own text from `values`. `level` is an alert's: critical, warning, advisory."""

    kind: EventKind
    message: str
    uav_id: int | None = None
    uav_name: str = ""
    is_simulated: bool = False
    who: str | None = None
    level: str | None = None
    values: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class EventSource:
    """Events of one kind of rows.

    `statement` selects row (text), step (text), at and mission_id for the missions `%(missions)s` (uuid[]); `%(names)s` are the same as
    text. `read` returns the events at places of this source, with one query for all of them; rows deleted in the meantime are omitted.
    """

    name: str
    statement: str
    read: Callable[[Sequence[EventPlace]], Mapping[EventPlace, MissionEvent]]


_registered: list[str] = []


def register_sources(name: str) -> None:
    """Register a sequence of `EventSource` by its dotted name. It is imported when events are first read."""
    if name not in _registered:
        _registered.append(name)


def registered_sources() -> list[EventSource]:
    return [source for name in _registered for source in import_string(name)]
