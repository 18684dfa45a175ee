"""A limit for the processor time of a piece of work: a small file must not occupy a parser and its worker for long."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

AGAIN_S = 5.0  # repeat interval, in case a library swallows the exception


class ProcessorTimeExceeded(Exception):
    """Raised when the work has used up its processor time."""


@contextmanager
def processor_limit(seconds: float) -> Iterator[None]:
    """Raise ProcessorTimeExceeded in the body once this process has used this much, user and system time of all threads.

    Signals reach only the main thread, where a worker runs its tasks; in other threads there is no limit.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        raise ProcessorTimeExceeded

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds, AGAIN_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
