"""An open live page under gevent: confirms what it is told, comes back by itself, asks again after a gap, and counts what it saw."""

import ssl
import time
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

import gevent
import orjson
from websocket import WebSocket, WebSocketException, create_connection

from deploy.load.day import book as kinds
from deploy.load.day.book import Book

SILENT_S = 45.0  # the server says every 20 s that it is still there
FIRST_PAUSE_S, MAX_PAUSE_S = 0.25, 5.0
TABLES = ("uavs", "missions", "alerts", "commands", "offers")


@dataclass
class LivePage:
    """`shown` is what the page shows, by table and id. `run` until the greenlet is killed."""

    host: str
    path: str
    cookies: str
    trusted: ssl.SSLContext
    book: Book
    by: str
    shown: dict[str, dict[Any, Any]] = field(default_factory=lambda: {table: {} for table in TABLES})
    messages: int = 0
    opened: int = 0
    gaps: int = 0
    received_at_s: float = 0.0
    closed: int = 0  # the code with which the server hung up for good
    _sequence: int = 0

    def run(self) -> None:
        pause_s = FIRST_PAUSE_S
        try:
            while not self.closed:
                try:
                    self._listen()
                    pause_s = FIRST_PAUSE_S
                except (OSError, WebSocketException):
                    gevent.sleep(pause_s)
                    pause_s = min(2 * pause_s, MAX_PAUSE_S)
        finally:
            self.book.note(kinds.WATCHED, by=self.by, path=self.path, messages=self.messages, gaps=self.gaps, opened=self.opened)

    def _listen(self) -> None:
        place = urlsplit(self.host)
        scheme = "wss" if place.scheme == "https" else "ws"
        options = {"context": self.trusted} if scheme == "wss" else None
        address = f"{scheme}://{place.netloc}{self.path}"
        # In Python, letter by letter, the library's look at each word takes half of Locust's core; orjson looks itself.
        socket = create_connection(
            address, timeout=SILENT_S, cookie=self.cookies, origin=self.host, sslopt=options, skip_utf8_validation=True
        )
        self.opened += 1
        self._sequence = 0
        try:
            while True:
                kind, text = socket.recv_data()
                if kind == 8:
                    code = int.from_bytes(text[:2], "big")
                    self.closed = code if code in {4400, 4401, 4404} else 0
                    return
                self._take(orjson.loads(text), socket)
        finally:
            socket.close()

    def _take(self, message: dict[str, Any], socket: WebSocket) -> None:
        self.received_at_s = time.monotonic()
        self.messages += 1
        if message["type"] == "keepalive":
            if self._sequence and message["sequence"] != self._sequence:
                self._miss(message, socket)
            return
        if message["type"] == "snapshot":
            self.shown = {table: {entry["id"]: entry for entry in message["live"][table]} for table in TABLES}
        elif message["sequence"] != self._sequence + 1:
            self._miss(message, socket)
            return
        else:
            for table in TABLES:
                self.shown[table] |= {entry["id"]: entry for entry in message[table]}
                for gone in message["removed"][table]:
                    self.shown[table].pop(gone, None)
        self._sequence = message["sequence"]
        socket.send(orjson.dumps({"type": "ack", "sequence": self._sequence}).decode())

    def _miss(self, message: dict[str, Any], socket: WebSocket) -> None:
        self.gaps += 1
        self.book.note(kinds.GAP, by=self.by, expected=self._sequence + 1, got=message["sequence"])
        socket.send(orjson.dumps({"type": "resync"}).decode())
