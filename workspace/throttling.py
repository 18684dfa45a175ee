"""How often a user may ask. Redis counts; without Redis nobody is refused."""

import logging
import time
from typing import Any

from django.core.cache import cache
from redis.exceptions import RedisError
from rest_framework.request import Request
from rest_framework.throttling import ScopedRateThrottle

logger = logging.getLogger(__name__)

LOG_EVERY_S = 60.0


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
        key = f"{self.get_cache_key(request, view)}:{window}"
        try:
            cache.add(key, 0, timeout=self.duration * 2)
            return cache.incr(key) <= self.num_requests
        except (RedisError, OSError) as error:
            self._note_absence(error)
            return True
        except ValueError:  # the key ran out between the two calls
            return True

    def wait(self) -> float | None:
        return self.duration - time.time() % self.duration

    @classmethod
    def _note_absence(cls, error: Exception) -> None:
        now_s = time.monotonic()
        if now_s >= cls.quiet_until_s:
            cls.quiet_until_s = now_s + LOG_EVERY_S
            logger.warning("Redis is away, requests are not counted: %s", error)
