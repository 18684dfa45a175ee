"""Graceful shutdown of a websocket program on SIGTERM: its sockets are closed one by one, so that pages do not reconnect at once.

The server would drop them without a close code. So it gets its signal only once they are closed: as SIGINT, which also stops it.
"""

import asyncio
import os
import random
import signal
from typing import Protocol
from weakref import WeakKeyDictionary

RESTARTS = 1012  # "service restart": the page reconnects at once, to another program
SPREAD_S = 4.0
MAX_DURATION_S = 6.0  # even if a page does not respond


class Socket(Protocol):
    def hang_up(self, code: int) -> None: ...


class GracefulShutdown:
    """The shutdown of one event loop."""

    def __init__(self, loop: asyncio.AbstractEventLoop, *, spread_s: float = SPREAD_S) -> None:
        self._loop = loop
        self._spread_s = spread_s
        self._sockets: set[Socket] = set()
        self.has_begun = False

    def receive_signal(self) -> None:
        """Handle SIGTERM in place of the server. Call it in the main thread, the only one that receives signals."""
        self._loop.add_signal_handler(signal.SIGTERM, self.begin)

    def begin(self) -> None:
        if self.has_begun:
            return
        self.has_begun = True
        for socket in self._sockets:
            self._send_later(socket)
        self._loop.call_later(MAX_DURATION_S if self._sockets else 0.0, self._leave)

    def expect(self, socket: Socket) -> None:
        """Register a socket to be closed at shutdown, until it is forgotten."""
        self._sockets.add(socket)
        if self.has_begun:
            self._send_later(socket)

    def forget(self, socket: Socket) -> None:
        self._sockets.discard(socket)
        if self.has_begun and not self._sockets:
            self._leave()

    def _send_later(self, socket: Socket) -> None:
        self._loop.call_later(random.uniform(0.0, self._spread_s), socket.hang_up, RESTARTS)

    def _leave(self) -> None:
        os.kill(os.getpid(), signal.SIGINT)


_shutdowns: WeakKeyDictionary[asyncio.AbstractEventLoop, GracefulShutdown] = WeakKeyDictionary()


def shutdown_here() -> GracefulShutdown:
    """Return the shutdown of the running event loop."""
    loop = asyncio.get_running_loop()
    if loop not in _shutdowns:
        _shutdowns[loop] = GracefulShutdown(loop)
    return _shutdowns[loop]
