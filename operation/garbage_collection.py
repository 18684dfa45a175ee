"""How often Python looks for garbage, rarely while a program starts and then only among what is new; when free memory is given back."""

import ctypes
import gc
import sys
import threading
import time

INTERVAL_S = 60.0
_RETURN_TO_SYSTEM = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None  # of the GNU C library alone


def collect_rarely() -> None:
    """A start makes hundreds of thousands of objects that stay; walking through them again and again is a third of its time."""
    gc.set_threshold(50_000, 20, 50)


def freeze_startup_objects() -> None:
    """Once a start has ended: what it has made (code, models, graphs) stays, and nobody walks through it again.

    Then a look costs little and comes often, as programs that do little leave little behind: ten circles at each question to the
    database, which at 20,000 a look were half an hour's growth. Python looks at all that is old only when a quarter of it is new, and goes
    on counting what has been frozen until it looks once more. Without that second look some 800,000 objects of the start count, and what a
    request left behind while others were answered waits for 200,000 of its kind: a web program grew by a sixth an hour.
    """
    gc.collect()
    gc.freeze()
    gc.collect()
    gc.set_threshold(2_000, 10, 10)


def trim_memory() -> None:
    """Once a piece of work has ended: what it left in circles goes, and what it needed for a time goes back to the system.

    Otherwise each task begins among what the ones before it left, and reaches higher than any of them now and then; the memory that it
    took for that is returned only from its end, where something small stays: a worker of the ground grew by some 6 MiB an hour, of which
    nothing was in use.
    """
    gc.collect()
    if _RETURN_TO_SYSTEM is not None:
        _RETURN_TO_SYSTEM(0)


def trim_memory_periodically() -> None:
    """In programs whose work never ends: the same each minute."""
    threading.Thread(target=_keep_giving_back, name="memory", daemon=True).start()


def _keep_giving_back() -> None:
    while True:
        time.sleep(INTERVAL_S)
        trim_memory()
