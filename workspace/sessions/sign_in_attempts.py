"""Limits on guessing passwords, counted in the cache, that keep nobody out of their own account.

Who guesses is slowed down in three ways: by name and network, by network, and by name over all networks. A browser in which
the name has signed in before (workspace/sessions/sign_in_attempts.py) is counted for itself, so it is free of what others do to the name.
Without Redis each process counts for itself, so that there are as many tries more as there are processes.
"""

import hashlib
import ipaddress
import logging
import secrets
from dataclasses import dataclass

from django.conf import settings
from django.core import signing
from django.core.cache import cache
from django.core.cache.backends.base import BaseCache
from django.core.cache.backends.locmem import LocMemCache
from django.http import HttpRequest, HttpResponse

from workspace.cache_unavailable import CACHE_UNAVAILABLE
from workspace.sessions.preferences import visitor_address

WINDOW_S = 15 * 60
TRIES = 5  # of one name from one network, or from one known browser
TRIES_OF_A_NETWORK = 50  # of any names
TRIES_BEFORE_A_NAME_IS_SLOW = 20  # of one name from everywhere
SLOW_S = 10  # then strangers have one try in so long
PASSWORD_CHANGES = "changing the password of"  # noqa: S105 - a purpose, no password
NETWORK_BITS_OF_IPV6 = 64  # what one subscriber usually has

logger = logging.getLogger(__name__)
_of_process: BaseCache = LocMemCache("sign-in attempts", {"OPTIONS": {"MAX_ENTRIES": 20_000}})  # while Redis is away


class TooManyAttempts(Exception):
    """The try is not looked at. `wait_s` says when the next one is; `name_is_slow`: strangers guess at this name everywhere."""

    def __init__(self, wait_s: int, *, name_is_slow: bool = False) -> None:
        super().__init__(f"held back for {wait_s} s")
        self.wait_s = wait_s
        self.name_is_slow = name_is_slow


@dataclass(frozen=True)
class Try:
    """One try that was let through and counted before the password was looked at, so that many at once gain nothing."""

    keys: tuple[str, ...]
    left: int  # in the window
    counts: BaseCache

    def succeeded(self) -> None:
        """Somebody who knows the password has not guessed: their own count ends, and the shared ones do not have this try."""
        try:
            self.counts.delete(self.keys[0])
            _take_back(self.counts, *self.keys[1:])
        except (*CACHE_UNAVAILABLE, ValueError):  # ValueError: the window ended in between
            logger.warning("wrong sign-ins are not forgotten: the cache is away")


def address_of(request: HttpRequest) -> str:
    """Where the request came from."""
    return visitor_address(request.META.get("REMOTE_ADDR", ""), request.headers.get("X-Forwarded-For", ""))


def network_of(address: str) -> str:
    """What is counted: an IPv4 address, of IPv6 the network that one subscriber has."""
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    mapped = getattr(found, "ipv4_mapped", None)
    if found.version == 4 or mapped:
        return str(mapped or found)
    return str(ipaddress.ip_network((found, NETWORK_BITS_OF_IPV6), strict=False).network_address)


def try_to_sign_in(*, name: str, address: str, trusted_device: str | None) -> Try:
    """Count a try. `trusted_device` is the mark of a browser in which this name has signed in before. Raises HeldBack."""
    network = network_of(address)
    try:
        return _try(cache, name, network, trusted_device)
    except (*CACHE_UNAVAILABLE, ValueError):
        logger.warning("wrong sign-ins are counted by this process alone: the cache is away")
        return _try(_of_process, name, network, trusted_device)


def _try(counts: BaseCache, name: str, network: str, trusted_device: str | None) -> Try:
    if trusted_device:
        own = _key("browser", name, trusted_device)
        return Try((own,), _count(counts, own, TRIES), counts)
    own, everybody = _key("pair", name, network), _key("name", name)
    left = _count(counts, own, TRIES)
    of_network = _key("network", network)
    _count(counts, of_network, TRIES_OF_A_NETWORK)
    if _add(counts, everybody) > TRIES_BEFORE_A_NAME_IS_SLOW and not counts.add(_key("slow", name), 1, SLOW_S):
        _take_back(counts, own, of_network)  # to wait for a turn is no wrong try
        raise TooManyAttempts(SLOW_S, name_is_slow=True)
    return Try((own, of_network, everybody), left, counts)


def count_attempt(purpose: str, *of_whom: str, most: int = TRIES) -> None:
    """Count something else that may be asked for only so often, such as mails to one address. Raises HeldBack."""
    key = _key(purpose, *of_whom)
    try:
        _count(cache, key, most)
    except (*CACHE_UNAVAILABLE, ValueError):
        logger.warning("turns are counted by this process alone: the cache is away")
        _count(_of_process, key, most)


def is_first_in(seconds: int, *of_what: str) -> bool:
    """Whether this has not happened for so long. True without the cache."""
    try:
        return bool(cache.add(_key("first", *of_what), 1, seconds))
    except CACHE_UNAVAILABLE:
        return True


def _key(purpose: str, *parts: str) -> str:
    return "sign-in:" + hashlib.sha256("\n".join([purpose, *(part.casefold() for part in parts)]).encode()).hexdigest()


def _add(counts: BaseCache, key: str) -> int:
    counts.add(key, 0, WINDOW_S)
    return int(counts.incr(key))


def _take_back(counts: BaseCache, *keys: str) -> None:
    for key in keys:
        counts.decr(key)


def _count(counts: BaseCache, key: str, most: int) -> int:
    """Tries that are left after this one. Raises HeldBack."""
    count = _add(counts, key)
    if count > most:
        raise TooManyAttempts(WINDOW_S)
    return most - count


COOKIE = f"{settings.COOKIE_PREFIX}spanwise_known"
SALT = "workspace.known_browsers"
KEPT_S = 180 * 24 * 3_600
MAX_USERS = 5  # of one browser


def mark_of(request: HttpRequest, name: str) -> str | None:
    """The browser's mark for a name that has signed in here before."""
    return dict(_entries(request)).get(_digest(name))


def remember(request: HttpRequest, response: HttpResponse, name: str) -> None:
    """Somebody has shown to be who they say, with this browser."""
    mine = _digest(name)
    others = [entry for entry in _entries(request) if entry[0] != mine]
    entries = [(mine, secrets.token_urlsafe(12)), *others][:MAX_USERS]
    response.set_cookie(
        COOKIE,
        signing.dumps(entries, salt=SALT),
        max_age=KEPT_S,
        secure=settings.SESSION_COOKIE_SECURE,
        httponly=True,
        samesite="Lax",
    )


def _entries(request: HttpRequest) -> list[tuple[str, str]]:
    try:
        entries = signing.loads(request.COOKIES.get(COOKIE, ""), salt=SALT, max_age=KEPT_S)
    except signing.BadSignature:
        return []
    return [(str(name), str(mark)) for name, mark in entries]


def _digest(name: str) -> str:
    return hashlib.sha256(name.casefold().encode()).hexdigest()[:24]
