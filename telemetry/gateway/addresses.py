"""Addresses of a UAV: its main address, and others that deliver the same signed frames or later ones.

A signature authenticates the author of a frame, not its sender: any host on the UAV's network can send a copy that arrives first.
"""

from collections import Counter, deque
from dataclasses import dataclass, field

from telemetry.gateway.peers import Peer

MOVE_AFTER_S = 5.0  # after another address alone has delivered frames for so long, it becomes the main one
SAME_WITHIN_S = 2.0  # a later copy counts as a replay
MAX_ADDRESSES = 8
MAX_RECENT = 512  # frames remembered to detect copies


@dataclass
class ReceivedFrom:
    since_s: float
    last_s: float


@dataclass
class Addresses:
    """Addresses of one UAV. Times are Unix seconds. `copied`: another address that also delivered frames of the UAV, and when last."""

    main: Peer | None = None
    copied: tuple[str, float] | None = None
    _received: dict[Peer, ReceivedFrom] = field(default_factory=dict)
    _first: dict[tuple[str, int], tuple[Peer, float]] = field(default_factory=dict)  # first sender of each frame, and when
    _order: deque[tuple[str, int]] = field(default_factory=deque)

    def take(self, stream: str, timestamp: int, peer: Peer, now_s: float) -> None:
        """Record an accepted frame that arrived for the first time."""
        self._first[stream, timestamp] = (peer, now_s)
        self._order.append((stream, timestamp))
        if len(self._order) > MAX_RECENT:
            self._first.pop(self._order.popleft(), None)
        self._receive(peer, now_s)
        self._move(now_s)

    def copy(self, stream: str, timestamp: int, peer: Peer, now_s: float) -> bool:
        """Return whether a correctly signed frame that was accepted before now arrives from a second address."""
        first = self._first.get((stream, timestamp))
        if first is None or first[0] == peer or not 0 <= now_s - first[1] <= SAME_WITHIN_S:
            return False
        self._receive(peer, now_s)
        self.copied = (peer.name if first[0] == self.main else first[0].name, now_s)
        return True

    def answered(self, now_s: float) -> list[Peer]:
        """Return the addresses to send to, the main one first."""
        if self.main is None:
            return []
        return [self.main, *(peer for peer, received in self._received.items() if peer != self.main and not _is_silent(received, now_s))]

    def believe(self, peer: Peer) -> None:
        """Set the only address; used for unsigned links."""
        self.forget()
        self.main = peer

    def forget(self) -> None:
        self.main = self.copied = None
        self._received.clear()
        self._first.clear()
        self._order.clear()

    def _receive(self, peer: Peer, now_s: float) -> None:
        received = self._received.get(peer)
        if received is not None and not _is_silent(received, now_s):
            received.last_s = now_s
        elif received is not None or self._has_room(peer, now_s):
            self._received[peer] = ReceivedFrom(now_s, now_s)

    def _has_room(self, newcomer: Peer, now_s: float) -> bool:
        """Return whether a new address fits.

        If full, drop an address of the host with the most, if it has at least two more than the newcomer's: many ports of one host must not
        exclude another host.
        """
        self._received = {
            peer: received for peer, received in self._received.items() if peer == self.main or not _is_silent(received, now_s)
        }
        if len(self._received) < MAX_ADDRESSES:
            return True
        hosts = Counter(_host(peer) for peer in self._received)
        host, number = hosts.most_common(1)[0]
        if number <= hosts[_host(newcomer)] + 1:
            return False
        del self._received[next(peer for peer in reversed(self._received) if _host(peer) == host and peer != self.main)]
        return True

    def _move(self, now_s: float) -> None:
        """Change the main address to the one received from for longest, once the present one is silent."""
        main = None if self.main is None else self._received.get(self.main)
        if main is not None and not _is_silent(main, now_s):
            return
        others = [
            (received.since_s, peer) for peer, received in self._received.items() if peer != self.main and not _is_silent(received, now_s)
        ]
        since_s, peer = min(others, key=lambda other: other[0], default=(now_s, None))
        if peer is not None and (self.main is None or now_s - since_s >= MOVE_AFTER_S):
            if self.main is not None:
                self._received.pop(self.main, None)
            self.main = peer


def _is_silent(received: ReceivedFrom, now_s: float) -> bool:
    """Return whether the address is silent; also true after the server's clock was set back."""
    return abs(now_s - received.last_s) >= MOVE_AFTER_S


def _host(peer: Peer) -> str:
    return peer.name.rpartition(":")[0]
