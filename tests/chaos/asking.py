"""Clients of an installation: each keeps one connection, as a browser does, and tells what became of every question."""

import http.client
import json
import ssl
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Self

TIMEOUT_S = 60.0


@dataclass(frozen=True)
class Answer:
    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body)


class Client:
    """Raises OSError or http.client.HTTPException where no whole answer came; the next question begins with a new connection."""

    def __init__(self, port: int, trust: ssl.SSLContext | None, token: str = "", *, keeps: bool = True) -> None:
        self._port, self._trust, self._token, self._keeps = port, trust, token, keeps
        self._connection: http.client.HTTPConnection | None = None
        self.opened_again = 0

    def ask(self, method: str, path: str, body: Any = None, **headers: str) -> Answer:
        """A kept connection that was closed before any of the answer came is opened once more, as browsers do."""
        is_kept = self._connection is not None
        try:
            return self._ask(method, path, body, headers)
        except (ConnectionError, ssl.SSLEOFError):  # RemoteDisconnected is one
            if not is_kept:
                raise
            self.opened_again += 1
            return self._ask(method, path, body, headers)

    def _ask(self, method: str, path: str, body: Any, headers: Mapping[str, str]) -> Answer:
        connection = self._connection or self._open()
        head = {"Host": f"localhost:{self._port}", **({"Authorization": f"Bearer {self._token}"} if self._token else {}), **headers}
        try:
            if body is not None:
                head["Content-Type"] = "application/json"
            connection.request(method, path, None if body is None else json.dumps(body), head)
            answer = connection.getresponse()
            whole = Answer(answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read())
        except BaseException:
            self.close()
            raise
        if not self._keeps or answer.will_close:
            self.close()
        return whole

    def close(self) -> None:
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _open(self) -> http.client.HTTPConnection:
        if self._trust is None:
            self._connection = http.client.HTTPConnection("localhost", self._port, timeout=TIMEOUT_S)
        else:
            self._connection = http.client.HTTPSConnection("localhost", self._port, timeout=TIMEOUT_S, context=self._trust)
        return self._connection


@dataclass
class Askers:
    """Several clients that go on asking, each in a thread of its own: `make(number)` gives each its question.

    A question returns what is counted; what it raises is counted by its name. `waits_s` are those of whole answers.
    """

    make: Callable[[int], Callable[[], str]]
    number: int
    pause_s: float = 0.0
    counted: Counter[str] = field(default_factory=Counter)
    waits_s: list[tuple[float, float]] = field(default_factory=list)  # when it was asked (monotonic), how long it took
    faults: list[str] = field(default_factory=list)

    def __enter__(self) -> Self:
        self._ends = threading.Event()
        self._threads = [threading.Thread(target=self._run, args=(number,), name=f"asker {number}") for number in range(self.number)]
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._ends.set()
        for thread in self._threads:
            thread.join(2 * TIMEOUT_S)

    def _run(self, number: int) -> None:
        question = self.make(number)
        while not self._ends.wait(self.pause_s):
            began_s = time.monotonic()
            try:
                reported = question()
            except (OSError, http.client.HTTPException) as error:
                reported = type(error).__name__
                self.faults.append(f"{time.strftime('%H:%M:%S')} {error!r}")
                self._ends.wait(0.05)
            else:
                self.waits_s.append((began_s, time.monotonic() - began_s))
            self.counted[reported] += 1
