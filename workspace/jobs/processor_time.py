"""A bound for the processor time of a piece of work: what a small file can make a parser do must not hold a worker for long."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

AGAIN_S = 5.0  # after which it is raised again, where a library has swallowed it


class ProcessorTimeExceeded(Exception):
    """The work has used up the processor time that it was given."""


@contextmanager
def processor_limit(seconds: float) -> Iterator[None]:
    """Raise ProcessorTimeExceeded in the body once this process has used so much in it, user and system time of all threads.

    Signals reach the main thread alone, where a worker does its tasks; elsewhere there is no bound.
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
