"""UDP between a firmware and a gateway, by which a share of the frames gets lost each way."""

import random
import select
import socket
import threading
from collections import Counter
from dataclasses import dataclass

from missions.mavlink.frames import frames_of_datagram

LOOK_S = 0.1


@dataclass
class LossyLink:
    """For one vehicle, in a thread of its own. What arrives has one frame in each datagram."""

    gateway_port: int
    loss: float
    seed: int = 1
    lost: int = 0

    def __enter__(self) -> "LossyLink":
        self._front, self._back = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
        self._front.bind(("127.0.0.1", 0))
        self._back.connect(("127.0.0.1", self.gateway_port))
        self.port = int(self._front.getsockname()[1])
        self._chance = random.Random(self.seed)
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, name="a lossy link")
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join(10)
        self._front.close()
        self._back.close()

    def _run(self) -> None:
        vehicle = None
        while not self._ends.is_set():
            for readable in select.select([self._front, self._back], [], [], LOOK_S)[0]:
                try:
                    datagram, sender = readable.recvfrom(65_535)
                    if readable is self._front:
                        vehicle = sender
                    for frame in self._kept(datagram):
                        if readable is self._front:
                            self._back.send(frame)
                        elif vehicle is not None:
                            self._front.sendto(frame, vehicle)
                except ConnectionError:
                    continue  # nobody listens there now

    def _kept(self, datagram: bytes) -> list[bytes]:
        frames = [bytes(frame.raw) for frame in frames_of_datagram(datagram, Counter())]
        kept = [frame for frame in frames if self._chance.random() >= self.loss]
        self.lost += len(frames) - len(kept)
        return kept
