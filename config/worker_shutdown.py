"""Shutdown of a worker on SIGTERM or SIGQUIT: short work is finished, long work returns to its queue, within 10 s.

Celery's own soft shutdown sleeps its whole time in the signal handler, however soon the work is done, and then waits for processes that
are still warming up and ignore signals. Here the worker's loop continues meanwhile: it takes results and acknowledges messages. Processes
that have not ended are killed, which work must survive anyway.
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
GIVE_BACK_S = 1.0  # for interrupted work: its job is then another worker's
GO_S = 0.5  # for idle processes, until they are killed
ENDS_WITHIN_S = 9.5
SIGNALS = (signal.SIGTERM, signal.SIGQUIT)


class SoftEnd(StartStopStep):
    """The shutdown of one worker. Its loop polls several times a second for a received signal."""

    requires = ("celery.worker.components:Timer",)

    def __init__(self, worker: Any, **named: Any) -> None:
        super().__init__(worker, **named)
        self._worker, self._process = worker, os.getpid()
        self._reported_s: float | None = None
        self._cancelled_s: float | None = None
        self._receives = False
        signals.worker_before_create_process.connect(self._receive, weak=False)

    def _receive(self, **_: Any) -> None:
        """Install the handlers before the first process starts; later Celery's own shutdown may wait for one that ignores signals."""
        is_main = threading.current_thread() is threading.main_thread()  # only this one receives signals
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
        if os.getpid() != self._process:  # a pool process between its fork and its own handlers: it has no work yet
            os._exit(1)
        if self._reported_s is not None:
            return
        self._reported_s = time.monotonic()
        _later(ENDS_WITHIN_S, os._exit, 1)  # an unresponsive queue must not block the shutdown
        if not state.active_requests:
            self._leave()

    def _look(self) -> None:
        """Poll from the worker's loop."""
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
        """End the worker's loop; unacknowledged messages return to their queue."""
        state.should_terminate = os.EX_OK  # type: ignore[assignment] # its stub knows None alone
        _later(GO_S, self._kill_processes)

    def _kill_processes(self) -> None:
        pool = getattr(getattr(self._worker, "pool", None), "_pool", None)
        for process in list(getattr(pool, "_pool", [])):
            with suppress(ProcessLookupError):
                os.kill(process.pid, signal.SIGKILL)
        _later(GO_S, self._kill_processes)  # a pool that is not closed yet would start others


def _later(after_s: float, do: Callable[..., object], *arguments: object) -> None:
    timer = threading.Timer(after_s, do, arguments)
    timer.daemon = True
    timer.start()
