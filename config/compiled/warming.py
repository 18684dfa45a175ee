"""Warm-up of the web program in the background: it already serves, but is not ready until compiled code and the network are loaded."""

import logging
import threading
from collections.abc import Callable

logger = logging.getLogger(__name__)

WARMING_UP = "compiled code and the network are still being loaded"
_thread: threading.Thread | None = None


def warm_up_beside(work: Callable[[], None]) -> None:
    """Run the warm-up in a thread. If it fails, the first request that needs something loads it."""
    global _thread
    _thread = threading.Thread(target=_do, args=[work], name="warm-up", daemon=True)
    _thread.start()


def warming_faults() -> list[str]:
    """Return why this process is not ready yet."""
    return [WARMING_UP] if _thread is not None and _thread.is_alive() else []


def _do(work: Callable[[], None]) -> None:
    try:
        work()
    except Exception:
        logger.exception("not warmed up")
