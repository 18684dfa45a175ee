"""How often a user may ask. Redis counts; without Redis nobody is refused."""

import logging
import time
from functools import cache
from typing import Any

from django.conf import settings
from redis import Redis
from redis.exceptions import RedisError
from rest_framework.request import Request
from rest_framework.throttling import ScopedRateThrottle

logger = logging.getLogger(__name__)

LOG_EVERY_S = 60.0


@cache
def _counters() -> Redis:
    return Redis.from_url(settings.REDIS_URL, socket_connect_timeout=1, socket_timeout=1)


def _count(key: str, kept_s: int) -> int:
    """Count one more under this key, in one round trip."""
    pipeline = _counters().pipeline(transaction=False)
    pipeline.incr(key)
    pipeline.expire(key, kept_s)
    counted: int = pipeline.execute()[0]
    return counted


class ScopedRate(ScopedRateThrottle):
    """Limits views that name a `throttle_scope`, per user, in fixed windows counted atomically over all processes."""

    quiet_until_s = 0.0  # of this process: the log is told once in a while, not at each request

    def allow_request(self, request: Request, view: Any) -> bool:
        self.scope = getattr(view, self.scope_attr, None)
        if not self.scope:
            return True
        self.rate = self.get_rate()
        self.num_requests, self.duration = self.parse_rate(self.rate)
        if self.num_requests is None:
            return True
        window = int(time.time() // self.duration)
        try:
            return _count(f"{self.get_cache_key(request, view)}:{window}", self.duration * 2) <= self.num_requests
        except (RedisError, OSError) as error:
            self._note_absence(error)
            return True

    def wait(self) -> float | None:
        return self.duration - time.time() % self.duration

    @classmethod
    def _note_absence(cls, error: Exception) -> None:
        now_s = time.monotonic()
        if now_s >= cls.quiet_until_s:
            cls.quiet_until_s = now_s + LOG_EVERY_S
            logger.warning("Redis is away, requests are not counted: %s", error)
