"""TLS from the proxy to the programs behind it: checked by an authority and a name, and renewed while they run."""

import http.client
import os
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkdtemp

import pytest

from scripts.commands import web
from scripts.installation.system_packages import find_program
from scripts.proxy.inner_tls import CERTIFICATE, KEY, InnerCertificate, inner_certificate
from scripts.proxy.proxy import site_configuration
from scripts.proxy.proxy_site import Site
from tests.scripts.proxy.test_over_http import TIMEOUT_S, free_port

PROJECT_DIR = Path(__file__).resolve().parents[3]


class Authority:
    def __init__(self, folder: Path) -> None:
        self.folder, self.certificate, self.key = folder, folder / "ca.crt", folder / "ca.key"
        self._openssl("req", "-x509", *self._new_key(self.key), "-subj", "/CN=inside", "-out", self.certificate)

    def issue(self, name: str, serial: int) -> tuple[Path, Path]:
        """A certificate for a server of this name, in files that only this one has."""
        certificate, key, request = (self.folder / f"{name}-{serial}.{ending}" for ending in ("crt", "key", "csr"))
        self._openssl("req", *self._new_key(key), "-subj", f"/CN={name}", "-addext", f"subjectAltName=DNS:{name}", "-out", request)
        signed_by = ["-CA", self.certificate, "-CAkey", self.key, "-set_serial", serial, "-days", "2", "-copy_extensions", "copy"]
        self._openssl("x509", "-req", "-in", request, *signed_by, "-out", certificate)
        return certificate, key

    @staticmethod
    def _new_key(path: Path) -> list[object]:
        return ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-keyout", path]

    @staticmethod
    def _openssl(*words: object) -> None:
        command = ["openssl", *(str(word) for word in words)]
        subprocess.run(command, check=True, capture_output=True)


@contextmanager
def running(*command: str) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(command, cwd=PROJECT_DIR)
    try:
        yield process
    finally:
        process.terminate()
        process.wait()


def wait_until(is_so: Callable[[], bool]) -> None:
    end_s = time.monotonic() + TIMEOUT_S
    while not is_so():
        assert time.monotonic() < end_s, "it never came"
        time.sleep(0.05)


def listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def serial_at(port: int) -> int | None:
    """Of the certificate that is shown there."""
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    try:
        with socket.create_connection(("127.0.0.1", port), TIMEOUT_S) as plain, context.wrap_socket(plain) as shown:
            found = shown.getpeercert(binary_form=True)
    except OSError:
        return None
    assert found is not None
    command = ["openssl", "x509", "-inform", "DER", "-noout", "-serial"]
    text = subprocess.run(command, input=found, capture_output=True, check=True).stdout
    return int(text.decode().strip().partition("=")[2], 16)


def answer(port: int) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=TIMEOUT_S)
    connection.request("GET", "/")
    reported = connection.getresponse()
    return reported.status, reported.read()


@pytest.fixture
def folder() -> Iterator[Path]:
    made = Path(mkdtemp(prefix="sw-", dir="/tmp"))
    yield made
    shutil.rmtree(made)


@pytest.mark.long
def test_the_proxy_speaks_tls_to_whom_the_authority_has_named_and_to_nobody_else(folder: Path) -> None:
    nginx = find_program("nginx")
    if nginx is None:
        pytest.skip("nginx is not installed; ./run installs it")
    inside, stranger = Authority(folder), Authority(_new(folder / "stranger"))
    found = InnerCertificate(folder / "copies", *inside.issue("localhost", 1))
    found.copy()
    behind, right, wrong = free_port(), free_port(), free_port()
    command = [*web("--host", "127.0.0.1", "--port", str(behind)), *found.arguments()]
    command[command.index("config.wsgi:application")] = "tests.scripts.proxy.inner_application:application"
    with running(*command) as program:
        wait_until(lambda: serial_at(behind) == 1)
        for port, trust in ((right, inside), (wrong, stranger)):
            site = Site(
                folder=_new(folder / str(port)), static=folder, web=(f"localhost:{behind}",), live=(f"localhost:{behind}",),
                listens_at=f"127.0.0.1:{port}", trust=trust.certificate,
            )  # fmt: skip
            (site.folder / "nginx.conf").write_text(site_configuration(site))
        configurations = (str(folder / str(port) / "nginx.conf") for port in (right, wrong))
        with running(nginx, "-e", "stderr", "-c", next(configurations)), running(nginx, "-e", "stderr", "-c", next(configurations)):
            wait_until(lambda: listens(right) and listens(wrong))
            assert answer(right) == (200, b"https")
            assert answer(wrong)[0] == 503

            renewed = InnerCertificate(folder / "copies", *inside.issue("localhost", 2))
            assert renewed.is_renewed()
            renewed.copy()
            assert not renewed.is_renewed()
            program.send_signal(signal.SIGHUP)
            wait_until(lambda: serial_at(behind) == 2)
            assert answer(right) == (200, b"https")


def _new(folder: Path) -> Path:
    folder.mkdir()
    return folder


def test_without_an_authority_nothing_is_said_of_tls(tmp_path: Path) -> None:
    site = Site(folder=tmp_path, static=tmp_path, web=("web:8000",), live=("live:8001",), listens_at="8080")
    assert "proxy_ssl" not in site_configuration(site)


def test_a_certificate_that_is_being_swapped_is_no_new_one_yet(tmp_path: Path) -> None:
    certificate, key = tmp_path / "tls.crt", tmp_path / "tls.key"
    certificate.write_text("certificate")
    key.write_text("key")
    found = InnerCertificate(tmp_path / "copies", certificate, key)
    found.copy()
    assert [path.stat().st_mode & 0o777 for path in found.files.values()] == [0o600, 0o600]
    certificate.unlink()
    assert not found.is_renewed()
    certificate.write_text("another")
    assert found.is_renewed()


def test_programs_speak_plain_http_unless_both_files_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(KEY, raising=False)
    monkeypatch.setenv(CERTIFICATE, str(tmp_path / "tls.crt"))
    assert inner_certificate(tmp_path) is None
    monkeypatch.setenv(KEY, str(tmp_path / "tls.key"))
    assert inner_certificate(tmp_path) is not None


@pytest.mark.long
def test_whoever_looks_after_the_certificate_tells_the_program_and_ends_with_it(tmp_path: Path) -> None:
    """A process that becomes a shell, as a container's becomes granian; the shell ends at the signal."""
    certificate, key = tmp_path / "tls.crt", tmp_path / "tls.key"
    for path in (certificate, key):
        path.write_text("old")
    lines = f"""
import os, pathlib, time
from scripts.proxy import inner_tls
found = inner_tls.InnerCertificate(*map(pathlib.Path, {[str(tmp_path / "copies"), str(certificate), str(key)]!r}))
found.copy()
inner_tls.look_after(found, pause=lambda seconds: time.sleep(0.05))
os.execvp("sh", ["sh", "-c", "trap 'echo renewed; exit 0' HUP; echo ready; while :; do sleep 0.05; done"])
"""
    with subprocess.Popen([sys.executable, "-c", lines], cwd=PROJECT_DIR, env=os.environ, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        certificate.write_text("new")
        assert process.stdout.read() == "renewed\n"
    assert process.returncode == 0
    assert (tmp_path / "copies" / "inner.crt").read_text() == "new"
