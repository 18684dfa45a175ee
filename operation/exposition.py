"""A small HTTP server in each process: `/metrics` for Prometheus, `/healthz` and `/readyz` for probes."""

import json
import logging
import os
import socket
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from django.db import connections
from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, generate_latest
from prometheus_client.multiprocess import MultiProcessCollector
from prometheus_client.registry import REGISTRY

from operation import loop_heartbeats
from operation.address import Address, address_of_environment
from operation.metrics import BUILD, PROCESSES_FOLDER
from operation.readiness import Readiness
from operation.version import VERSION

logger = logging.getLogger(__name__)

AGAIN_AFTER_S = 2.0  # while another process, usually the previous one, still holds the address
MAX_REQUEST_S = 10.0


class _Handler(BaseHTTPRequestHandler):
    """Serves three paths and writes no access log."""

    server: "_Server"
    timeout = MAX_REQUEST_S

    def do_GET(self) -> None:
        path = self.path.partition("?")[0]
        if path == "/metrics":
            self._answer(200, CONTENT_TYPE_LATEST, metrics_text())
        elif path == "/healthz":
            self._notify("alive", [f"{loop} hangs" for loop in loop_heartbeats.hanging()])
        elif path == "/readyz":
            try:
                self._notify("ready", self.server.readiness.faults())
            finally:
                connections.close_all()  # only this thread's
        else:
            self._answer(404, "text/plain", b"/metrics, /healthz, /readyz\n")

    def do_HEAD(self) -> None:
        self.do_GET()

    def _notify(self, what: str, faults: list[str]) -> None:
        reported: dict[str, Any] = {what: not faults} | ({"reasons": faults} if faults else {})
        self._answer(503 if faults else 200, "application/json", json.dumps(reported).encode())

    def _answer(self, status: int, media_type: str, body: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", media_type)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)

    def address_string(self) -> str:
        return "-"  # a unix socket has none

    def log_message(self, format: str, *args: object) -> None:
        pass


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    block_on_close = False
    allow_reuse_address = True

    def __init__(self, address: Address, readiness: Readiness) -> None:
        self.readiness = readiness
        self.address_family = socket.AF_UNIX if address.path else socket.AF_INET6 if ":" in address.host else socket.AF_INET
        super().__init__(address.path or (address.host, address.port), _Handler)  # type: ignore[arg-type]

    def handle_error(self, request: object, client_address: object) -> None:
        """Ignore clients that disconnected before the response."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            logger.exception("a question about how this program does was not answered")

    def server_bind(self) -> None:
        if self.address_family != socket.AF_UNIX:
            super().server_bind()
            return
        path = str(self.server_address)
        with suppress(FileNotFoundError):
            Path(path).unlink()  # left by a killed process
        self.socket.bind(path)
        Path(path).chmod(0o600)
        self.server_name, self.server_port = "localhost", 0


class Exposition:
    """Serves from `start` until `close`. It never blocks the program: a failed bind is retried in the background."""

    def __init__(self, address: Address, readiness: Readiness) -> None:
        self.address = address
        self._readiness = readiness
        self._closed = threading.Event()
        self._server: _Server | None = None
        self.listening = threading.Event()

    def start(self) -> None:
        threading.Thread(target=self._run, name="metrics", daemon=True).start()

    def close(self) -> None:
        self._closed.set()
        if self._server is not None:
            self._server.shutdown()
            self._server.server_close()
            if self.address.path:
                Path(self.address.path).unlink(missing_ok=True)

    @property
    def port(self) -> int:
        """Return the assigned port, where port 0 was requested."""
        return int(self._server.server_address[1]) if self._server is not None else self.address.port

    def _run(self) -> None:
        has_complained = False
        while not self._closed.is_set():
            try:
                self._server = _Server(self.address, self._readiness)
            except OSError as error:
                if not has_complained:
                    has_complained = True
                    logger.warning("metrics cannot be told at %s yet: %s", self.address, error)
                self._closed.wait(AGAIN_AFTER_S)
            else:
                self.listening.set()
                self._server.serve_forever()
                return


_here: Exposition | None = None
_begins = threading.Lock()


def serve_health(program: str, *checks: Callable[[], list[str]]) -> Exposition | None:
    """Serve at the address of SPANWISE_METRICS, once per process. `checks` are what the program needs, by default database and Redis."""
    global _here
    address = address_of_environment()
    if address is None:
        return None
    with _begins:
        if _here is None:
            BUILD.labels(VERSION, program).set(1)
            _here = Exposition(address, Readiness(*checks))
            _here.start()
        return _here


def metrics_text() -> bytes:
    """Return the metrics of this process, or of all that share one folder."""
    if PROCESSES_FOLDER in os.environ:
        together = CollectorRegistry()
        MultiProcessCollector(together)
        return generate_latest(together)
    return generate_latest(REGISTRY)
