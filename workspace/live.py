"""Word to open pages that a row has changed. A word that is lost costs nothing: whoever listens looks at the row by itself, too."""

import asyncio
import logging
import time
from uuid import UUID

from asgiref.sync import async_to_sync
from channels.layers import get_channel_layer
from redis.exceptions import RedisError

logger = logging.getLogger(__name__)

LOG_EVERY_S = 60.0
DEADLINE_S = 1.0  # whoever has the word to say renews the job's lease, or answers a person
_quiet_until_s = 0.0


def job_group(job_id: UUID | str) -> str:
    return f"job.{job_id}"


def publish_job(job_id: UUID | str) -> None:
    """Tell whoever follows the job that its row has changed. Without Redis nobody is told, and nothing fails."""
    global _quiet_until_s
    try:
        async_to_sync(_send)(job_group(job_id))
    except (RedisError, OSError) as error:  # TimeoutError is an OSError
        if time.monotonic() >= _quiet_until_s:
            _quiet_until_s = time.monotonic() + LOG_EVERY_S
            logger.warning("Redis is away, pages are not told of jobs: %r", error)


async def _send(group: str) -> None:
    await asyncio.wait_for(get_channel_layer().group_send(group, {"type": "job.changed"}), DEADLINE_S)
