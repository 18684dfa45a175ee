"""Limits on password guessing, counted in the cache, that do not lock users out of their own account.

Attempts are limited by name and network, by network, and by name over all networks. A trusted device, in which the name has logged in
before, is counted separately, so attempts elsewhere do not affect it. Without Redis each process counts for itself, which multiplies the
allowed tries by the number of processes.
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
TRIES = 5  # of one name from one network, or from one trusted device
TRIES_OF_A_NETWORK = 50  # of any names
TRIES_BEFORE_A_NAME_IS_SLOW = 20  # of one name from everywhere
SLOW_S = 10  # then untrusted devices have one try per this time
PASSWORD_CHANGES = "changing the password of"  # noqa: S105 - a purpose, no password
NETWORK_BITS_OF_IPV6 = 64  # usual network of one subscriber

logger = logging.getLogger(__name__)
_of_process: BaseCache = LocMemCache("sign-in attempts", {"OPTIONS": {"MAX_ENTRIES": 20_000}})  # while Redis is unavailable


class TooManyAttempts(Exception):
    """Raised instead of checking a try. `wait_s`: time until the next one; `name_is_slow`: guesses at this name come from everywhere."""

    def __init__(self, wait_s: int, *, name_is_slow: bool = False) -> None:
        super().__init__(f"held back for {wait_s} s")
        self.wait_s = wait_s
        self.name_is_slow = name_is_slow


@dataclass(frozen=True)
class Try:
    """One allowed try, counted before the password is checked, so that concurrent tries gain nothing."""

    keys: tuple[str, ...]
    left: int  # tries in the window
    counts: BaseCache

    def succeeded(self) -> None:
        """Reset the user's own count and remove this try from the shared ones: the password was right."""
        try:
            self.counts.delete(self.keys[0])
            _take_back(self.counts, *self.keys[1:])
        except (*CACHE_UNAVAILABLE, ValueError):  # ValueError: the window ended in between
            logger.warning("wrong sign-ins are not forgotten: the cache is away")


def address_of(request: HttpRequest) -> str:
    """Return the client's address."""
    return visitor_address(request.META.get("REMOTE_ADDR", ""), request.headers.get("X-Forwarded-For", ""))


def network_of(address: str) -> str:
    """Return what is counted: an IPv4 address, or for IPv6 a subscriber's network."""
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    mapped = getattr(found, "ipv4_mapped", None)
    if found.version == 4 or mapped:
        return str(mapped or found)
    return str(ipaddress.ip_network((found, NETWORK_BITS_OF_IPV6), strict=False).network_address)


def try_to_sign_in(*, name: str, address: str, trusted_device: str | None) -> Try:
    """Count a try. `trusted_device` is the mark of a browser in which this name has logged in before. Raises TooManyAttempts."""
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
        _take_back(counts, own, of_network)  # waiting is no wrong try
        raise TooManyAttempts(SLOW_S, name_is_slow=True)
    return Try((own, of_network, everybody), left, counts)


def count_attempt(purpose: str, *of_whom: str, most: int = TRIES) -> None:
    """Count another rate-limited action, such as mails to one address. Raises TooManyAttempts."""
    key = _key(purpose, *of_whom)
    try:
        _count(cache, key, most)
    except (*CACHE_UNAVAILABLE, ValueError):
        logger.warning("turns are counted by this process alone: the cache is away")
        _count(_of_process, key, most)


def is_first_in(seconds: int, *of_what: str) -> bool:
    """Whether this has not happened for so many seconds. True without the cache."""
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
    """Return the tries left after this one. Raises TooManyAttempts."""
    count = _add(counts, key)
    if count > most:
        raise TooManyAttempts(WINDOW_S)
    return most - count


COOKIE = f"{settings.COOKIE_PREFIX}spanwise_known"
SALT = "workspace.known_browsers"
KEPT_S = 180 * 24 * 3_600
MAX_USERS = 5  # of one browser


def mark_of(request: HttpRequest, name: str) -> str | None:
    """Return the browser's mark for a name that has logged in here before."""
    return dict(_entries(request)).get(_digest(name))


def remember(request: HttpRequest, response: HttpResponse, name: str) -> None:
    """Remember that the user has authenticated with this browser."""
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
