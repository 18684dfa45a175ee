"""What the work at hand is about: a request, a mission, a UAV. Every line of log that is written meanwhile names it."""

import re
import secrets
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar

REQUEST_ID_HEADER = "X-Request-ID"
FIELDS = ("request", "user", "mission", "uav", "job")
ABOUT_REQUEST = "spanwise_about"  # what a request object itself knows of this, for lines that are written when it is over

_SANE_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{7,63}")

Facts = Mapping[str, str]
_about: ContextVar[Facts | Callable[[], Facts] | None] = ContextVar("about", default=None)


def sane_request_id(reported: str | None) -> str:
    """The one that came along, if it is fit to be written down and sent on; else a new one."""
    return reported if reported is not None and _SANE_ID.fullmatch(reported) else secrets.token_hex(16)


def facts() -> Facts:
    """Of the work at hand; empty where nothing is known."""
    about = _about.get()
    if about is None:
        return {}
    return about() if callable(about) else about


@contextmanager
def about(**named: object) -> Iterator[None]:
    """In addition to what is known, or instead of it; None changes nothing."""
    known = {name: str(value) for name, value in named.items() if value is not None}
    token = _about.set({**facts(), **known})
    try:
        yield
    finally:
        _about.reset(token)


@contextmanager
def about_lazily(read: Callable[[], Facts]) -> Iterator[None]:
    """The facts are asked for only where something is written down: a request costs nothing for them."""
    token = _about.set(read)
    try:
        yield
    finally:
        _about.reset(token)
