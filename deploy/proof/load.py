"""People at work while pods are killed: pages, lists and plans, asked over one proxy; every answer is counted."""

import http.client
import json
import ssl
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

TIMEOUT_S = 60.0


@dataclass
class Proxy:
    """How the proxy is reached. Without `trust` somebody in front of it has taken the TLS off, as an Ingress does."""

    address: str
    port: int
    token: str
    trust: ssl.SSLContext | None = None
    host: str = "spanwise.example.org"

    def connect(self) -> http.client.HTTPConnection:
        if self.trust is None:
            return http.client.HTTPConnection(self.address, self.port, timeout=TIMEOUT_S)
        return http.client.HTTPSConnection(self.address, self.port, timeout=TIMEOUT_S, context=self.trust)

    def ask(self, connection: http.client.HTTPConnection, method: str, path: str, body: Any = None) -> tuple[int, bytes]:
        headers = {"Host": self.host, "Authorization": f"Bearer {self.token}"}
        if self.trust is None:
            headers |= {"X-Forwarded-Proto": "https", "X-Forwarded-For": "192.0.2.1"}
        text = None if body is None else json.dumps(body).encode()
        connection.request(method, path, text, headers | ({"Content-Type": "application/json"} if text else {}))
        answer = connection.getresponse()
        return answer.status, answer.read()


@dataclass
class Counted:
    """What came back."""

    answers: Counter[int] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    slowest_s: float = 0.0
    lock: threading.Lock = field(default_factory=threading.Lock)

    def add(self, status: int, took_s: float) -> None:
        with self.lock:
            self.answers[status] += 1
            self.slowest_s = max(self.slowest_s, took_s)

    def fault(self, text: str) -> None:
        with self.lock:
            self.faults.append(text)

    @property
    def failed(self) -> int:
        return len(self.faults) + sum(count for status, count in self.answers.items() if status != 200)

    def __str__(self) -> str:
        whole = sum(self.answers.values()) + len(self.faults)
        return f"{whole} requests, {self.failed} failed, slowest {self.slowest_s:.2f} s"


def plan_bodies(proxy: Proxy) -> list[dict[str, Any]]:
    """Four towers and two UAVs beside them, several times over, from what the site has."""
    connection = proxy.connect()
    status, text = proxy.ask(connection, "GET", "/api/v1/assets?kind=tower&limit=100")
    if status != 200:
        raise RuntimeError(f"assets: {status} {text[:200]!r}")
    features = json.loads(text)["features"]
    connection.close()
    found = []
    for first in range(0, len(features) - 4, 4):
        some = features[first : first + 4]
        starts = [some[0]["geometry"]["coordinates"][:2], some[3]["geometry"]["coordinates"][:2]]
        uavs = [{"name": f"UAV {number}", "position": start} for number, start in enumerate(starts, 1)]
        found.append({"uavs": uavs, "targets": [{"asset": feature["id"]} for feature in some]})
    return found


def under_load(proxy: Proxy, bodies: list[dict[str, Any]], people: int, lasts_s: float, meanwhile: Callable[[], None]) -> Counted:
    """`people` ask one thing after the other for so long; `meanwhile` runs after a third of the time. Each request has a connection of its
    own now and then, as browsers do.
    """
    counted, end_s = Counted(), time.monotonic() + lasts_s

    def work(number: int) -> None:
        turn, connection = number, proxy.connect()
        while time.monotonic() < end_s:
            turn += 1
            body = bodies[turn % len(bodies)]
            asked = [("POST", "/api/v1/plans", body), ("GET", "/api/v1/uavs", None), ("GET", "/sign-in", None)][turn % 3]
            began_s = time.monotonic()
            try:
                status, text = proxy.ask(connection, *asked)
            except (OSError, http.client.HTTPException) as error:
                counted.fault(f"{asked[0]} {asked[1]}: {error!r}")
                connection.close()
            else:
                counted.add(status, time.monotonic() - began_s)
                if status != 200:
                    counted.fault(f"{asked[0]} {asked[1]}: {status} {text[:120]!r}")
                    counted.answers[status] -= 1
            if turn % 20 == 0:
                connection.close()
        connection.close()

    threads = [threading.Thread(target=work, args=(number,)) for number in range(people)]
    for thread in threads:
        thread.start()
    time.sleep(lasts_s / 3)
    meanwhile()
    for thread in threads:
        thread.join()
    return counted
