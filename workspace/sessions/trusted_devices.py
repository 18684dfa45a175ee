"""A signed cookie that says who has signed in with this browser before: limits that strangers cause do not reach them here.

The cookie lets nobody in. It holds digests of names and a random mark for each; the mark is what tries are counted by, so that a
copied cookie buys no more tries than the browser itself has.
"""

import hashlib
import secrets

from django.conf import settings
from django.core import signing
from django.http import HttpRequest, HttpResponse

COOKIE = f"{settings.COOKIE_PREFIX}spanwise_known"
SALT = "workspace.known_browsers"
KEPT_S = 180 * 24 * 3_600
MAX_PEOPLE = 5  # of one browser


def mark_of(request: HttpRequest, name: str) -> str | None:
    """The browser's mark for a name that has signed in here before."""
    return dict(_entries(request)).get(_digest(name))


def remember(request: HttpRequest, response: HttpResponse, name: str) -> None:
    """Somebody has shown to be who they say, with this browser."""
    mine = _digest(name)
    others = [entry for entry in _entries(request) if entry[0] != mine]
    entries = [(mine, secrets.token_urlsafe(12)), *others][:MAX_PEOPLE]
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
