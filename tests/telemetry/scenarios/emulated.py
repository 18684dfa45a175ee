"""The scripted ArduCopter on a socket, driven by tests as the real firmware is (tests.telemetry.scenarios.firmware)."""

import contextlib
import socket
import threading
import time
from dataclasses import dataclass, field
from typing import Any

from mavlink.frames import StreamParser, message_of
from mavlink.mission_sync.wire import OnboardItem
from mavlink.signing import FrameWriter
from mavlink.vehicle_plan import MissionType
from tests.missions.worlds import UAV_AT
from tests.telemetry.scenarios.vehicle import HOME_AMSL_M
from tests.telemetry.vehicles.copter import FlyingCopter

LOOP_S = 0.005
MAX_GROUND_SPEED = 4.0  # armed, it disarms itself after 10 s of its own time


@dataclass
class Emulated:
    """`transport` is udp or tcp; `speed` is simulated seconds in a second, in the air."""

    port: int
    transport: str = "udp"
    system: int = 7
    at: tuple[float, float] = UAV_AT
    speed: float = 20.0
    parameters: dict[str, float] = field(default_factory=dict)

    def __enter__(self) -> "Emulated":
        self._vehicle = FlyingCopter(system=self.system, at=self.at, home_amsl_m=HOME_AMSL_M, parameters=self.parameters)
        self._writer = FrameWriter(self.system, 1, 0, None)
        self._parser = StreamParser()
        self._now_s = 0.0
        self._lock = threading.Lock()
        self._ends = threading.Event()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM if self.transport == "udp" else socket.SOCK_STREAM)
        self._socket.connect(("127.0.0.1", self.port))
        self._socket.settimeout(LOOP_S)
        self._thread = threading.Thread(target=self._run, name=f"vehicle {self.system}")
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join(10)
        self._socket.close()

    def _run(self) -> None:
        before_s = time.monotonic()
        while not self._ends.is_set():
            messages = self._received()
            now_s = time.monotonic()
            speed = self.speed if self._vehicle.is_in_air else min(self.speed, MAX_GROUND_SPEED)
            self._now_s, before_s = self._now_s + (now_s - before_s) * speed, now_s
            with self._lock:
                answers = [answer for message in messages for answer in self._vehicle.receive(message, self._now_s)]
                answers += self._vehicle.tick(self._now_s)
            for answer in answers:
                with contextlib.suppress(OSError):
                    self._socket.send(self._writer.frame_of(answer, time.time()))

    def _received(self) -> list[Any]:
        try:
            piece = self._socket.recv(65_535)
        except (TimeoutError, ConnectionError):
            time.sleep(LOOP_S / 5)
            return []
        return [message_of(frame) for frame in self._parser.receive(piece)]

    def reboot(self) -> None:
        """Somebody insists on it in flight."""
        with self._lock:
            self._vehicle.reboot()

    def lose_power(self) -> None:
        """For a moment."""
        self.reboot()

    def set(self, name: str, value: float) -> None:
        if name == "SIM_SPEEDUP":
            self.speed = value
            return
        with self._lock:
            assert name in self._vehicle.parameters, f"the scripted vehicle knows no {name}"
            self._vehicle.parameters[name] = value

    def held(self, kind: MissionType) -> list[OnboardItem]:
        with self._lock:
            return self._vehicle.held(kind)

    def shorten(self) -> None:
        """Another ground station takes the last item off its mission."""
        with self._lock:
            del self._vehicle.lists[MissionType.MISSION][-1]

    @property
    def is_armed(self) -> bool:
        return self._vehicle.is_armed

    @property
    def custom_mode(self) -> int:
        return self._vehicle.custom_mode

    @property
    def height_m(self) -> float:
        """Above its home."""
        return self._vehicle.height_m

    @property
    def place(self) -> tuple[float, float]:
        return self._vehicle.place

    @property
    def is_ready(self) -> bool:
        return self._vehicle.is_ready
