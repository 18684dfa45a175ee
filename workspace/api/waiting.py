"""`Prefer: wait=N` (RFC 7240): a request that waits for the job that it started."""

import re
import threading
import time
from uuid import UUID

from django.conf import settings
from rest_framework.request import Request

from workspace.models import Job, JobState

POLL_INTERVAL_S = 0.1
WAITING_AT_ONCE = 2  # per process: the other threads keep responding

_places = threading.BoundedSemaphore(WAITING_AT_ONCE)
_WAIT = re.compile(r"""(?:^|[,;])\s*wait\s*=\s*"?(\d{1,9})"?\s*(?=$|[,;])""", re.IGNORECASE)


def preferred_wait_s(request: Request) -> int | None:
    """Return the whole seconds that the request would wait, within the limit of the settings; None without the preference."""
    found = _WAIT.search(request.META.get("HTTP_PREFER", ""))
    return min(int(found[1]), int(settings.MAX_WAIT_S)) if found else None


class NoRoomToWait(Exception):
    """Raised when enough requests of this process wait already; this one gets its response at once."""


def wait_for_job(job_id: UUID, wait_s: float) -> Job | None:
    """Return the job as soon as it has ended; None when it takes longer. Raises NoRoomToWait."""
    if not _places.acquire(blocking=False):
        raise NoRoomToWait
    try:
        until_s = time.monotonic() + wait_s
        while True:
            if not Job.objects.filter(pk=job_id, state__in=(JobState.QUEUED, JobState.RUNNING)).exists():
                return Job.objects.filter(pk=job_id).first()
            if time.monotonic() >= until_s:
                return None
            time.sleep(POLL_INTERVAL_S)
    finally:
        _places.release()
