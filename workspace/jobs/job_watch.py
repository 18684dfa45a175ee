"""Carries a job's progress out of a long transaction, renews its lease, and brings the wish to stop back in.

Inside a transaction nothing of a job's row may be written: nobody would see it before the end, and whoever wants to cancel would wait
for it. So a thread of its own, with its own connection, does that once a second; also while the database works on one long statement,
or the processor on one long search.
"""

import logging
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

from django.db import DatabaseError, connection, connections

from operation.reasons import Why
from workspace.jobs.services import JobCancelled, JobLost, message_of, release_job, report_progress
from workspace.models import Job

logger = logging.getLogger(__name__)

INTERVAL_S = 1.0

Draw = Callable[[], Any]


class JobWatch:
    """`with JobWatch(job) as watch: work(progress=watch.progress)`. progress raises JobCancelled once somebody has asked to stop.

    Work that wants to keep what it has found uses `note` and `stop` instead, which raise nothing.
    """

    def __init__(self, job: Job, *, interval_s: float = INTERVAL_S) -> None:
        self.job = job
        self._interval_s = interval_s
        self._share, self._message = job.progress, message_of(job)
        self._draw: Draw | None = None
        self._stopped = threading.Event()
        self._is_cancelled = threading.Event()
        self._is_inline = False
        self._reported_at_s = time.monotonic()
        self._thread = threading.Thread(target=self._run, name=f"watch of job {job.pk}", daemon=True)

    def __enter__(self) -> "JobWatch":
        if connection.in_atomic_block:  # a caller's own transaction, as in tests: the thread could see nothing of it
            self._is_inline = True
        else:
            self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._stopped.set()
        if self._thread.ident is not None:
            self._thread.join()
        if kind is not None and issubclass(kind, SystemExit) and not connection.in_atomic_block:
            self._release()

    def _release(self) -> None:
        """The worker ends before the work does. Without a database the lease runs out by itself."""
        try:
            release_job(job=self.job)
        except DatabaseError as error:
            logger.warning("job %s is not given back: %r", self.job.pk, error)

    @property
    def is_cancelled(self) -> bool:
        return self._is_cancelled.is_set()

    def progress(self, message: Why, share: float) -> None:
        self._message, self._share = message, share
        self.check()

    def check(self) -> None:
        if self.is_cancelled:
            raise JobCancelled

    def note(self, share: float, message: Why, draw: Draw | None = None) -> None:
        """How far it is, and how to draw the best found so far: drawn once a report, however often there is a better one."""
        self._share, self._message = share, message
        if draw is not None:
            self._draw = draw
        self._report_inline()

    def stop(self) -> bool:
        """Whether somebody has asked to stop, or another worker has the job by now. Never raises: searches call it from C++."""
        self._report_inline()
        return self.is_cancelled

    def _report_inline(self) -> None:
        if self._is_inline and time.monotonic() - self._reported_at_s >= self._interval_s:
            self._reported_at_s = time.monotonic()
            self._report()

    def _run(self) -> None:
        try:
            while not self._stopped.wait(self._interval_s):
                self._report()
        finally:
            connections.close_all()  # this thread's alone

    def _report(self) -> None:
        best = self._drawn()
        if not self._reported(best) and best is not None:
            self._reported(None)  # the lease is renewed, whatever the best was

    def _reported(self, best: Any) -> bool:
        try:
            report_progress(job=self.job, progress=self._share, message=self._message, best=best)
        except JobLost:
            self._is_cancelled.set()
            self._stopped.set()
        except JobCancelled:
            self._is_cancelled.set()  # the lease is renewed until the end: the best until now is still being written up
        except Exception as error:
            logger.warning("progress of job %s is not stored: %r", self.job.pk, error)
            connection.close_if_unusable_or_obsolete()
            return False
        return True

    def _drawn(self) -> Any:
        """The best so far; None where there is nothing new, or it cannot be drawn."""
        draw, self._draw = self._draw, None
        try:
            return draw() if draw else None
        except Exception:
            logger.exception("the best of job %s so far cannot be drawn", self.job.pk)
            return None
