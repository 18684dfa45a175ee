"""A look at runaways: work that grows with the square of hostile input takes minutes of the processor, a refusal under two seconds."""

import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager

RUNAWAY_S = 2.0  # of the processor time of this process and of those that it started and that ended: a busy machine does not count


@contextmanager
def no_runaway() -> Iterator[None]:
    """Fails where the body took more processor time than a refusal may."""
    began_s = processor_s()
    yield
    assert processor_s() - began_s < RUNAWAY_S


def processor_s() -> float:
    """Return the processor time of this process and of its ended children."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime
