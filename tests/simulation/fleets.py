"""Simulated UAVs in a thread of the test, faster than real time, on sockets of the loopback."""

import socket
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from inspection.geodesy import LonLat
from simulation.vehicle_endpoint.fleet import SimulatedFleet
from simulation.vehicle_endpoint.launch import Launch, fleet_of

AT = LonLat(10.4, 55.4)
TIMEOUT_S = 60.0


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def flying(launches: Sequence[Launch], *, speed: float) -> Iterator[SimulatedFleet]:
    fleet = fleet_of(launches, speed=speed)
    thread = threading.Thread(target=fleet.run, name="fleet")
    thread.start()
    try:
        yield fleet
    finally:
        fleet.end()
        thread.join(TIMEOUT_S)
        fleet.close()
        assert not thread.is_alive(), "the fleet does not end"


def wait_for(fact: Callable[[], Any], what: str = "", *, patience_s: float = TIMEOUT_S) -> Any:
    """What `fact` tells as soon as it is true."""
    until_s = time.monotonic() + patience_s
    while time.monotonic() < until_s:
        if found := fact():
            return found
        time.sleep(0.01)
    raise AssertionError(f"not within {patience_s:.0f} s: {what or fact}")
