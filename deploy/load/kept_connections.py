"""Connections of Locust's client that are kept, however many there are."""

from typing import Any

from gevent.monkey import get_original
from geventhttpclient.connectionpool import ConnectionPool


def keep_all_connections() -> None:
    """To be called before the first request of the process.

    The client (geventhttpclient 2.6) asks select(2) whether a kept connection is still open. That knows file descriptors below 1,024
    alone, and whatever it does not know the client closes: of 5,000 users four of five made a new TLS connection for each request.
    """
    ConnectionPool._is_socket_alive = _is_quiet  # type: ignore[method-assign]


def _is_quiet(pool: ConnectionPool, connection: Any) -> bool:
    """Open, and with nothing to read: what can be read of a connection on which nothing was asked is its end."""
    if connection is None or connection.fileno() < 0:
        return False
    asked = get_original("select", "poll")()
    asked.register(connection.fileno())
    return not any(events & ~_MAY_WRITE for _, events in asked.poll(0))


_MAY_WRITE = get_original("select", "POLLOUT")
