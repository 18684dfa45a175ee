"""Whether the loops of this process go round: each says so as it does, and one that has not for too long hangs."""

import time

_due_s: dict[str, float] = {}


def beat(loop: str, *, within_s: float) -> None:
    """The loop goes round, and will again within this time, whatever is away."""
    _due_s[loop] = time.monotonic() + within_s


def rest(loop: str) -> None:
    """The loop has ended as it should."""
    _due_s.pop(loop, None)


def hanging() -> list[str]:
    """Loops that are overdue."""
    now_s = time.monotonic()
    return sorted(loop for loop, due_s in _due_s.items() if due_s < now_s)
