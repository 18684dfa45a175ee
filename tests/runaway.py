"""A look at runaways: work that grows with the square of hostile input takes minutes of the processor, a refusal under a second."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

RUNAWAY_S = 15.0  # of this process's own processor time: a busy machine does not count


@contextmanager
def no_runaway() -> Iterator[None]:
    """Fails where the body took more processor time than any honest refusal does; how fast it is, `benchmarks` measure."""
    began_s = time.process_time()
    yield
    assert time.process_time() - began_s < RUNAWAY_S
