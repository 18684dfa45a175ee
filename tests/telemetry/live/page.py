"""An open page as a test plays it: what it shows by what it was told."""

import json
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from websocket import ABNF, WebSocket, WebSocketException, WebSocketTimeoutException

from tests.workspace.live.proxied_site import TIMEOUT_S

KINDS = ("uavs", "missions", "alerts", "commands", "offers")


class HungUp(WebSocketException):
    """The other end has said goodbye, with a code."""

    def __init__(self, code: int) -> None:
        super().__init__(f"hung up with {code}")
        self.code = code


@dataclass
class Page:
    """`shows` by kind and id. It confirms what it takes."""

    socket: WebSocket
    shows: dict[str, dict[Any, Any]] = field(default_factory=lambda: {kind: {} for kind in KINDS})
    sequence: int = 0

    def take(self) -> dict[str, Any]:
        message = self.receive()
        if message["type"] != "keepalive":
            self.report({"type": "ack", "sequence": message["sequence"]})
        return message

    def receive(self) -> dict[str, Any]:
        """Takes in a message that it does not confirm. Raises HungUp."""
        frame = self.socket.recv_frame()
        if frame.opcode == ABNF.OPCODE_CLOSE:
            raise HungUp(int.from_bytes(frame.data[:2], "big"))
        message: dict[str, Any] = json.loads(frame.data)
        if message["type"] == "snapshot":
            self.shows = {kind: {entry["id"]: entry for entry in message["live"][kind]} for kind in KINDS}
            self.sequence = message["sequence"]
        elif message["type"] == "changes":
            assert message["sequence"] == self.sequence + 1, "a gap"
            self.sequence = message["sequence"]
            for kind in KINDS:
                self.shows[kind] |= {entry["id"]: entry for entry in message[kind]}
                for gone in message["removed"][kind]:
                    self.shows[kind].pop(gone, None)
        return message

    def take_until(self, is_so: Callable[["Page"], Any], patience_s: float = TIMEOUT_S) -> Any:
        """What `is_so` finds."""
        until_s = time.monotonic() + patience_s
        while not (found := is_so(self)):
            self.socket.settimeout(max(until_s - time.monotonic(), 0.01))
            try:
                self.take()
            except WebSocketTimeoutException:
                raise AssertionError("it was never told") from None
        self.socket.settimeout(TIMEOUT_S)
        return found

    def report(self, value: object) -> None:
        with suppress(BrokenPipeError, ConnectionResetError):  # hung up meanwhile: with which code it has yet to hear
            self.socket.send(json.dumps(value))
