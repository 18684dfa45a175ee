"""The UDP socket of one UAV: sends to given addresses, and to each station that sent to it."""

import contextlib
import ipaddress
import socket
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from mavlink.frames import Damage, Frame, frames_of_datagram

MAX_DATAGRAM_BYTES = 65_535
MAX_DATAGRAMS = 100  # received before other work
MAX_PEERS = 16
HEARTBEAT = 0  # its message id
MIN_HEARTBEATS = 3  # of a station that sends them regularly
SILENT_AFTER_S = 2.0  # of real time; such stations send one per second
FORGOTTEN_AFTER_S = 60.0  # of silence; given addresses are kept
Address = tuple[str, int]


class InvalidStationAddress(ValueError):
    """The text is not HOST:PORT, or the host is unknown."""


def address_of(text: str) -> Address:
    """Parse HOST:PORT, with an IPv6 host in brackets, and resolve the host. Raises InvalidStationAddress."""
    host, _, port = text.strip().rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65_536:
        raise InvalidStationAddress(f"{text!r} is not HOST:PORT.")
    try:
        where = socket.getaddrinfo(host.strip("[]"), int(port), type=socket.SOCK_DGRAM)[0][4]
    except OSError as error:
        raise InvalidStationAddress(f"{text!r}: {error}.") from error
    return str(where[0]), int(where[1])


@dataclass
class _Peer:
    link: int
    last_message_s: float
    is_given: bool


@dataclass
class Radio:
    """The socket. `damages` counts bytes that were not frames. A peer's number, its link, is never reused."""

    given: Sequence[Address]
    listen: Address | None = None
    damages: Counter[Damage] = field(default_factory=Counter)
    _peers: dict[Address, _Peer] = field(default_factory=dict)
    _links: int = 0
    _heartbeats: int = 0
    _heartbeat_s: float = 0.0

    def __post_init__(self) -> None:
        first = self.listen or next(iter(self.given), ("127.0.0.1", 0))
        family = socket.AF_INET6 if ":" in first[0] else socket.AF_INET
        self.socket = socket.socket(family, socket.SOCK_DGRAM)
        try:
            self.socket.setblocking(False)
            self.socket.bind(self.listen or (self._host, 0))
        except OSError:
            self.socket.close()
            raise
        for address in self.given:
            self._add(address, is_given=True)

    @property
    def _host(self) -> str:
        """Return the address to bind: loopback if all given addresses are local."""
        hosts = [ipaddress.ip_address(host) for host, _ in self.given]
        if any(not host.is_loopback for host in hosts):
            return ""
        return str(hosts[0]) if hosts else "127.0.0.1"

    def close(self) -> None:
        self.socket.close()

    @property
    def port(self) -> int:
        return int(self.socket.getsockname()[1])

    def received(self) -> Iterator[tuple[Frame, Address]]:
        """Yield received frames with their sender."""
        for _ in range(MAX_DATAGRAMS):
            try:
                datagram, address = self.socket.recvfrom(MAX_DATAGRAM_BYTES)
            except BlockingIOError:
                return
            except OSError:  # an earlier datagram could not be delivered
                continue
            for frame in frames_of_datagram(datagram, self.damages):
                if frame.message_id == HEARTBEAT:
                    self._heartbeats, self._heartbeat_s = self._heartbeats + 1, time.monotonic()
                yield frame, (address[0], address[1])

    def is_station_silent(self, now_s: float) -> bool:
        """Return whether a station that sent heartbeats is late: it may be overloaded."""
        return self._heartbeats >= MIN_HEARTBEATS and now_s - self._heartbeat_s > SILENT_AFTER_S

    def link_of(self, address: Address) -> int | None:
        """Return the link of an authenticated sender; None while too many others are active."""
        peer = self._peers.get(address) or self._add(address, is_given=False)
        if peer is None:
            return None
        peer.last_message_s = time.monotonic()
        return peer.link

    def send(self, frame: bytes, link: int | None) -> None:
        """Send to one peer, or to all."""
        for address, peer in self._peers.items():
            if link is None or peer.link == link:
                with contextlib.suppress(OSError):  # a full buffer or an unreachable port is a lost datagram
                    self.socket.sendto(frame, address)

    def _add(self, address: Address, *, is_given: bool) -> _Peer | None:
        now_s = time.monotonic()
        for other, peer in list(self._peers.items()):
            if not peer.is_given and now_s - peer.last_message_s > FORGOTTEN_AFTER_S:
                del self._peers[other]
        if len(self._peers) >= MAX_PEERS and not is_given:
            return None
        self._links += 1
        return self._peers.setdefault(address, _Peer(self._links, now_s, is_given))
