"""The planning lock: threads of one process make small plans one at a time; while one waits for the database, another continues.

They share one interpreter, and compiled parts release it for microseconds at a time. Concurrent planning threads take it from each other
each time, which makes a plan half as expensive again under load.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock, local
from typing import TypeVar

TIMEOUT_S = 0.25  # fairness only: a thread that waits longer, as behind a large plan, continues without the lock
_Found = TypeVar("_Found")
_lock = Lock()
_mine = local()  # per thread: `is_held`


@contextmanager
def hold_planning_lock() -> Iterator[bool]:
    """Yield whether the lock was acquired; a nested block shares the outer lock."""
    if _is_held():
        yield True
        return
    _take()
    try:
        yield _is_held()
    finally:
        release_planning_lock()


def without_planning_lock(ask: Callable[..., _Found], *asked: object) -> _Found:
    """Return the result of `ask`; this thread's lock, if held, is free for others meanwhile."""
    if not _is_held():
        return ask(*asked)
    release_planning_lock()
    try:
        return ask(*asked)
    finally:
        _take()


def release_planning_lock() -> None:
    """Release this thread's lock, if held, before its block ends, so that later work blocks no other thread."""
    if _is_held():
        _mine.is_held = False
        _lock.release()


def _is_held() -> bool:
    return getattr(_mine, "is_held", False)


def _take() -> None:
    _mine.is_held = _lock.acquire(timeout=TIMEOUT_S)
