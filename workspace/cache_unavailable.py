"""Exceptions of an unavailable cache: all of its content can be made again, so no request waits for it."""

from redis.exceptions import RedisError

CACHE_UNAVAILABLE = (RedisError, OSError)
