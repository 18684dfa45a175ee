"""The context of the current work: a request, a mission, a UAV. Every log line written meanwhile contains it."""

import re
import secrets
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar

REQUEST_ID_HEADER = "X-Request-ID"
FIELDS = ("request", "user", "mission", "uav", "job")
ABOUT_REQUEST = "spanwise_about"  # attribute of a request object, for lines logged after the request

_SANE_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{7,63}")

Facts = Mapping[str, str]
_about: ContextVar[Facts | Callable[[], Facts] | None] = ContextVar("about", default=None)


def sane_request_id(reported: str | None) -> str:
    """Return the received id if it is safe to log and forward; else a new one."""
    return reported if reported is not None and _SANE_ID.fullmatch(reported) else secrets.token_hex(16)


def facts() -> Facts:
    """Return the context of the current work; empty where nothing is known."""
    about = _about.get()
    if about is None:
        return {}
    return about() if callable(about) else about


@contextmanager
def about(**named: object) -> Iterator[None]:
    """Add to the context, or override it; None changes nothing."""
    known = {name: str(value) for name, value in named.items() if value is not None}
    token = _about.set({**facts(), **known})
    try:
        yield
    finally:
        _about.reset(token)


@contextmanager
def about_lazily(read: Callable[[], Facts]) -> Iterator[None]:
    """Set a context that is computed only when a line is logged, so that a request does not pay for it."""
    token = _about.set(read)
    try:
        yield
    finally:
        _about.reset(token)
