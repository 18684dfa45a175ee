"""How a worker ends when it is told to (SIGTERM, SIGQUIT): what is short is finished, what is long goes back to its queue, within 10 s.

Celery's own soft shutdown sleeps its whole time in the signal's handler, however soon the work is done, and then waits for processes
that are still warming up and do not hear a signal by then. Here the worker's loop goes on meanwhile: results are taken, and messages
acknowledged. A process that has not ended by itself is killed, which work has to survive anyway.
"""

import logging
import os
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import Any

from celery import signals
from celery.bootsteps import StartStopStep
from celery.worker import state
from django.conf import settings

logger = logging.getLogger(__name__)

POLL_INTERVAL_S = 0.2
GIVE_BACK_S = 1.0  # for work that is told to end: its job is another worker's from then on
GO_S = 0.5  # for processes without work, until they are killed
ENDS_WITHIN_S = 9.5
SIGNALS = (signal.SIGTERM, signal.SIGQUIT)


class SoftEnd(StartStopStep):
    """Of one worker. Its loop looks several times a second whether it has been told to end."""

    requires = ("celery.worker.components:Timer",)

    def __init__(self, worker: Any, **named: Any) -> None:
        super().__init__(worker, **named)
        self._worker, self._process = worker, os.getpid()
        self._reported_s: float | None = None
        self._cancelled_s: float | None = None
        self._receives = False
        signals.worker_before_create_process.connect(self._receive, weak=False)

    def _receive(self, **_: Any) -> None:
        """Before the first process is begun: from then on Celery's own way to end may wait for one that does not hear."""
        is_main = threading.current_thread() is threading.main_thread()  # no other hears signals
        if is_main and not self._receives and os.getpid() == self._process:
            self._receives = True
            for number in SIGNALS:
                signal.signal(number, self._end)

    def start(self, worker: Any) -> None:
        self._receive()
        self._timer = worker.timer.call_repeatedly(POLL_INTERVAL_S, self._look)

    def stop(self, worker: Any) -> None:
        self._timer.cancel()

    def _end(self, number: int, frame: FrameType | None) -> None:
        if os.getpid() != self._process:  # a process of the pool between its fork and handlers of its own: it has no work yet
            os._exit(1)
        if self._reported_s is not None:
            return
        self._reported_s = time.monotonic()
        _later(ENDS_WITHIN_S, os._exit, 1)  # a queue that neither answers nor refuses holds up nothing
        if not state.active_requests:
            self._leave()

    def _look(self) -> None:
        """In the worker's loop."""
        if self._reported_s is None or state.should_terminate is not None:
            return
        self._take_nothing_more()
        now_s = time.monotonic()
        if self._cancelled_s is not None:
            if now_s - self._cancelled_s >= GIVE_BACK_S:
                self._leave()
        elif not state.active_requests:
            self._leave()
        elif now_s - self._reported_s >= settings.CELERY_WORKER_SOFT_SHUTDOWN_TIMEOUT:
            self._cancelled_s = now_s
            logger.warning("%s tasks are not done and go back to the queue", len(state.active_requests))
            self._worker.consumer.cancel_active_requests()

    def _take_nothing_more(self) -> None:
        consumer = getattr(self._worker.consumer, "task_consumer", None)
        if consumer is not None:
            with suppress(*self._worker.consumer.connection_errors):
                consumer.cancel()

    def _leave(self) -> None:
        """The loop ends the worker, and what has no acknowledgement is put back into its queue."""
        state.should_terminate = os.EX_OK  # type: ignore[assignment] # its stub knows None alone
        _later(GO_S, self._kill_processes)

    def _kill_processes(self) -> None:
        pool = getattr(getattr(self._worker, "pool", None), "_pool", None)
        for process in list(getattr(pool, "_pool", [])):
            with suppress(ProcessLookupError):
                os.kill(process.pid, signal.SIGKILL)
        _later(GO_S, self._kill_processes)  # a pool that has not been closed yet starts others


def _later(after_s: float, do: Callable[..., object], *arguments: object) -> None:
    timer = threading.Timer(after_s, do, arguments)
    timer.daemon = True
    timer.start()
