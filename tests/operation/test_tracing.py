"""Tracing costs nothing where it is off, says what is missing where it is on, and holds no secret."""

import http.server
import logging
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from operation import tracing

PROJECT_DIR = Path(__file__).resolve().parents[2]
TIMEOUT_S = 180

ONE_REQUEST = """
from config.wsgi import application
from opentelemetry import trace
from io import BytesIO
for address in ("/sign-in", "/invitation/holder-of-the-link", "/email-address/holder-of-the-link",
                "/single-sign-on/callback?code=holder-of-the-link", "/healthz"):
    path, _sign, query = address.partition("?")
    environ = {"REQUEST_METHOD": "GET", "PATH_INFO": path, "SERVER_NAME": "localhost", "SERVER_PORT": "80", "wsgi.input": BytesIO(),
               "wsgi.url_scheme": "http", "HTTP_HOST": "localhost", "QUERY_STRING": query, "wsgi.errors": BytesIO(),
               "HTTP_AUTHORIZATION": "Bearer spw_secret-of-somebody"}
    b"".join(application(environ, lambda *_: None))
trace.get_tracer_provider().shutdown()
"""


@pytest.fixture
def collector() -> Iterator[tuple[str, list[tuple[str, bytes]]]]:
    """Where spans are sent, and what came."""
    came: list[tuple[str, bytes]] = []

    class Collector(http.server.BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            came.append((self.path, self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(200)
            self.end_headers()

        def log_message(self, format: str, *args: object) -> None:
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Collector)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_address[1]}", came
    server.shutdown()
    server.server_close()


def test_off_nothing_of_it_is_imported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(tracing.VARIABLE, raising=False)
    assert tracing.begin_tracing("web") is False
    assert not [name for name in sys.modules if name.startswith(("opentelemetry.instrumentation", "opentelemetry.exporter"))]


def test_on_without_its_libraries_the_program_runs_and_says_so(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setenv(tracing.VARIABLE, "1")

    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(tracing.importlib, "import_module", missing)
    with caplog.at_level(logging.WARNING, "operation.tracing"):
        assert tracing.begin_tracing("web") is False
    assert "requirements-tracing.txt" in caplog.text


@pytest.mark.long
def test_on_spans_go_where_the_environment_says_and_hold_no_secret(collector: tuple[str, list[tuple[str, bytes]]], tmp_path: Path) -> None:
    address, came = collector
    environment = os.environ | {
        "SPANWISE_TRACING": "1", "OTEL_EXPORTER_OTLP_ENDPOINT": address,
        "SPANWISE_VAR": str(tmp_path), "SPANWISE_SECRET_KEY": "of-the-test",
    }  # fmt: skip
    subprocess.run([sys.executable, "-c", ONE_REQUEST], cwd=PROJECT_DIR, env=environment, check=True, timeout=TIMEOUT_S)
    assert {path for path, _ in came} == {"/v1/traces"}
    reported = b"".join(body for _, body in came)
    assert b"spanwise-web" in reported
    assert b"sign-in" in reported
    assert b"holder-of-the-link" not in reported
    assert b"spw_secret" not in reported
    assert b"healthz" not in reported
