"""A real nginx with the written configuration, in front of a small application."""

import json
import socket
import subprocess
import tempfile
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from email.message import Message
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from socketserver import ThreadingUnixStreamServer

import pytest

from scripts.installation.system_packages import find_program
from scripts.places import Places
from scripts.proxy.proxy import configuration

BUNDLES = {
    "main-ABCDEFGH.js": b"export const answer = 42;\n" * 40, "main-ABCDEFGH.br.js": b"a script in Brotli",
    "page-ABCDEFGH.css": b"a { color: red }\n" * 40, "page-ABCDEFGH.br.css": b"a style sheet in Brotli",
    "main-ABCDEFGH.js.map": b"{}",
}  # fmt: skip
ANSWER = json.dumps({"name": "mission " * 200}).encode()


class Application(BaseHTTPRequestHandler):
    """Answers everything with the same JSON and a strong ETag."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "application/json")
        self.send_header("ETag", '"7"')
        self.send_header("Content-Length", str(len(ANSWER)))
        self.end_headers()
        self.wfile.write(ANSWER)

    def address_string(self) -> str:
        return "unix"

    def log_message(self, format: str, *args: object) -> None:
        pass


class _Server(ThreadingUnixStreamServer):
    request_queue_size = 128


@contextmanager
def served_site() -> Iterator[tuple[str, Path]]:
    """Yield the proxy's address, and the folder where the application's socket belongs."""
    nginx = find_program("nginx")
    if nginx is None:
        pytest.skip("nginx is not installed; ./run installs it")
    with tempfile.TemporaryDirectory(prefix="sw-") as folder:
        places = Places(Path(folder))
        places.process("proxy").mkdir(parents=True)
        places.static.mkdir()
        (places.static / "main.mjs").write_text("export const answer = 42;\n")
        (places.static / "bundles").mkdir()
        for name, content in BUNDLES.items():
            (places.static / "bundles" / name).write_bytes(content)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        path = places.state / "nginx.conf"
        path.write_text(configuration(places, places.state, port))
        with (places.state / "proxy.log").open("ab") as log:
            process = subprocess.Popen([nginx, "-e", "stderr", "-c", str(path)], stdout=log, stderr=log)
        try:
            deadline = time.monotonic() + 10
            while socket.socket().connect_ex(("127.0.0.1", port)) != 0:
                assert process.poll() is None
                assert time.monotonic() < deadline
                time.sleep(0.02)
            yield f"http://127.0.0.1:{port}", places.state
        finally:
            process.terminate()
            process.wait()


@contextmanager
def application_at(path: Path, application: type[BaseHTTPRequestHandler] = Application) -> Iterator[None]:
    server = _Server(str(path), application)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
    thread.start()
    yield
    server.shutdown()
    thread.join()
    server.server_close()
    path.unlink()


def fetch(
    address: str, *, body: bytes | None = None, accept_encoding: str = "gzip", headers: Mapping[str, str] | None = None
) -> tuple[int, Message, bytes]:
    request = urllib.request.Request(address, data=body, headers={"Accept-Encoding": accept_encoding} | dict(headers or {}))
    try:
        with urllib.request.urlopen(request, timeout=10) as response:
            return response.status, response.headers, response.read()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read()
