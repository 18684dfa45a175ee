"""What a detector sees."""

from dataclasses import dataclass, field
from typing import Any

CRITICAL, WARNING, ADVISORY = "critical", "warning", "advisory"
RANK = {ADVISORY: 1, WARNING: 2, CRITICAL: 3}


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
