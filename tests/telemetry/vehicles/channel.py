"""A ground station and a vehicle that talk over a bad link, in simulated time."""

import heapq
import random
from dataclasses import dataclass, field
from itertools import count
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

GROUND_SYSTEM = 255


@dataclass(frozen=True)
class Link:
    """Shares of messages each way. What is reordered is held back, so that others overtake it."""

    loss: float = 0.0
    duplicates: float = 0.0
    reordered: float = 0.0
    latency_s: float = 0.02
    held_back_s: tuple[float, float] = (0.02, 0.15)


@dataclass
class Channel:
    """Everything goes through real frames: packed by one end, parsed by the other."""

    ground: Any
    vehicle: Any
    link: Link = field(default_factory=Link)
    seed: int = 0
    now_s: float = 0.0
    to_vehicle: list[Any] = field(default_factory=list)  # all that was sent, lost or not
    to_ground: list[Any] = field(default_factory=list)
    listeners: list[Any] = field(default_factory=list)  # hear what the ground station hears, before it
    ground_dies_after: int | None = None  # messages sent: then it sends and hears nothing more
    vehicle_dies_after: int | None = None  # messages heard

    def __post_init__(self) -> None:
        self._random = random.Random(self.seed)
        self._due: list[tuple[float, int, bool, bytes]] = []
        self._order = count()
        self._received = 0
        self._ground_frames = mavlink.MAVLink(None, srcSystem=GROUND_SYSTEM, srcComponent=mavlink.MAV_COMP_ID_MISSIONPLANNER)
        self._vehicle_frames = mavlink.MAVLink(None, srcSystem=self.vehicle.system, srcComponent=1)
        self._parser = mavlink.MAVLink(None)

    def run(self, until_s: float = 3_600.0) -> Any:
        """Until the ground station's outcome; returns it."""
        self._send(self.ground.start(self.now_s), to_vehicle=True)
        self._send(self.vehicle.start(self.now_s), to_vehicle=False)
        return self.go_on(until_s)

    def go_on(self, until_s: float = 3_600.0) -> Any:
        while self.ground.outcome is None and not self.is_ground_dead:
            times = [time for time in (self.ground.wake_at_s, self.vehicle.wake_at_s) if time is not None]
            times += [self._due[0][0]] if self._due else []
            if not times or min(times) > until_s:
                raise AssertionError(f"nothing more happens after {self.now_s:.1f} s")
            self.now_s = max(self.now_s, min(times))
            while self._due and self._due[0][0] <= self.now_s:
                self._arrive(*heapq.heappop(self._due)[2:])
            if self.vehicle.wake_at_s is not None and self.vehicle.wake_at_s <= self.now_s:
                self._send(self.vehicle.tick(self.now_s), to_vehicle=False)
            if self.ground.outcome is None and self.ground.wake_at_s is not None and self.ground.wake_at_s <= self.now_s:
                self._send(self.ground.tick(self.now_s), to_vehicle=True)
        return self.ground.outcome

    @property
    def is_ground_dead(self) -> bool:
        return self.ground_dies_after is not None and len(self.to_vehicle) > self.ground_dies_after

    def let_pass(self, seconds: float) -> None:
        """What is under way arrives at the vehicle, with nobody at the ground station."""
        end_s = self.now_s + seconds
        while True:
            times = [self._due[0][0]] if self._due else []
            times += [] if self.vehicle.wake_at_s is None else [self.vehicle.wake_at_s]
            if not times or min(times) > end_s:
                break
            self.now_s = max(self.now_s, min(times))
            while self._due and self._due[0][0] <= self.now_s:
                _, _, to_vehicle, frame = heapq.heappop(self._due)
                if to_vehicle:
                    self._arrive(True, frame)
            if self.vehicle.wake_at_s is not None and self.vehicle.wake_at_s <= self.now_s:
                self._send(self.vehicle.tick(self.now_s), to_vehicle=False)
        self.now_s = end_s

    def send(self, messages: list[Any]) -> None:
        """What the ground station says on its own account, such as to cancel."""
        self._send(messages, to_vehicle=True)

    def _arrive(self, to_vehicle: bool, frame: bytes) -> None:
        message = self._parser.parse_char(frame)
        assert message is not None
        if to_vehicle:
            self._received += 1
            if self.vehicle_dies_after is not None and self._received > self.vehicle_dies_after:
                self.vehicle.is_alive = False
            self._send(self.vehicle.receive(message, self.now_s), to_vehicle=False)
            self.vehicle._plan_wake()
        else:
            for listener in self.listeners:
                listener.receive(message, self.now_s)
            self._send(self.ground.receive(message, self.now_s), to_vehicle=True)

    def _send(self, messages: list[Any], *, to_vehicle: bool) -> None:
        sent, frames = (self.to_vehicle, self._ground_frames) if to_vehicle else (self.to_ground, self._vehicle_frames)
        for message in messages:
            sent.append(message)
            if to_vehicle and self.is_ground_dead:
                continue
            frame = bytes(message.pack(frames))
            frames.seq = (frames.seq + 1) % 256
            for _ in range(2 if self._random.random() < self.link.duplicates else 1):
                if self._random.random() < self.link.loss:
                    continue
                held_s = self._random.uniform(*self.link.held_back_s) if self._random.random() < self.link.reordered else 0.0
                heapq.heappush(self._due, (self.now_s + self.link.latency_s + held_s, next(self._order), to_vehicle, frame))
