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
_lock = Lock()
_mine = local()  # of each thread: `is_held`


@contextmanager
def hold_planning_lock() -> Iterator[bool]:
    """Whether the turn was had when it began; nested ones are the same turn."""
    if _is_held():
        yield True
        return
    _take()
    try:
        yield _is_held()
    finally:
        release_planning_lock()


def without_planning_lock(ask: Callable[..., _Found], *asked: object) -> _Found:
    """What `ask` finds; this thread's turn, if it has one, is meanwhile another's."""
    if not _is_held():
        return ask(*asked)
    release_planning_lock()
    try:
        return ask(*asked)
    finally:
        _take()


def release_planning_lock() -> None:
    """Give this thread's turn up, if it has one, before its block is over: whatever comes next waits for nobody."""
    if _is_held():
        _mine.is_held = False
        _lock.release()


def _is_held() -> bool:
    return getattr(_mine, "is_held", False)


def _take() -> None:
    _mine.is_held = _lock.acquire(timeout=TIMEOUT_S)
