"""Whom the users of a load test trust: one TLS context for all of them."""

import ssl
from collections.abc import Callable
from functools import cache


def trusting(authority: str | None) -> Callable[..., ssl.SSLContext]:
    """What makes a context for Locust's client: the authority in this file and nobody else's; the system's without one.

    The client asks for each connection with a list of public authorities. To a factory that takes no list it would add that one by
    itself, each time anew: a tenth of a second of its only core.
    """

    @cache
    def one() -> ssl.SSLContext:
        return ssl.create_default_context(cafile=authority)

    def factory(cafile: str | None = None) -> ssl.SSLContext:
        return one()

    return factory
