"""Connections by TCP that were left half open, that take nothing, and that are too many: none holds up another."""

import asyncio
import socket
import time

import pytest

from mavlink.frames import Frame
from mavlink.signing import FrameWriter
from telemetry.gateway import peers
from telemetry.gateway.options import UdpAddress
from telemetry.gateway.peers import Listeners
from tests.telemetry.gateway.station import heartbeat

BEAT = FrameWriter(7, 1).frame_of(heartbeat(), 0.0)


async def until(fact, *, patience_s: float = 10.0) -> None:
    until_s = time.monotonic() + patience_s
    while not fact():
        assert time.monotonic() < until_s
        await asyncio.sleep(0.01)


@pytest.fixture
def received() -> list[tuple[Frame, peers.Peer]]:
    return []


@pytest.fixture
def listeners(received) -> Listeners:
    return Listeners(lambda frames, peer, _: received.extend((frame, peer) for frame in frames))


async def connected(listeners: Listeners) -> tuple[int, socket.socket]:
    (name,) = await listeners.open([], [UdpAddress("127.0.0.1", 0)])
    port = int(name.rsplit(":", 1)[1])
    return port, another(port)


def another(port: int) -> socket.socket:
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4_096)
    connection.connect(("127.0.0.1", port))
    connection.sendall(BEAT)
    return connection


def test_one_that_takes_nothing_gets_whole_frames_or_none_and_holds_up_nobody(listeners, received):
    async def run() -> None:
        port, slow = await connected(listeners)
        await until(lambda: received)
        _, peer = received[0]
        began_s = time.monotonic()
        for _ in range(200_000):
            peer.send(BEAT)
        assert peer.writer.transport.get_write_buffer_size() < peers.MAX_UNSENT + len(BEAT)
        assert time.monotonic() - began_s < 8.0, "it is not waited for"
        with another(port):
            await until(lambda: len(received) == 2)
        slow.settimeout(0.5)
        taken = b""
        try:
            while piece := await asyncio.to_thread(slow.recv, 65_536):
                taken += piece
        except TimeoutError:
            pass
        assert len(taken) > peers.MAX_UNSENT // 2
        assert taken == BEAT * (len(taken) // len(BEAT)), "no frame is cut"
        slow.close()
        listeners.close()

    asyncio.run(run())


def test_one_that_was_left_half_open_is_given_up(listeners, received, monkeypatch):
    monkeypatch.setattr(peers, "SILENT_CONNECTION_S", 0.3)

    async def run() -> None:
        _, half_open = await connected(listeners)
        await until(lambda: received)
        await until(lambda: not listeners._connections)
        received[0][1].send(BEAT)  # whoever still has it says it to nobody
        half_open.close()
        listeners.close()

    asyncio.run(run())


def test_who_fills_all_connections_does_not_keep_a_vehicle_out(listeners, received, monkeypatch):
    monkeypatch.setattr(peers, "MAX_CONNECTIONS", 5)

    async def run() -> None:
        port, vehicle = await connected(listeners)
        await until(lambda: received)
        idle = []
        for number in range(20):
            vehicle.sendall(BEAT)
            await until(lambda number=number: len(received) >= number + 2)
            connection = socket.create_connection(("127.0.0.1", port))
            idle.append(connection)
            own = connection.getsockname()
            await until(lambda own=own: own in [writer.get_extra_info("peername") for writer in listeners._connections])
        assert len(listeners._connections) == 5
        before = len(received)
        with another(port):
            await until(lambda: len(received) == before + 1)
            vehicle.sendall(BEAT)
            await until(lambda: len(received) == before + 2)
        for connection in (vehicle, *idle):
            connection.close()
        listeners.close()

    asyncio.run(run())
