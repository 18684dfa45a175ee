"""Notifications to open pages that rows have changed. A lost one does no harm: listeners also poll the rows."""

import asyncio
import logging
import time
from collections.abc import Callable
from functools import lru_cache
from uuid import UUID

from asgiref.sync import async_to_sync
from channels.layers import get_channel_layer
from django.conf import settings
from redis import Redis
from redis.backoff import NoBackoff
from redis.exceptions import RedisError
from redis.retry import Retry

logger = logging.getLogger(__name__)

LOG_INTERVAL_S = 60.0
DEADLINE_S = 1.0  # the sender also renews the job's lease, or responds to a user
LIVE_DEADLINE_S = 0.2  # for telemetry, which sends many times a second
LIVE_PAUSE_S = 2.0  # nothing is sent for this long after Redis was unavailable
_quiet_until_s = 0.0
_live_quiet_until_s = 0.0


def job_group(job_id: UUID | str) -> str:
    return f"job.{job_id}"


def live_channel(organisation_id: int | str) -> str:
    """Return a plain Redis channel, which a process can match with "*", where Channels needs a group per socket."""
    return f"spanwise-live.organisation.{organisation_id}"


def publish_job(job_id: UUID | str) -> None:
    """Notify followers of the job that its row has changed. Without Redis it does nothing and never fails."""
    _unless_redis_is_away(lambda: async_to_sync(_send)(job_group(job_id)))


def publish_live(organisation_id: int) -> None:
    """Notify the organisation's live pages of a change, after the commit. It never fails, and waits for Redis only briefly."""
    global _live_quiet_until_s
    if time.monotonic() < _live_quiet_until_s:
        return
    if not _unless_redis_is_away(lambda: _redis(settings.REDIS_URL).publish(live_channel(organisation_id), b"")):
        _live_quiet_until_s = time.monotonic() + LIVE_PAUSE_S


def _unless_redis_is_away(report: Callable[[], object]) -> bool:
    global _quiet_until_s
    try:
        report()
    except (RedisError, OSError) as error:  # TimeoutError is an OSError
        if time.monotonic() >= _quiet_until_s:
            _quiet_until_s = time.monotonic() + LOG_INTERVAL_S
            logger.warning("Redis is away, pages are not told of changes: %r", error)
        return False
    return True


async def _send(group: str) -> None:
    async with asyncio.timeout(DEADLINE_S):
        await get_channel_layer().group_send(group, {"type": "job.changed"})


@lru_cache(maxsize=4)
def _redis(address: str) -> Redis:
    return Redis.from_url(address, socket_connect_timeout=LIVE_DEADLINE_S, socket_timeout=LIVE_DEADLINE_S, retry=Retry(NoBackoff(), 1))
