"""What a vehicle says in words (STATUSTEXT), as far as alerts rest on it or quote it."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

KEPT_S = 600.0  # for which a word of the battery counts where nothing else speaks of it
BEFORE_S, AFTER_S = 15.0, 10.0  # of a change of mode: words that may give its reason
MAX_QUOTED = 3
_BATTERY = re.compile(r"\bbatt", re.IGNORECASE)
_WORSE = re.compile(r"critical|emergency|dangerous|fail", re.IGNORECASE)
_LOW = re.compile(r"\blow\b|empty|unhealthy", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class AutopilotText:
    """A warning or worse, by the server's clock."""

    at_s: float
    text: str


def quoted(status_texts: Sequence[AutopilotText], from_s: float, to_s: float) -> str:
    """The last few that were received between two moments, the newest last; empty for none."""
    texts = dict.fromkeys(text.text for text in status_texts if from_s <= text.at_s <= to_s)
    return "; ".join(list(texts)[-MAX_QUOTED:])


def newest_battery_text(status_texts: Sequence[AutopilotText], now_s: float) -> AutopilotText | None:
    """The newest that says that the battery is low or worse."""
    about = [text for text in status_texts if now_s - text.at_s <= KEPT_S and _BATTERY.search(text.text)]
    return next((text for text in reversed(about) if _LOW.search(text.text) or is_worse(text)), None)


def is_worse(text: AutopilotText) -> bool:
    """Than low."""
    return _WORSE.search(text.text) is not None
