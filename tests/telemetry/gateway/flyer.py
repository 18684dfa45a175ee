"""A scripted vehicle on a real socket, in a thread of its own: it hears, answers and reports as time goes by."""

import random
import threading
import time
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.telemetry.gateway.station import Link, position
from tests.telemetry.vehicles.vehicle import Vehicle

LOOP_S = 0.005


@dataclass
class Flyer:
    """`loss` is the share of messages that get lost, each way. Positions are told five times a second."""

    vehicle: Vehicle
    port: int
    key: bytes | None = None
    at: tuple[float, float] = (10.0, 55.0)
    altitude_amsl_m: float = 30.0
    height_m: float | None = None  # above home; None: as station.position has it
    loss: float = 0.0
    seed: int = 1
    received: list[Any] = field(default_factory=list)
    is_silent: bool = False
    is_unacknowledged: bool = False  # it hears, and nothing that it says arrives
    booted_s: float = field(default_factory=time.monotonic)

    def __enter__(self) -> "Flyer":
        self.vehicle.heartbeats = True
        self._chance = random.Random(self.seed)
        self._ends = threading.Event()
        self._lock = threading.Lock()
        self._link = Link(self.port, self.vehicle.system, self.key)
        self._thread = threading.Thread(target=self._run, name=f"vehicle {self.vehicle.system}")
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join(10)
        self._link.close()

    def move_to(self, port: int) -> None:
        """Another gateway's."""
        with self._lock:
            self._link.socket.connect(("127.0.0.1", port))

    def report(self, *messages: Any) -> None:
        """Besides what it says by itself."""
        self._send(list(messages))

    def _run(self) -> None:
        next_position_s = 0.0
        while not self._ends.wait(LOOP_S):
            now_s = time.monotonic()
            for message in self._received():
                self.received.append(message)
                self._send(self.vehicle.receive(message, now_s))
            self._send(self.vehicle.tick(now_s))
            if now_s >= next_position_s:
                next_position_s = now_s + 0.2
                self._send(self._reports(now_s))

    def _reports(self, now_s: float) -> list[Any]:
        boot_ms = int((now_s - self.booted_s) * 1000)
        reported = position(boot_ms, lon=self.at[0], lat=self.at[1])
        reported.alt = round(self.altitude_amsl_m * 1000)
        reported.relative_alt = reported.relative_alt if self.height_m is None else round(self.height_m * 1000)
        home = mavlink.MAVLink_home_position_message(reported.lat, reported.lon, reported.alt, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0)
        return [reported, home]

    def _received(self) -> list[Any]:
        with self._lock:
            try:
                messages = self._link.received()
            except ConnectionError:
                return []
        return [] if self.is_silent else [message for message in messages if self._chance.random() >= self.loss]

    def _send(self, messages: list[Any]) -> None:
        for message in messages:
            if self.is_silent or self.is_unacknowledged or self._chance.random() < self.loss:
                continue
            with self._lock:
                try:
                    self._link.send(message)
                except ConnectionError:
                    continue
