"""Limits on guessing passwords, counted in the cache, that keep nobody out of their own account.

Who guesses is slowed down in three ways: by name and network, by network, and by name over all networks. A browser in which
the name has signed in before (workspace/known_browsers.py) is counted for itself, so it is free of what others do to the name.
Without the cache sign-in goes on unlimited.
"""

import hashlib
import ipaddress
import logging
from dataclasses import dataclass

from django.core.cache import cache
from django.http import HttpRequest

from workspace.cache_absence import CACHE_AWAY

WINDOW_S = 15 * 60
TRIES = 5  # of one name from one network, or from one known browser
TRIES_OF_A_NETWORK = 50  # of any names
TRIES_BEFORE_A_NAME_IS_SLOW = 20  # of one name from everywhere
SLOW_S = 10  # then strangers have one try in so long
PASSWORD_CHANGES = "changing the password of"  # noqa: S105 - a purpose, no password
NETWORK_BITS_OF_IPV6 = 64  # what one subscriber usually has

logger = logging.getLogger(__name__)


class HeldBack(Exception):
    """The try is not looked at. `wait_s` says when the next one is; `name_is_slow`: strangers guess at this name everywhere."""

    def __init__(self, wait_s: int, *, name_is_slow: bool = False) -> None:
        super().__init__(f"held back for {wait_s} s")
        self.wait_s = wait_s
        self.name_is_slow = name_is_slow


@dataclass(frozen=True)
class Try:
    """One try that was let through and counted before the password was looked at, so that many at once gain nothing."""

    keys: tuple[str, ...]
    left: int | None  # in the window; None where nothing can be counted

    def succeeded(self) -> None:
        """Somebody who knows the password has not guessed: their own count ends, and the shared ones do not have this try."""
        try:
            if self.keys:
                cache.delete(self.keys[0])
            _take_back(*self.keys[1:])
        except (*CACHE_AWAY, ValueError):  # ValueError: the window ended in between
            logger.warning("wrong sign-ins are not forgotten: the cache is away")


def address_of(request: HttpRequest) -> str:
    """Where the request came from. Over the proxy's unix socket REMOTE_ADDR is empty: then what the proxy itself appended last."""
    address: str = request.META.get("REMOTE_ADDR", "")
    return address or request.headers.get("X-Forwarded-For", "").rpartition(",")[2].strip()


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


def try_to_sign_in(*, name: str, address: str, known_browser: str | None) -> Try:
    """Count a try. `known_browser` is the mark of a browser in which this name has signed in before. Raises HeldBack."""
    network = network_of(address)
    try:
        if known_browser:
            own = _key("browser", name, known_browser)
            return Try((own,), _count(own, TRIES))
        own, everybody = _key("pair", name, network), _key("name", name)
        left = _count(own, TRIES)
        of_network = _key("network", network)
        _count(of_network, TRIES_OF_A_NETWORK)
        if _add(everybody) > TRIES_BEFORE_A_NAME_IS_SLOW and not cache.add(_key("slow", name), 1, SLOW_S):
            _take_back(own, of_network)  # to wait for a turn is no wrong try
            raise HeldBack(SLOW_S, name_is_slow=True)
        return Try((own, of_network, everybody), left)
    except (*CACHE_AWAY, ValueError):
        logger.warning("wrong sign-ins are not counted: the cache is away")
        return Try((), None)


def take_turn(purpose: str, *of_whom: str, most: int = TRIES) -> None:
    """Count something else that may be asked for only so often, such as mails to one address. Raises HeldBack."""
    try:
        _count(_key(purpose, *of_whom), most)
    except (*CACHE_AWAY, ValueError):
        logger.warning("turns are not counted: the cache is away")


def is_first_in(seconds: int, *of_what: str) -> bool:
    """Whether this has not happened for so long. True without the cache."""
    try:
        return bool(cache.add(_key("first", *of_what), 1, seconds))
    except CACHE_AWAY:
        return True


def _key(purpose: str, *parts: str) -> str:
    return "sign-in:" + hashlib.sha256("\n".join([purpose, *(part.casefold() for part in parts)]).encode()).hexdigest()


def _add(key: str) -> int:
    cache.add(key, 0, WINDOW_S)
    return int(cache.incr(key))


def _take_back(*keys: str) -> None:
    for key in keys:
        cache.decr(key)


def _count(key: str, most: int) -> int:
    """Tries that are left after this one. Raises HeldBack."""
    count = _add(key)
    if count > most:
        raise HeldBack(WINDOW_S)
    return most - count
