"""Tuning of Python's garbage collector, and returning free memory to the OS."""

import ctypes
import gc
import sys
import threading
import time

INTERVAL_S = 60.0
_RETURN_TO_SYSTEM = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None  # GNU C library only


def collect_rarely() -> None:
    """Collect rarely during a start, which makes hundreds of thousands of permanent objects; traversing them takes a third of its time."""
    gc.set_threshold(50_000, 20, 50)


def freeze_startup_objects() -> None:
    """Freeze the objects of a start (code, models, graphs), which stay, so that no collection traverses them again.

    Collections are then cheap and run often: each database query leaves ten cycles, which at a threshold of 20,000 would take half an hour
    to collect. Python collects old objects only when a quarter of them is new, and counts frozen ones until its next full collection.
    Without the second collection here some 800,000 start objects count, and cycles from requests wait for 200,000 of their kind: a web
    program grew by a sixth an hour.
    """
    gc.collect()
    gc.freeze()
    gc.collect()
    gc.set_threshold(2_000, 10, 10)


def trim_memory() -> None:
    """Collect cycles and return unused memory to the OS after a piece of work.

    Otherwise each task starts with the garbage of earlier ones and peaks higher. The allocator returns memory only from the top of the
    heap, which one small object can block: a data worker grew by some 6 MiB an hour, none of it in use.
    """
    gc.collect()
    if _RETURN_TO_SYSTEM is not None:
        _RETURN_TO_SYSTEM(0)


def trim_memory_periodically() -> None:
    """Trim memory each minute, in programs whose work never ends."""
    threading.Thread(target=_keep_giving_back, name="memory", daemon=True).start()


def _keep_giving_back() -> None:
    while True:
        time.sleep(INTERVAL_S)
        trim_memory()
