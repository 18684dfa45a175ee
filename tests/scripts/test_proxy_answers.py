"""A real nginx with the written configuration, in front of a small application: what arrives at the browser."""

import gzip
import json
import socket
import subprocess
import tempfile
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from email.message import Message
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from socketserver import ThreadingUnixStreamServer

import pytest

from scripts.places import WEB_PROGRAMS, Places
from scripts.proxy import configuration
from scripts.system_packages import find_program

ANSWER = json.dumps({"name": "mission " * 200}).encode()


class _Application(BaseHTTPRequestHandler):
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


@pytest.fixture(scope="module")
def site() -> Iterator[tuple[str, Path]]:
    """The proxy's address, and the folder where the application's socket belongs."""
    nginx = find_program("nginx")
    if nginx is None:
        pytest.skip("nginx is not installed; ./run installs it")
    with tempfile.TemporaryDirectory(prefix="sw-") as name:
        places = Places(Path(name))
        places.process("proxy").mkdir(parents=True)
        places.static.mkdir()
        (places.static / "main.mjs").write_text("export const answer = 42;\n")
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


@pytest.fixture(params=WEB_PROGRAMS)
def application(site: tuple[str, Path], request: pytest.FixtureRequest) -> Iterator[None]:
    """One of the web programs; the others are away."""
    path = site[1] / f"{request.param}.sock"
    server = ThreadingUnixStreamServer(str(path), _Application)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
    thread.start()
    yield
    server.shutdown()
    thread.join()
    server.server_close()
    path.unlink()


def _fetch(address: str, *, body: bytes | None = None, accept_encoding: str = "gzip") -> tuple[int, Message, bytes]:
    request = urllib.request.Request(address, data=body, headers={"Accept-Encoding": accept_encoding})
    try:
        with urllib.request.urlopen(request, timeout=10) as response:
            return response.status, response.headers, response.read()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read()


def test_a_module_is_sent_as_javascript_with_the_policy(site: tuple[str, Path]) -> None:
    status, headers, body = _fetch(f"{site[0]}/static/main.mjs")
    assert (status, headers["Content-Type"], body) == (200, "text/javascript; charset=utf-8", b"export const answer = 42;\n")
    assert "script-src 'self';" in headers["Content-Security-Policy"]


def test_no_static_path_leads_out_of_the_folder(site: tuple[str, Path]) -> None:
    for path in ("/static/../nginx.conf", "/static/%2e%2e/nginx.conf", "/static../nginx.conf"):
        assert _fetch(f"{site[0]}{path}")[0] in {400, 404, 503}


def test_while_the_application_is_away_programs_get_the_common_error_and_when_to_try_again(site: tuple[str, Path]) -> None:
    status, headers, body = _fetch(f"{site[0]}/api/v1/missions")
    assert (status, headers["Retry-After"]) == (503, "5")
    assert json.loads(body)["error"]["code"] == "unavailable"


def test_while_the_application_is_away_people_get_a_sentence(site: tuple[str, Path]) -> None:
    status, headers, body = _fetch(f"{site[0]}/missions")
    assert (status, headers["Content-Type"]) == (503, "text/plain; charset=utf-8")
    assert body.startswith(b"Spanwise is starting")


@pytest.mark.usefixtures("application")
def test_a_body_that_is_too_large_is_refused_in_the_common_shape(site: tuple[str, Path]) -> None:
    status, _, body = _fetch(f"{site[0]}/api/v1/plans", body=b"0" * (8 * 1024 * 1024 + 1))
    assert status == 413
    assert json.loads(body)["error"]["code"] == "too_large"


@pytest.mark.usefixtures("application")
def test_answers_are_compressed(site: tuple[str, Path]) -> None:
    _, headers, body = _fetch(f"{site[0]}/api/v1/assets")
    assert headers["Content-Encoding"] == "gzip"
    assert gzip.decompress(body) == ANSWER


@pytest.mark.usefixtures("application")
def test_a_missions_etag_stays_strong_so_that_if_match_can_match(site: tuple[str, Path]) -> None:
    _, headers, body = _fetch(f"{site[0]}/api/v1/missions/1")
    assert (headers["ETag"], body) == ('"7"', ANSWER)


def test_no_log_has_the_link_to_a_new_password(site: tuple[str, Path]) -> None:
    """Neither the line of the request nor, as the application is away, that of its fault."""
    assert _fetch(f"{site[0]}/new-password/MQ/c1x-secret")[0] == 503
    assert _fetch(f"{site[0]}/invitation/c1x-secret")[0] == 503
    assert _fetch(f"{site[0]}/lost-password?next=unseen")[0] == 503
    log = site[1] / "proxy.log"
    deadline = time.monotonic() + 10
    while '/lost-password?..." 503' not in log.read_text():
        assert time.monotonic() < deadline
        time.sleep(0.02)
    assert '"GET /new-password/..." 503' in log.read_text()
    assert '"GET /invitation/..." 503' in log.read_text()
    assert "secret" not in log.read_text()
