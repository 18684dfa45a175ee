"""A radio between a vehicle and a gateway, by which a share of the frames gets lost each way, by UDP or TCP."""

import contextlib
import random
import select
import socket
import threading
from collections import Counter
from dataclasses import dataclass

from mavlink.frames import Frame, StreamParser, frames_of_datagram

LOOK_S = 0.1
PIECE = 65_535


@dataclass
class LossyLink:
    """For one vehicle, in a thread of its own. The vehicle's end stays when the gateway's is gone, and looks for the next gateway there.

    By UDP what arrives has one frame in each datagram.
    """

    gateway_port: int
    loss: float
    transport: str = "udp"
    seed: int = 1
    lost: int = 0

    def __enter__(self) -> "LossyLink":
        kind = socket.SOCK_DGRAM if self.transport == "udp" else socket.SOCK_STREAM
        self._front = socket.socket(socket.AF_INET, kind)
        self._front.bind(("127.0.0.1", 0))
        self.port = int(self._front.getsockname()[1])
        self._chance = random.Random(self.seed)
        self._ends = threading.Event()
        run = self._run
        if self.transport == "udp":
            self._back = socket.socket(socket.AF_INET, kind)
            self._back.connect(("127.0.0.1", self.gateway_port))
        else:
            self._front.listen(1)
            self._front.settimeout(LOOK_S)
            run = self._run_tcp
        self._thread = threading.Thread(target=run, name="a lossy link")
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join(10)
        self._front.close()
        if self.transport == "udp":
            self._back.close()

    def _run(self) -> None:
        vehicle = None
        while not self._ends.is_set():
            for readable in select.select([self._front, self._back], [], [], LOOK_S)[0]:
                try:
                    datagram, sender = readable.recvfrom(PIECE)
                    if readable is self._front:
                        vehicle = sender
                    for frame in self._kept(frames_of_datagram(datagram, Counter())):
                        if readable is self._front:
                            self._back.send(frame)
                        elif vehicle is not None:
                            self._front.sendto(frame, vehicle)
                except ConnectionError:
                    continue  # nobody listens there now

    def _run_tcp(self) -> None:
        vehicle = self._accepted()
        while vehicle is not None and not self._ends.is_set():
            try:
                with socket.create_connection(("127.0.0.1", self.gateway_port), LOOK_S) as gateway:
                    self._join(vehicle, gateway)
            except OSError:
                self._ends.wait(LOOK_S)
        if vehicle is not None:
            vehicle.close()

    def _accepted(self) -> socket.socket | None:
        while not self._ends.is_set():
            with contextlib.suppress(TimeoutError):
                return self._front.accept()[0]
        return None

    def _join(self, vehicle: socket.socket, gateway: socket.socket) -> None:
        """Until the gateway closes its end. Raises OSError."""
        parsers = {vehicle: StreamParser(), gateway: StreamParser()}
        while not self._ends.is_set():
            for readable in select.select(list(parsers), [], [], LOOK_S)[0]:
                piece = readable.recv(PIECE)
                if not piece:
                    return
                frames = self._kept(parsers[readable].receive(piece))
                (gateway if readable is vehicle else vehicle).sendall(b"".join(frames))

    def _kept(self, frames: list[Frame]) -> list[bytes]:
        kept = [bytes(frame.raw) for frame in frames if self._chance.random() >= self.loss]
        self.lost += len(frames) - len(kept)
        return kept
