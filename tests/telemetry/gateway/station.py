"""A gateway in a thread of the test, on ports of its own, and vehicles that talk to it by real sockets."""

import asyncio
import socket
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from django.contrib.gis.geos import Point
from django.db import connections
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message, frames_of_datagram, message_of
from mavlink.signing import FrameWriter
from missions.models import CredentialKind, Uav, UavType
from missions.services.fleet.credentials import make_credential
from telemetry.gateway.options import GatewayOptions, UdpAddress
from telemetry.gateway.process import Gateway
from workspace.models import User

TIMEOUT_S = 60.0


def wait_for(fact: Callable[[], Any], what: str = "", *, patience_s: float = TIMEOUT_S) -> Any:
    """What `fact` tells as soon as it is true."""
    until_s = time.monotonic() + patience_s
    while time.monotonic() < until_s:
        if found := fact():
            return found
        time.sleep(0.05)
    raise AssertionError(f"not within {patience_s:.0f} s: {what or fact}")


def unsigned_uav(system: int = 1, **values: Any) -> Uav:
    return _uav(system, allows_unsigned=True, **values)


def _uav(system: int, **values: Any) -> Uav:
    """One that can be planned: its type states that no range limits it."""
    unlimited, _is_new = UavType.objects.get_or_create(name="Unlimited", range_unlimited=True)
    return Uav.objects.create(name=f"UAV {system}", location=Point(0, 0), mavlink_system_id=system, **{"uav_type": unlimited} | values)


def signed_uav(system: int, actor: User) -> tuple[Uav, bytes]:
    uav = _uav(system)
    made = make_credential(uav=uav, actor=actor, kind=CredentialKind.MAVLINK_KEY)
    return uav, bytes.fromhex(made.secret)


@contextmanager
def gateway_at_work(log_dir: Path, *, name: str = "test", **options: Any) -> Iterator[Gateway]:
    """Ends it as SIGTERM does."""
    started = threading.Event()
    made: list[Any] = []

    def run() -> None:
        asyncio.run(serve())

    async def serve() -> None:
        gateway = Gateway(
            GatewayOptions(
                udp=[UdpAddress("127.0.0.1", 0)], tcp=[UdpAddress("127.0.0.1", 0)], name=name, log_dir=log_dir, flush_s=0.05, **options
            )
        )
        made.extend([gateway, asyncio.get_running_loop()])
        await gateway.run(on_listening=lambda _: started.set())

    thread = threading.Thread(target=run, name=f"gateway {name}")
    thread.start()
    try:
        assert started.wait(TIMEOUT_S), "the gateway does not listen"
        yield made[0]
    finally:
        if len(made) == 2:
            made[1].call_soon_threadsafe(made[0].stop)
        thread.join(TIMEOUT_S)
        connections.close_all()
        assert not thread.is_alive(), f"the gateway does not end: {asyncio.all_tasks(made[1])}"


def port_of(gateway: Gateway, transport: str = "udp") -> int:
    return next(int(name.rsplit(":", 1)[1]) for name in gateway.listening if name.startswith(transport))


@dataclass
class Link:
    """A vehicle's side of a link by UDP."""

    port: int
    system: int = 1
    key: bytes | None = None
    component: int = 1
    link_id: int = 0
    writer: FrameWriter = field(init=False)

    def __post_init__(self) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", self.port))
        self.socket.setblocking(False)
        self.writer = FrameWriter(self.system, self.component, self.link_id, self.key)

    def frame(self, message: Message, at_s: float | None = None) -> bytes:
        return self.writer.frame_of(message, time.time() if at_s is None else at_s)

    def send(self, *messages: Message) -> None:
        for message in messages:
            self.socket.send(self.frame(message))

    def send_raw(self, *datagrams: bytes) -> None:
        for datagram in datagrams:
            self.socket.send(datagram)

    def received(self) -> list[Message]:
        messages = []
        while True:
            try:
                datagram = self.socket.recv(65_535)
            except BlockingIOError:
                return messages
            messages += [message_of(frame) for frame in frames_of_datagram(datagram, Counter())]

    def close(self) -> None:
        self.socket.close()

    def __enter__(self) -> "Link":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def heartbeat(*, is_armed: bool = False, mode: int = 4, autopilot: int = mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA) -> Message:
    return mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, autopilot, 1 | (128 if is_armed else 0), mode, 4, 3)


def position(boot_ms: int, *, lon: float = 10.0, lat: float = 55.0) -> Message:
    return mavlink.MAVLink_global_position_int_message(boot_ms, round(lat * 1e7), round(lon * 1e7), 30_000, 20_000, 100, 0, 0, 9_000)
