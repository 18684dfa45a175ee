"""Status texts of a vehicle (STATUSTEXT) that alerts evaluate or quote."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

KEPT_S = 600.0  # age up to which a battery text counts without another battery report
BEFORE_S, AFTER_S = 15.0, 10.0  # around a change of mode: texts that may explain it
MAX_QUOTED = 3
_BATTERY = re.compile(r"\bbatt", re.IGNORECASE)
_WORSE = re.compile(r"critical|emergency|dangerous|fail", re.IGNORECASE)
_LOW = re.compile(r"\blow\b|empty|unhealthy", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class AutopilotText:
    """A text of severity warning or worse, by the server's clock."""

    at_s: float
    text: str


def quoted(status_texts: Sequence[AutopilotText], from_s: float, to_s: float) -> str:
    """Return the last few distinct texts between two moments, the newest last; empty if none."""
    texts = dict.fromkeys(text.text for text in status_texts if from_s <= text.at_s <= to_s)
    return "; ".join(list(texts)[-MAX_QUOTED:])


def newest_battery_text(status_texts: Sequence[AutopilotText], now_s: float) -> AutopilotText | None:
    """Return the newest text that reports the battery low or worse, else None."""
    about = [text for text in status_texts if now_s - text.at_s <= KEPT_S and _BATTERY.search(text.text)]
    return next((text for text in reversed(about) if _LOW.search(text.text) or is_worse(text)), None)


def is_worse(text: AutopilotText) -> bool:
    """Return whether the text reports worse than low."""
    return _WORSE.search(text.text) is not None
