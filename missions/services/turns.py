"""Threads of one process make their small plans one after another.

They share one interpreter, and compiled parts let go of it for microseconds at a time. Threads that plan at once take it from each other
each time: a plan then costs half as much again as alone, just when there is most to do.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock

PATIENCE_S = 0.25  # a turn is a courtesy: who waits longer, as behind a database that hangs, goes on without
_turn = RLock()


@contextmanager
def in_turn() -> Iterator[bool]:
    """Whether the turn was had; nested ones are the same turn."""
    has_turn = _turn.acquire(timeout=PATIENCE_S)
    try:
        yield has_turn
    finally:
        if has_turn:
            _turn.release()
