"""One address for several gateways, as a cluster's Service gives it: a sender stays with one of them for as long as that one is there."""

import select
import socket
import threading
from dataclasses import dataclass, field

LOOK_S = 0.1


@dataclass
class Backend:
    """A gateway's own port. Without `is_there` it is taken off the address."""

    port: int
    is_there: bool = True


@dataclass
class OneAddress:
    """UDP, in both directions, in a thread of its own."""

    backends: list[Backend]
    _flows: dict[tuple[str, int], tuple[Backend, socket.socket]] = field(default_factory=dict)
    _turn: int = 0

    def __enter__(self) -> "OneAddress":
        self._front = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._front.bind(("127.0.0.1", 0))
        self.port = int(self._front.getsockname()[1])
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, name="the one address")
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join(60)
        for one in (self._front, *(flow for _, flow in self._flows.values())):
            one.close()

    def backend_of(self, sender: tuple[str, int]) -> Backend | None:
        return self._flows[sender][0] if sender in self._flows else None

    def _run(self) -> None:
        while not self._ends.is_set():
            senders = {flow: sender for sender, (_, flow) in self._flows.items()}
            for readable in select.select([self._front, *senders], [], [], LOOK_S)[0]:
                try:
                    datagram, sender = readable.recvfrom(65_535)
                except OSError:
                    continue  # nobody is there any more, or the flow has just been forgotten
                if readable is self._front:
                    self._pass_on(datagram, sender)
                else:
                    self._front.sendto(datagram, senders[readable])

    def _pass_on(self, datagram: bytes, sender: tuple[str, int]) -> None:
        if sender in self._flows and not self._flows[sender][0].is_there:
            self._flows.pop(sender)[1].close()  # the cluster forgets the flow
        there = [backend for backend in self.backends if backend.is_there]
        if not there:
            return
        if sender not in self._flows:
            backend, self._turn = there[self._turn % len(there)], self._turn + 1
            flow = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            flow.connect(("127.0.0.1", backend.port))
            self._flows[sender] = (backend, flow)
        try:
            self._flows[sender][1].send(datagram)
        except ConnectionError:
            return
