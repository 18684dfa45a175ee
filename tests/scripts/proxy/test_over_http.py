"""A real nginx that is reached without TLS: pages lead to https, programs are refused, so that nobody's token goes there twice."""

import json
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from email.message import Message
from pathlib import Path
from tempfile import mkdtemp

import pytest

from scripts.installation.system_packages import find_program
from scripts.proxy.proxy import site_configuration
from scripts.proxy.proxy_site import Site

TIMEOUT_S = 60


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def certificate_in(folder: Path) -> tuple[Path, Path]:
    certificate, key = folder / "tls.crt", folder / "tls.key"
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-subj", "/CN=x"]
    subprocess.run([*command, "-keyout", str(key), "-out", str(certificate)], check=True, capture_output=True)
    return certificate, key


@pytest.fixture(scope="module", params=["with its own certificate", "behind another proxy"])
def port(request: pytest.FixtureRequest) -> Iterator[int]:
    """Where nginx answers visitors who came over http."""
    nginx = find_program("nginx")
    if nginx is None:
        pytest.skip("nginx is not installed; ./run installs it")
    folder = Path(mkdtemp(prefix="sw-", dir="/tmp"))
    is_own = request.param == "with its own certificate"
    certificate, key = certificate_in(folder) if is_own else (None, None)
    at = free_port()
    site = Site(
        folder=folder, static=folder, web=("127.0.0.1:1",), live=("127.0.0.1:1",), listens_at=f"127.0.0.1:{at}", is_behind_https=True,
        certificate=certificate, key=key, listens_at_tls=f"127.0.0.1:{free_port()}",
    )  # fmt: skip
    (folder / "nginx.conf").write_text(site_configuration(site))
    with (folder / "log").open("wb") as log:
        process = subprocess.Popen([nginx, "-e", "stderr", "-c", str(folder / "nginx.conf")], stdout=log, stderr=log)
    try:
        end_s = time.monotonic() + TIMEOUT_S
        while socket.socket().connect_ex(("127.0.0.1", at)) != 0:
            assert process.poll() is None, (folder / "log").read_text()
            assert time.monotonic() < end_s
            time.sleep(0.02)
        yield at
    finally:
        process.terminate()
        process.wait()
        shutil.rmtree(folder)


class _Stays(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *arguments: object) -> None:
        return None


def asked(port: int, path: str, *, body: bytes | None = None) -> tuple[int, Message, bytes]:
    headers = {"Host": "spanwise.example.org", "X-Forwarded-Proto": "http", "Authorization": "Bearer spw_of_somebody"}
    request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", data=body, headers=headers)
    try:
        with urllib.request.build_opener(_Stays).open(request, timeout=TIMEOUT_S) as answer:
            return answer.status, answer.headers, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read()


@pytest.mark.parametrize("path", ["/", "/sign-in?next=/live", "/api/docs"])
def test_pages_lead_to_https(port: int, path: str) -> None:
    status, headers, _ = asked(port, path)
    assert (status, headers["Location"]) == (308, f"https://spanwise.example.org{path}")


@pytest.mark.parametrize(("path", "body"), [("/api/v1/missions", None), ("/api/v1/uav-link/telemetry", b"{}"), ("/ws/live", None)])
def test_programs_are_refused_and_told_that_their_token_was_read(port: int, path: str, body: bytes | None) -> None:
    status, headers, text = asked(port, path, body=body)
    assert (status, headers.get_content_type(), headers["Location"]) == (403, "application/json", None)
    error = json.loads(text)["error"]
    assert error["code"] == "https_required"
    assert "revoked" in error["message"]


def test_no_way_of_writing_an_address_gets_round_it(port: int) -> None:
    assert {asked(port, path)[0] for path in ("//api/v1/missions", "/x/../api/v1/missions", "/%61pi/v1/missions")} == {403}


def test_whoever_looks_whether_it_lives_is_answered(port: int) -> None:
    assert asked(port, "/proxy-alive")[0] in {204, 308}
