"""What a detector detects, and the acts that an operator can answer it with."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

ACTS = "acts"  # in the details of an alert whose acts depend on more than its code
HOLD, RETURN, LAND = "hold", "return", "land"  # commands
TAKE_OVER = "take-over"  # not a command: a pilot on site takes over
KINDS = (HOLD, RETURN, LAND, TAKE_OVER)
_OF_CODE = {"no-progress": HOLD, "off-route": HOLD, "zone": HOLD, "weather": RETURN, "height-off": HOLD}
CRITICAL, WARNING, ADVISORY = "critical", "warning", "advisory"
RANK = {ADVISORY: 1, WARNING: 2, CRITICAL: 3}


def acts(*kinds: str, uav_id: int) -> list[dict[str, Any]]:
    """Return acts in the form of an alert's details."""
    return [{"kind": kind, "uav": uav_id} for kind in kinds]


def acts_of(code: str, uav_id: int | None, details: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the acts of an alert, the best first; empty if no command answers it."""
    if ACTS in details:
        return [act | {"kind": HOLD} if act["kind"] == "pause" else act for act in details[ACTS]]  # from before Pause became Hold
    return acts(_OF_CODE[code], uav_id=uav_id) if uav_id is not None and code in _OF_CODE else []


@dataclass(frozen=True, slots=True)
class Detection:
    """A present cause. `code` and `subject` identify it: it has one alert while it lasts.

    `message` is an English template; `values` are inserted when shown, in the reader's language. `details` are values for programs.
    `severity` compares detections of one cause and level: more is worse.
    """

    code: str
    level: str
    message: str
    values: dict[str, Any] = field(default_factory=dict)
    subject: str = ""
    details: dict[str, Any] = field(default_factory=dict)
    severity: float = 0.0
