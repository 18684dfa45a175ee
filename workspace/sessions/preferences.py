"""Middleware: the user's language and time zone for each request, and the record of the session's use."""

import ipaddress
from collections.abc import Callable
from contextlib import nullcontext
from datetime import timedelta
from zoneinfo import available_timezones

from django.conf import settings
from django.http import HttpRequest, HttpResponse
from django.utils import timezone, translation
from django.utils.cache import patch_vary_headers

from workspace.models import User
from workspace.sessions.browser_sessions import note_session

TIME_ZONES = frozenset(available_timezones())
SEEN_EVERY = timedelta(minutes=1)
ASKS_HOW_LONG = "/api/v1/account/session"  # does not count as presence
SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


class PreferencesMiddleware:
    """Placed after the session's middleware. The API always writes times in UTC: there only the language applies."""

    def __init__(self, get_response: Callable[[HttpRequest], HttpResponse]) -> None:
        self.get_response = get_response

    def __call__(self, request: HttpRequest) -> HttpResponse:
        user = _signed_in_user(request)
        own_language = user.own_language if user else ""
        zone = user.shown_time_zone if user and not request.path.startswith("/api/") else ""
        with (
            translation.override(own_language or translation.get_language_from_request(request)),
            timezone.override(zone) if zone in TIME_ZONES else nullcontext(),
        ):
            response = self.get_response(request)
        if user is not None and "Cache-Control" not in response:
            response["Cache-Control"] = "no-store"  # by default browsers may not store responses
        if not own_language and response.get("Content-Type", "").startswith("text/html"):
            patch_vary_headers(response, ("Accept-Language",))
        return response


def _signed_in_user(request: HttpRequest) -> User | None:
    if settings.SESSION_COOKIE_NAME not in request.COOKIES or not isinstance(request.user, User):
        return None
    is_read = request.method in SAFE_METHODS
    if is_read and request.path == ASKS_HOW_LONG:
        return request.user
    is_act = not is_read or not request.path.startswith("/api/")  # pages' own reads do not count
    agent, address = request.headers.get("User-Agent", ""), visitor_ip(request)
    note_session(request.session, request.user, is_act=is_act, user_agent=agent, address=address)
    now = timezone.now()
    if request.user.last_seen_at is None or now - request.user.last_seen_at >= SEEN_EVERY:
        User.objects.filter(pk=request.user.pk).update(last_seen_at=now)
        request.user.last_seen_at = now
    return request.user


def visitor_ip(request: HttpRequest) -> str:
    """Return the client's address; empty where none is known, as over a unix socket."""
    address = visitor_address(request.META.get("REMOTE_ADDR", ""), request.headers.get("X-Forwarded-For", ""))
    try:
        return str(ipaddress.ip_address(address))
    except ValueError:
        return ""


def visitor_address(peer: str, forwarded: str) -> str:
    """Return the address of the client.

    peer: the connection's address, empty over a unix socket. forwarded: X-Forwarded-For, of which only the last entry counts, which our own
    proxy appended, and only if the peer may be that proxy (SPANWISE_TRUSTED_PROXIES, or a unix socket).
    """
    last = forwarded.rpartition(",")[2].strip()
    return last if last and _is_trusted(peer) else peer


def _is_trusted(peer: str) -> bool:
    try:
        address = ipaddress.ip_address(peer)
    except ValueError:  # a unix socket has no address: only the proxy can open it
        return True
    address = getattr(address, "ipv4_mapped", None) or address
    return any(address in network for network in settings.TRUSTED_PROXIES)
