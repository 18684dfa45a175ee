"""Whether the loops of this process go round: each says so as it does, and one that has not for too long hangs."""

import time
from collections.abc import Callable

Excuse = Callable[[], bool]

_due_s: dict[str, tuple[float, Excuse | None]] = {}


def send_heartbeat(loop: str, *, within_s: float, excuse: Excuse | None = None) -> None:
    """The loop goes round, and will again within this time, whatever is away; or there is an excuse, which is asked for only then."""
    _due_s[loop] = time.monotonic() + within_s, excuse


def stop(loop: str) -> None:
    """The loop has ended as it should."""
    _due_s.pop(loop, None)


def hanging() -> list[str]:
    """Loops that are overdue without an excuse."""
    now_s = time.monotonic()
    return sorted(loop for loop, (due_s, excuse) in list(_due_s.items()) if due_s < now_s and not (excuse is not None and excuse()))
