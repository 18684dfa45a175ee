"""A line between a browser and the installation that can be cut, or frozen: then nothing is forwarded, and nothing is closed."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from urllib.parse import urlsplit

CHUNK = 65_536


@dataclass
class FrozenLine:
    """Listens on `address`. `freeze` stops forwarding in both directions, `cut` closes and refuses, `repair` ends both."""

    site_address: str
    _moves: threading.Event = field(default_factory=threading.Event)
    _is_cut: bool = False
    _sockets: list[socket.socket] = field(default_factory=list)
    _endpoint: socket.socket = field(default_factory=lambda: socket.create_server(("127.0.0.1", 0)))

    def __post_init__(self) -> None:
        self._moves.set()
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self._endpoint.getsockname()[1]}"

    def freeze(self) -> None:
        self._moves.clear()

    def cut(self) -> None:
        self._is_cut = True
        self._hang_up()

    def repair(self) -> None:
        self._is_cut = False
        self._moves.set()

    def close(self) -> None:
        self._is_cut = True
        self._moves.set()
        self._endpoint.close()
        self._hang_up()

    def _hang_up(self) -> None:
        for one in self._sockets:
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
        self._sockets.clear()

    def _accept(self) -> None:
        place = urlsplit(self.site_address)
        with suppress(OSError):  # it is closed
            while True:
                near, _ = self._endpoint.accept()
                if self._is_cut:
                    near.close()
                    continue
                far = socket.create_connection((place.hostname, place.port))
                self._sockets += [near, far]
                for source, sink in ((near, far), (far, near)):
                    threading.Thread(target=self._forward, args=(source, sink), daemon=True).start()

    def _forward(self, source: socket.socket, sink: socket.socket) -> None:
        with suppress(OSError):
            while data := source.recv(CHUNK):
                self._moves.wait()
                sink.sendall(data)
        for one in (source, sink):
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)


@contextmanager
def line_to(site_address: str) -> Iterator[FrozenLine]:
    line = FrozenLine(site_address)
    try:
        yield line
    finally:
        line.close()
