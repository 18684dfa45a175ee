"""Reports a job's progress from within a long transaction, renews its lease, and receives the request to cancel.

A job's row may not be written inside the transaction: the change would be invisible until its end, and would block a cancellation. A
separate thread with its own connection writes it once a second, also during a long statement of the database or a long search.
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
    """`with JobWatch(job) as watch: work(progress=watch.progress)`. progress raises JobCancelled once a user has cancelled the job.

    Work that keeps what it has found uses `note` and `stop` instead, which raise nothing.
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
        """Release the job as the worker ends before the work. Without a database the lease runs out."""
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
        """Store the progress, and how to draw the best result so far: drawn once per report, however often it improves."""
        self._share, self._message = share, message
        if draw is not None:
            self._draw = draw
        self._report_inline()

    def stop(self) -> bool:
        """Whether a user has cancelled the job, or another worker holds it. Never raises: searches call it from C++."""
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
            connections.close_all()  # only this thread's

    def _report(self) -> None:
        best = self._drawn()
        if not self._reported(best) and best is not None:
            self._reported(None)  # renews the lease even if the result cannot be drawn

    def _reported(self, best: Any) -> bool:
        try:
            report_progress(job=self.job, progress=self._share, message=self._message, best=best)
        except JobLost:
            self._is_cancelled.set()
            self._stopped.set()
        except JobCancelled:
            self._is_cancelled.set()  # keep renewing the lease: the best result is still being stored
        except Exception as error:
            logger.warning("progress of job %s is not stored: %r", self.job.pk, error)
            connection.close_if_unusable_or_obsolete()
            return False
        return True

    def _drawn(self) -> Any:
        """Return the best result so far; None where there is nothing new, or it cannot be drawn."""
        draw, self._draw = self._draw, None
        try:
            return draw() if draw else None
        except Exception:
            logger.exception("the best of job %s so far cannot be drawn", self.job.pk)
            return None
