"""Live pages without a browser: each comes back by itself, counts gaps in the sequence, and knows when it was last told anything new."""

import json
import socket
import threading
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from types import TracebackType
from typing import Any, Self

from websocket import WebSocket, WebSocketException, create_connection

from tests.chaos.site import Site, wait_until

SILENT_S = 45.0
AGAIN_AFTER_S = 0.3
NEVER = datetime.min.replace(tzinfo=UTC)


@dataclass
class Page:
    """`measured_at` is the newest report that it shows; `gaps` are jumps of the sequence within one connection."""

    site: Site
    number: int
    opened: int = 0
    gaps: int = 0
    messages: int = 0
    measured_at: datetime = NEVER
    _sequence: int = 0

    def __enter__(self) -> Self:
        self._ends = threading.Event()
        self._socket: WebSocket | None = None
        self._thread = threading.Thread(target=self._run, name=f"page {self.number}")
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._ends.set()
        if self._socket is not None and self._socket.sock is not None:
            with suppress(OSError):
                self._socket.sock.shutdown(socket.SHUT_RDWR)  # which wakes whoever reads from it
        self._thread.join(2 * SILENT_S)

    def _run(self) -> None:
        while not self._ends.is_set():
            try:
                self._listen()
            except (OSError, WebSocketException):
                self._ends.wait(AGAIN_AFTER_S)

    def _listen(self) -> None:
        installation = self.site.installation
        tokens = self.site.people["operators"]
        self._socket = create_connection(
            f"wss://localhost:{installation.port}/ws/live",
            timeout=SILENT_S,
            header=[f"Authorization: Bearer {tokens[self.number % len(tokens)]}"],
            sslopt={"context": installation.trust()},
            suppress_origin=True,
        )
        self.opened += 1
        try:
            while not self._ends.is_set():
                if not (text := self._socket.recv()):
                    return
                self._take(json.loads(text))
        finally:
            self._socket.close()

    def _take(self, message: dict[str, Any]) -> None:
        if message["type"] == "keepalive":
            return
        self.messages += 1
        self.gaps += message["type"] == "changes" and message["sequence"] != self._sequence + 1
        self._sequence = message["sequence"]
        for uav in message["live"]["uavs"] if message["type"] == "snapshot" else message["uavs"]:
            if uav["measured"]:
                self.measured_at = max(self.measured_at, datetime.fromisoformat(uav["measured"]["received_at"]))
        assert self._socket is not None
        self._socket.send(json.dumps({"type": "ack", "sequence": self._sequence}))


@dataclass
class Pages:
    """Several of them."""

    site: Site
    number: int
    all: list[Page] = field(default_factory=list)

    def __enter__(self) -> Self:
        self.all = [Page(self.site, number) for number in range(self.number)]
        for page in self.all:
            page.__enter__()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for page in self.all:
            page.__exit__(kind, error, trace)

    def are_live_since(self, moment: datetime) -> bool:
        return all(page.measured_at > moment for page in self.all)

    def wait_until_live(self) -> None:
        """Until each shows something that was reported from now on."""
        begins_at = datetime.now(UTC)
        wait_until(lambda: self.are_live_since(begins_at), "live pages")

    @property
    def gaps(self) -> int:
        return sum(page.gaps for page in self.all)
