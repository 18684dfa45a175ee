"""Threads of one process make their small plans one after another; while one waits for the database, another goes on.

They share one interpreter, and compiled parts let go of it for microseconds at a time. Threads that plan at once take it from each other
each time: a plan then costs half as much again as alone, just when there is most to do.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock, local
from typing import TypeVar

TIMEOUT_S = 0.25  # a turn is a courtesy: who waits longer, as behind a plan of many targets, goes on without
_Found = TypeVar("_Found")
_turn = Lock()
_mine = local()  # of each thread: `has_turn`


@contextmanager
def in_turn() -> Iterator[bool]:
    """Whether the turn was had when it began; nested ones are the same turn."""
    if _has_turn():
        yield True
        return
    _take()
    try:
        yield _has_turn()
    finally:
        end_turn()


def waiting(ask: Callable[..., _Found], *asked: object) -> _Found:
    """What `ask` finds; this thread's turn, if it has one, is meanwhile another's."""
    if not _has_turn():
        return ask(*asked)
    end_turn()
    try:
        return ask(*asked)
    finally:
        _take()


def end_turn() -> None:
    """Give this thread's turn up, if it has one, before its block is over: whatever comes next waits for nobody."""
    if _has_turn():
        _mine.has_turn = False
        _turn.release()


def _has_turn() -> bool:
    return getattr(_mine, "has_turn", False)


def _take() -> None:
    _mine.has_turn = _turn.acquire(timeout=TIMEOUT_S)
