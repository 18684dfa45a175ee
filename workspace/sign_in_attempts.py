"""A limit on wrong sign-ins, counted in the cache; without the cache sign-in goes on unlimited."""

import hashlib
import logging

from django.core.cache import cache
from django.http import HttpRequest
from redis.exceptions import RedisError

TRIES = 5
WINDOW_S = 15 * 60

logger = logging.getLogger(__name__)


def address_of(request: HttpRequest) -> str:
    """Where the request came from. Over the proxy's unix socket REMOTE_ADDR is empty: then what the proxy itself appended last."""
    address: str = request.META.get("REMOTE_ADDR", "")
    return address or request.headers.get("X-Forwarded-For", "").rpartition(",")[2].strip()


def _key(name: str, address: str) -> str:
    return "sign-in:" + hashlib.sha256(f"{name.casefold()}\n{address}".encode()).hexdigest()


def is_locked(name: str, address: str) -> bool:
    try:
        return bool(cache.get(_key(name, address), 0) >= TRIES)
    except (RedisError, OSError):
        return False


def count_failure(name: str, address: str) -> int | None:
    """Tries that are left in the window, or None where they cannot be counted."""
    try:
        key = _key(name, address)
        cache.add(key, 0, WINDOW_S)
        return max(0, TRIES - int(cache.incr(key)))
    except (RedisError, OSError, ValueError):  # ValueError: the window ended between the two calls
        logger.warning("wrong sign-ins are not counted: the cache is away")
        return None


def forget_failures(name: str, address: str) -> None:
    try:
        cache.delete(_key(name, address))
    except (RedisError, OSError):
        logger.warning("wrong sign-ins are not forgotten: the cache is away")
