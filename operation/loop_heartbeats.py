"""Heartbeats of this process's loops: a loop without one for too long counts as hanging."""

import time
from collections.abc import Callable

Excuse = Callable[[], bool]

_due_s: dict[str, tuple[float, Excuse | None]] = {}


def send_heartbeat(loop: str, *, within_s: float, excuse: Excuse | None = None) -> None:
    """Record that the loop runs and its next heartbeat is due within this time; `excuse` is checked only when it is overdue."""
    _due_s[loop] = time.monotonic() + within_s, excuse


def stop(loop: str) -> None:
    """Record that the loop has ended normally."""
    _due_s.pop(loop, None)


def hanging() -> list[str]:
    """Return the loops that are overdue without an excuse."""
    now_s = time.monotonic()
    return sorted(loop for loop, (due_s, excuse) in list(_due_s.items()) if due_s < now_s and not (excuse is not None and excuse()))
