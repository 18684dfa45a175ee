"""Sockets that vehicles connect to: all frames go to one function, and each sender can be answered."""

import asyncio
import contextlib
import logging
import socket
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from mavlink.frames import Damage, Frame, StreamParser, frames_of_datagram
from telemetry.gateway.options import UdpAddress

logger = logging.getLogger(__name__)

MAX_DATAGRAM_BYTES = 65_535
DRAINED_FOR_S = 0.02  # before other tasks run
PIECE = 16_384  # bytes of a connection parsed at once
RECEIVE_BUFFER = 8 * 1024 * 1024  # bytes, as far as the system permits
MAX_CONNECTIONS = 256  # beyond it, the connection longest without a frame is closed
MAX_UNSENT = 256 * 1024  # bytes for a connection that does not read
SILENT_CONNECTION_S = 60.0


class Peer(Protocol):
    """A sender; equal for each message from the same address."""

    @property
    def name(self) -> str: ...

    def send(self, frame: bytes) -> None: ...


Receive = Callable[[list[Frame], Peer, float], None]  # frames, sender, receipt [Unix s]


@dataclass(frozen=True)
class UdpPeer:
    listener: socket.socket = field(repr=False)
    address: tuple[str, int]

    @property
    def name(self) -> str:
        return f"udp:{self.address[0]}:{self.address[1]}"

    def send(self, frame: bytes) -> None:
        with contextlib.suppress(OSError):  # a full buffer or an unreachable port is a lost datagram
            self.listener.sendto(frame, self.address)


@dataclass(eq=False)
class TcpPeer:
    writer: asyncio.StreamWriter = field(repr=False)
    name: str

    def send(self, frame: bytes) -> None:
        transport = self.writer.transport
        if not transport.is_closing() and transport.get_write_buffer_size() < MAX_UNSENT:
            self.writer.write(frame)


@dataclass
class Listeners:
    """All sockets of a gateway. `damages` counts bytes that were not frames."""

    receive: Receive
    damages: Counter[Damage] = field(default_factory=Counter)
    _sockets: list[socket.socket] = field(default_factory=list)
    _servers: list[asyncio.Server] = field(default_factory=list)
    _connections: dict[asyncio.StreamWriter, float] = field(default_factory=dict)  # monotonic time of each connection's last frame

    async def open(self, udp: list[UdpAddress], tcp: list[UdpAddress]) -> list[str]:
        """Open the sockets and return their addresses, with the ports that the system chose for 0. Raises OSError."""
        names = [f"udp:{self._open_udp(address)}" for address in udp]
        for address in tcp:
            server = await asyncio.start_server(self._serve, address.host, address.port, limit=PIECE)
            self._servers.append(server)
            host, port = server.sockets[0].getsockname()[:2]
            names.append(f"tcp:{UdpAddress(host, port)}")
        return names

    def close(self) -> None:
        loop = asyncio.get_running_loop()
        for listener in self._sockets:
            loop.remove_reader(listener)
            listener.close()
        for server in self._servers:
            server.close()
        for writer in self._connections:
            writer.close()

    def _open_udp(self, address: UdpAddress) -> UdpAddress:
        family, kind, protocol, _, where = socket.getaddrinfo(address.host, address.port, type=socket.SOCK_DGRAM)[0]
        listener = socket.socket(family, kind, protocol)
        try:
            listener.setblocking(False)
            _enlarge(listener)
            listener.bind(where)
        except OSError:
            listener.close()
            raise
        self._sockets.append(listener)
        asyncio.get_running_loop().add_reader(listener, self._drain, listener)
        return UdpAddress(*listener.getsockname()[:2])

    def _drain(self, listener: socket.socket) -> None:
        until_s = time.monotonic() + DRAINED_FOR_S
        while time.monotonic() < until_s:
            try:
                datagram, address = listener.recvfrom(MAX_DATAGRAM_BYTES)
            except BlockingIOError:
                return
            except OSError:  # reports an answer that could not be delivered
                continue
            frames = frames_of_datagram(datagram, self.damages)
            if frames:
                self.receive(frames, UdpPeer(listener, address), time.time())

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while len(self._connections) >= MAX_CONNECTIONS:
            self._drop(min(self._connections, key=lambda other: self._connections[other]))
        self._connections[writer] = time.monotonic()
        host, port = writer.get_extra_info("peername")[:2]
        peer, parser = TcpPeer(writer, f"tcp:{host}:{port}"), StreamParser(self.damages)
        try:
            while piece := await _read(reader):
                frames = parser.receive(piece)
                if frames:
                    self._connections[writer] = time.monotonic()
                    self.receive(frames, peer, time.time())
        except (OSError, TimeoutError):
            pass
        finally:
            self._drop(writer)

    def _drop(self, writer: asyncio.StreamWriter) -> None:
        """Abort a connection: closing one that does not read would never complete."""
        self._connections.pop(writer, None)
        writer.transport.abort()


async def _read(reader: asyncio.StreamReader) -> bytes:
    """Return the next bytes, empty at the end of the stream. Raises TimeoutError, OSError."""
    async with asyncio.timeout(SILENT_CONNECTION_S):
        return await reader.read(PIECE)


def _enlarge(listener: socket.socket) -> None:
    """Enlarge the receive buffer for bursts, beyond the system's limit if the process may."""
    for option in (getattr(socket, "SO_RCVBUFFORCE", 33), socket.SO_RCVBUF):
        with contextlib.suppress(OSError):
            listener.setsockopt(socket.SOL_SOCKET, option, RECEIVE_BUFFER)
            return
