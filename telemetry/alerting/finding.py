"""What a detector finds, and the acts by which an operator would answer it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

ACTS = "acts"  # in the details of an alert whose acts depend on more than its code
HOLD, RETURN, LAND = "hold", "return", "land"  # commands
TAKE_OVER = "take-over"  # no command: a pilot on site flies it
KINDS = (HOLD, RETURN, LAND, TAKE_OVER)
_OF_CODE = {"no-progress": HOLD, "off-route": HOLD, "zone": HOLD, "weather": RETURN, "height-off": HOLD}
CRITICAL, WARNING, ADVISORY = "critical", "warning", "advisory"
RANK = {ADVISORY: 1, WARNING: 2, CRITICAL: 3}


def acts(*kinds: str, uav_id: int) -> list[dict[str, Any]]:
    """Return acts as alerts have them in their details."""
    return [{"kind": kind, "uav": uav_id} for kind in kinds]


def acts_of(code: str, uav_id: int | None, details: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the acts of an alert, the best first; empty for one that is answered by no command."""
    if ACTS in details:
        return [act | {"kind": HOLD} if act["kind"] == "pause" else act for act in details[ACTS]]  # of before there was one Hold
    return acts(_OF_CODE[code], uav_id=uav_id) if uav_id is not None and code in _OF_CODE else []


@dataclass(frozen=True, slots=True)
class Finding:
    """A cause that is there now. `code` and `subject` name it: while it lasts there is one alert of it.

    `message` is an English template; `values` are put into it when it is shown, in the reader's language. `details` are figures for
    programs. `severity` compares figures of one cause at one level: more is worse.
    """

    code: str
    level: str
    message: str
    values: dict[str, Any] = field(default_factory=dict)
    subject: str = ""
    details: dict[str, Any] = field(default_factory=dict)
    severity: float = 0.0
