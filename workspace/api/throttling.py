"""Rate limits per user. Redis counts over all processes; without Redis no request is refused."""

import logging
import time
from functools import cache
from math import ceil
from typing import Any, ClassVar

from django.conf import settings
from redis import Redis
from redis.exceptions import RedisError
from rest_framework.request import Request
from rest_framework.throttling import ScopedRateThrottle

logger = logging.getLogger(__name__)

LOG_INTERVAL_S = 60.0
GENEROUS = 20  # at limits from here on, a user's first request in a window and process is not counted in Redis


@cache
def _counters() -> Redis:
    return Redis.from_url(settings.REDIS_URL, socket_connect_timeout=1, socket_timeout=1)


@cache
def _rate(written: str | None) -> tuple[int | None, int | None]:
    """Return requests and seconds of "40/second"; None without a limit."""
    parsed: tuple[int | None, int | None] = ScopedRateThrottle().parse_rate(written)
    return parsed


def rate_limit_headers(scope: str, resets_in_s: float) -> dict[str, str]:
    """Return RateLimit and RateLimit-Policy of a refused request, as in draft-ietf-httpapi-ratelimit-headers-10."""
    requests, duration_s = _rate(ScopedRate.THROTTLE_RATES[scope])
    if requests is None or duration_s is None:
        return {}
    return {"RateLimit-Policy": f'"{scope}";q={requests};w={duration_s}', "RateLimit": f'"{scope}";r=0;t={ceil(resets_in_s)}'}


def _count(key: str, kept_s: int) -> int:
    """Increment the count under this key, in one round trip."""
    pipeline = _counters().pipeline(transaction=False)
    pipeline.incr(key)
    pipeline.expire(key, kept_s)
    counted: int = pipeline.execute()[0]
    return counted


class ScopedRate(ScopedRateThrottle):
    """Limits views that name a `throttle_scope`, per user, in fixed windows counted atomically over all processes.

    Most users send requests rarely. At a generous limit the first request of a user in a window and process passes uncounted, so each
    process may let one more pass.
    """

    quiet_until_s = 0.0  # of this process: limits how often the failure is logged
    seen: ClassVar[dict[str, tuple[int, set[str]]]] = {}  # by scope: the window, and users seen in it by this process

    def allow_request(self, request: Request, view: Any) -> bool:
        self.scope = getattr(view, self.scope_attr, None)
        if not self.scope:
            return True
        key = self.get_cache_key(request, view)
        return key is None or self.has_room(self.scope, key)

    @classmethod
    def allows(cls, scope: str, user: int) -> bool:
        """Count one more request of this user, as for a view that names the scope."""
        return cls.has_room(scope, cls.cache_format % {"scope": scope, "ident": user})

    @classmethod
    def has_room(cls, scope: str, key: str) -> bool:
        requests, duration_s = _rate(cls.THROTTLE_RATES[scope])
        if requests is None or duration_s is None:
            return True
        window = int(time.time() // duration_s)
        if requests >= GENEROUS and cls._is_first(scope, key, window):
            return True
        try:
            return _count(f"{key}:{window}", duration_s * 2) <= requests
        except (RedisError, OSError) as error:
            cls._note_absence(error)
            return True

    @classmethod
    def _is_first(cls, scope: str, key: str, window: int) -> bool:
        at, keys = cls.seen.get(scope, (None, set()))
        if at != window:
            cls.seen[scope] = window, {key}
            return True
        if key in keys:
            return False
        keys.add(key)
        return True

    def wait(self) -> float | None:
        _, duration_s = _rate(self.THROTTLE_RATES[self.scope] if self.scope else None)
        return None if duration_s is None else duration_s - time.time() % duration_s

    @classmethod
    def _note_absence(cls, error: Exception) -> None:
        now_s = time.monotonic()
        if now_s >= cls.quiet_until_s:
            cls.quiet_until_s = now_s + LOG_INTERVAL_S
            logger.warning("Redis is away, requests are not counted: %s", error)
