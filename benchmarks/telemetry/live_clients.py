"""Open live pages without a browser: many websockets in one loop, each doing what static/js/live does with every word.

Run as a process of its own by live_pages.py; what it saw goes back as JSON on its output.
"""

import argparse
import asyncio
import base64
import os
import secrets
import struct
import sys
import time
from dataclasses import dataclass, field
from typing import Any

import orjson

TEXT, CLOSE, PING, PONG = 1, 8, 9, 10
PER_DEGREE = 10_000_000  # a millisecond later is a ten-millionth degree further east


class Closed(Exception):
    """The server hung up, or refused."""


@dataclass
class Socket:
    """As much of RFC 6455 as a page needs."""

    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter

    @classmethod
    async def open(cls, port: int, path: str, cookie: str) -> "Socket":
        reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=2**24)
        key = base64.b64encode(secrets.token_bytes(16)).decode()
        host = f"127.0.0.1:{port}"
        head = f"GET {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nCookie: {cookie}\r\nConnection: Upgrade\r\n"
        head += f"Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n"
        writer.write(head.encode())
        answer = await reader.readuntil(b"\r\n\r\n")
        if b" 101 " not in answer.split(b"\r\n", 1)[0]:
            raise Closed(answer.split(b"\r\n", 1)[0].decode())
        return cls(reader, writer)

    async def receive(self) -> bytes:
        """The next text. Raises Closed."""
        whole = b""
        while True:
            first, second = await self.reader.readexactly(2)
            length = second & 127
            if length > 125:
                length = int.from_bytes(await self.reader.readexactly(2 if length == 126 else 8), "big")
            part = await self.reader.readexactly(length)
            kind = first & 15
            if kind == CLOSE:
                raise Closed(str(int.from_bytes(part[:2], "big")))
            if kind == PING:
                self._send(PONG, part)
            elif kind in (0, TEXT):
                whole += part
                if first & 128:
                    return whole

    def report(self, value: object) -> None:
        self._send(TEXT, orjson.dumps(value))

    def _send(self, kind: int, text: bytes) -> None:
        mask = os.urandom(4)
        head = struct.pack("!BB", 128 | kind, 128 | len(text)) + mask  # words of pages are short
        self.writer.write(head + bytes(byte ^ mask[place % 4] for place, byte in enumerate(text)))


@dataclass
class Page:
    """What one page saw: how long each report of a UAV took to it [ms], and which it saw of each."""

    first: dict[int, int]  # longitude by UAV of what was sent at the start, in ten-millionth degrees
    waits_ms: list[int] = field(default_factory=list)
    seen: dict[int, set[int]] = field(default_factory=dict)
    gaps: int = 0
    bytes: int = 0
    messages: int = 0
    error: str = ""
    _sequence: int = 0

    async def listen(self, port: int, path: str, cookie: str, began_s: float) -> None:
        try:
            socket = await Socket.open(port, path, cookie)
            while True:
                text = await socket.receive()
                self.take(orjson.loads(text), began_s)
                self.bytes += len(text)
                socket.report({"type": "ack", "sequence": self._sequence})
        except (Closed, OSError, asyncio.IncompleteReadError) as error:
            self.error = repr(error)

    def take(self, value: dict[str, Any], began_s: float) -> None:
        now_ms = (time.monotonic() - began_s) * 1000
        if value["type"] == "keepalive":
            return
        self.messages += 1
        if value["type"] == "changes":
            self.gaps += value["sequence"] != self._sequence + 1
        self._sequence = value["sequence"]
        for uav in value["live"]["uavs"] if value["type"] == "snapshot" else value["uavs"]:
            if (measured := uav["measured"]) is None:
                continue
            sent_ms = round(measured["position"][0] * PER_DEGREE) - self.first[uav["id"]]
            own = self.seen.setdefault(uav["id"], set())
            if sent_ms not in own:
                own.add(sent_ms)
                if value["type"] == "changes":
                    self.waits_ms.append(round(now_ms - sent_ms))


async def open_pages(options: argparse.Namespace, first: dict[int, int], cookies: list[str]) -> list[Page]:
    pages = [Page(first) for _ in cookies]
    listening = [
        asyncio.create_task(page.listen(options.port, options.path, cookie, options.began))
        for page, cookie in zip(pages, cookies, strict=True)
    ]
    print("open", flush=True)
    await asyncio.to_thread(sys.stdin.readline)  # until it is told to stop
    for task in listening:
        task.cancel()
    return pages


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--path", default="/ws/live")
    parser.add_argument("--began", type=float, required=True, help="CLOCK_MONOTONIC at which sending began [s]")
    options = parser.parse_args()
    first = {int(uav): first for uav, first in orjson.loads(sys.stdin.readline()).items()}
    pages = asyncio.run(open_pages(options, first, sys.stdin.readline().split()))
    reported = [
        {
            "waits_ms": page.waits_ms,
            "seen": {str(uav): sorted(seen) for uav, seen in page.seen.items()},
            "gaps": page.gaps,
            "bytes": page.bytes,
            "messages": page.messages,
            "error": page.error,
        }
        for page in pages
    ]
    sys.stdout.buffer.write(orjson.dumps(reported) + b"\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
