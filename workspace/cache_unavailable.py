"""What the cache raises when it is away: everything kept there can be made again, so nobody waits for it."""

from redis.exceptions import RedisError

CACHE_UNAVAILABLE = (RedisError, OSError)
