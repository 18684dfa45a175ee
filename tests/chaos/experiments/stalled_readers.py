"""R10: 500 live pages are open, ten of which read nothing any more, while UAVs report all the time."""

import asyncio
import base64
import os
import secrets
import ssl
import subprocess
import sys
import time
from dataclasses import dataclass, field
from typing import Any

import orjson

from benchmarks.telemetry.live_clients import Closed, Socket
from scripts.places import PROJECT_DIR
from tests.chaos.day import Day, working_day
from tests.chaos.experiment import Course, main
from tests.chaos.site import wait_until

PAGES, SHORT_PAGES = 500, 60
STALLED = 10
LASTS_S, SHORT_LASTS_S = 180.0, 20.0
SETTLES_S, SHORT_SETTLES_S = 60.0, 10.0
OPEN_WITHIN_S = 240.0
MAX_AHEAD = 2**16  # bytes that come in before a page that reads nothing takes no more
AT_ONCE = 20  # pages that open at the same time
MAX_GROWTH = 0.05
COUNTS = {"worker-data": 0, "worker-flight": 0, "worker-planning": 0, "worker-simulation": 0, "simulator": 0, "beat": 0}


@dataclass
class Reader:
    """One page; a stalled one reads nothing until it is told to go on."""

    token: str
    stalls: bool = False
    gaps: int = 0
    messages: int = 0
    snapshots: int = 0
    error: str = ""
    is_open: asyncio.Event = field(default_factory=asyncio.Event)
    goes_on: asyncio.Event = field(default_factory=asyncio.Event)
    _sequence: int = 0

    async def listen(self, port: int, trust: ssl.SSLContext, endpoint: asyncio.Semaphore) -> None:
        try:
            async with endpoint:
                socket = await _open(port, trust, self.token)
                self._take(orjson.loads(await socket.receive()), socket)
            self.is_open.set()
            if self.stalls:
                await self.goes_on.wait()
            while True:
                self._take(orjson.loads(await socket.receive()), socket)
        except (Closed, OSError, asyncio.IncompleteReadError) as error:
            self.error = repr(error)
            self.is_open.set()

    def _take(self, message: dict[str, Any], socket: Socket) -> None:
        self.messages += 1
        if message["type"] == "snapshot":
            self.snapshots += 1
        elif message["type"] == "changes":
            self.gaps += message["sequence"] != self._sequence + 1
        if message["type"] != "keepalive":
            self._sequence = message["sequence"]
            socket.report({"type": "ack", "sequence": self._sequence})


async def _open(port: int, trust: ssl.SSLContext, token: str) -> Socket:
    reader, writer = await asyncio.open_connection("localhost", port, ssl=trust, limit=MAX_AHEAD)
    key = base64.b64encode(secrets.token_bytes(16)).decode()
    head = f"GET /ws/live HTTP/1.1\r\nHost: localhost:{port}\r\nAuthorization: Bearer {token}\r\nConnection: Upgrade\r\n"
    writer.write(f"{head}Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n".encode())
    answer = await reader.readuntil(b"\r\n\r\n")
    if b" 101 " not in answer.split(b"\r\n", 1)[0]:
        raise Closed(answer.split(b"\r\n", 1)[0].decode())
    return Socket(reader, writer)


def run(course: Course) -> None:
    with working_day("readers", course, COUNTS) as day:
        asyncio.run(_watch(course, day))


async def _watch(course: Course, day: Day) -> None:
    number, lasts_s, settles_s = (SHORT_PAGES, SHORT_LASTS_S, SHORT_SETTLES_S) if course.is_short else (PAGES, LASTS_S, SETTLES_S)
    installation, tokens = day.installation, day.site.people["operators"]
    host, port = installation.address_for_uavs()
    fleet = subprocess.Popen(  # noqa: ASYNC220, S603
        [sys.executable, "-m", "deploy.load.day.fleet", "--day", str(day.folder), "--udp", f"{host}:{port}"],
        cwd=PROJECT_DIR, env=os.environ | {"PYTHONPATH": str(PROJECT_DIR)},
    )  # fmt: skip
    try:
        began_s = time.time()
        await asyncio.to_thread(wait_until, lambda: (at := day.newest_record_at()) is not None and at.timestamp() > began_s, "reports")
        stalled = set(course.chance.sample(range(number), STALLED))
        readers = [Reader(tokens[index % len(tokens)], stalls=index in stalled) for index in range(number)]
        endpoint, trust = asyncio.Semaphore(AT_ONCE), installation.trust()
        listening = [asyncio.create_task(reader.listen(installation.port, trust, endpoint)) for reader in readers]
        all_open = asyncio.gather(*(reader.is_open.wait() for reader in readers))
        async with asyncio.timeout(OPEN_WITHIN_S):
            await all_open
        await asyncio.sleep(settles_s)
        before = await asyncio.to_thread(lambda: installation.usage()["live"].resident_bytes)
        received_before = sum(reader.messages for reader in readers)
        await asyncio.sleep(lasts_s)
        after = await asyncio.to_thread(lambda: installation.usage()["live"].resident_bytes)
        received = sum(reader.messages for reader in readers) - received_before
        for reader in readers:
            reader.goes_on.set()
        came_back = [reader for reader in readers if reader.stalls]
        seen = [reader.messages for reader in came_back]
        await asyncio.sleep(15.0)
        woken = sum(reader.messages > had or bool(reader.error) for reader, had in zip(came_back, seen, strict=True))
        for task in listening:
            task.cancel()
        await asyncio.gather(*listening, return_exceptions=True)
    finally:
        fleet.terminate()
        fleet.wait(30)
    _notify(course, readers, woken, received / lasts_s, lasts_s)
    growth = after / before - 1
    figure = f"{before / 2**20:.0f} MiB, {growth:+.1%} in {lasts_s:.0f} s"
    course.record("memory of the live program", figure, f"+{MAX_GROWTH:.0%} at most", growth <= MAX_GROWTH)


def _notify(course: Course, readers: list[Reader], woken: int, received_per_s: float, lasts_s: float) -> None:
    awake, stalled = [one for one in readers if not one.stalls], [one for one in readers if one.stalls]
    cut, gaps = [one.error for one in awake if one.error], sum(one.gaps for one in awake)
    figure = (
        f"{gaps} gaps, {len(cut)} cut off {cut[:2] or ''}; each told {received_per_s / len(awake):.1f} times a second for {lasts_s:.0f} s"
    )
    is_met = not gaps and not cut and received_per_s > 0
    course.record(f"{len(awake)} pages beside {STALLED} that read nothing", figure, "0 gaps, none cut off", is_met)
    again, gaps = sum(one.snapshots > 1 for one in stalled), sum(one.gaps for one in stalled)
    figure = f"{woken} of {STALLED} told the latest, or hung up on, once they read again ({again} by a whole snapshot); {gaps} gaps"
    course.record("those that read nothing", figure, "all, 0 gaps", woken == STALLED and not gaps)


if __name__ == "__main__":
    main(run)
