"""A program of websockets that is told to stop (SIGTERM) says goodbye to its pages: one by one, so that they do not all come back at once.

Whoever serves the sockets would drop them without a word. So it hears of the signal only once they are closed: as SIGINT, which says
the same to it.
"""

import asyncio
import os
import random
import signal
from typing import Protocol
from weakref import WeakKeyDictionary

RESTARTS = 1012  # "service restart": the page comes back at once, and finds another program
SPREAD_S = 4.0
MAX_DURATION_S = 6.0  # also where a page does not answer


class Socket(Protocol):
    def hang_up(self, code: int) -> None: ...


class GracefulShutdown:
    """Of one event loop."""

    def __init__(self, loop: asyncio.AbstractEventLoop, *, spread_s: float = SPREAD_S) -> None:
        self._loop = loop
        self._spread_s = spread_s
        self._sockets: set[Socket] = set()
        self.has_begun = False

    def receive_signal(self) -> None:
        """Instead of whoever serves the sockets. In the main thread only, where signals are heard."""
        self._loop.add_signal_handler(signal.SIGTERM, self.begin)

    def begin(self) -> None:
        if self.has_begun:
            return
        self.has_begun = True
        for socket in self._sockets:
            self._send_later(socket)
        self._loop.call_later(MAX_DURATION_S if self._sockets else 0.0, self._leave)

    def expect(self, socket: Socket) -> None:
        """It is told once it is time, until it is forgotten."""
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
    """That of the running event loop."""
    loop = asyncio.get_running_loop()
    if loop not in _shutdowns:
        _shutdowns[loop] = GracefulShutdown(loop)
    return _shutdowns[loop]
