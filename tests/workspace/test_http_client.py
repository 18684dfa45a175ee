"""What is fetched from other servers: never from inside our own walls, never more or longer than allowed, and nothing left behind."""

import socket
import ssl
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import Any

import pytest

from tests.workspace.loopback import Answer, Server, body, serving
from workspace import http_client
from workspace.http_client import Fetched, OutgoingFailed, OutgoingRefused, check_address, fetch, is_global


@pytest.fixture
def servers() -> Iterator[Callable[[], Server]]:
    with ExitStack() as started:
        yield lambda: started.enter_context(serving())


@pytest.fixture
def server(servers: Callable[[], Server], settings: Any) -> Server:
    """One that may be fetched from."""
    made = servers()
    settings.OUTGOING_ALLOWED_HOSTS = [f"127.0.0.1:{made.server_port}"]
    return made


@pytest.fixture
def names(monkeypatch: pytest.MonkeyPatch) -> dict[str, list[list[str]]]:
    """The name service: each question takes the next answer of a name, the last one stays."""
    known: dict[str, list[list[str]]] = {}

    def resolve(host: str, port: int) -> list[str]:
        if host not in known:
            return [host]
        return known[host].pop(0) if len(known[host]) > 1 else known[host][0]

    monkeypatch.setattr(http_client, "resolve", resolve)
    return known


def redirect(to: str, status: int = 302) -> Answer:
    return body(b"", status, Location=to)


def raw(*chunks: bytes, pause_s: float = 0.0) -> Answer:
    """Bytes as they are, without the server's own idea of HTTP; then the connection ends."""

    def answer(request: BaseHTTPRequestHandler) -> None:
        request.close_connection = True
        for chunk in chunks:
            request.wfile.write(chunk)
            time.sleep(pause_s)

    return answer


def endless(head: bytes, block: bytes, pause_s: float = 0.0, most: int = 2**30) -> Answer:
    def answer(request: BaseHTTPRequestHandler) -> None:
        request.close_connection = True
        request.wfile.write(head)
        sent = 0
        while sent < most:
            request.wfile.write(block)
            sent += len(block)
            time.sleep(pause_s)

    return answer


def get(address: str, folder: Path, **options: Any) -> Fetched:
    return fetch(address, to=folder / "answer", **{"max_bytes": 1_000_000, "timeout_s": 2.0, "total_s": 10.0} | options)


def refused(address: str, folder: Path, error: type[Exception] = OutgoingFailed, **options: Any) -> str:
    """The sentence; nothing may be left on the disk."""
    with pytest.raises(error) as caught:
        get(address, folder, **options)
    assert list(folder.iterdir()) == []
    return str(caught.value)


def test_an_answer_is_written_with_what_it_says_of_itself(server: Server, tmp_path: Path) -> None:
    server.answers["/zones.json?a=1%202"] = body(b"{}", Content_Type="application/json", ETag='"v1"', Last_Modified="Sat, 01 Aug 2026")
    fetched = get(server.address("/zones.json?a=1%202"), tmp_path)
    assert (tmp_path / "answer").read_bytes() == b"{}"
    assert (fetched.status, fetched.content_type, fetched.etag, fetched.bytes) == (200, "application/json", '"v1"', 2)
    assert fetched.last_modified == "Sat, 01 Aug 2026"
    headers = server.asked[0][2]
    assert (headers["Accept-Encoding"], headers["Host"]) == ("identity", f"127.0.0.1:{server.server_port}")


def test_not_modified_writes_no_file(server: Server, tmp_path: Path) -> None:
    server.answers["/"] = body(b"", 304, ETag='"v1"')
    fetched = get(server.address(), tmp_path, headers={"If-None-Match": '"v1"'})
    assert (fetched.status, server.asked[0][2]["If-None-Match"], list(tmp_path.iterdir())) == (304, '"v1"', [])


def test_data_are_sent(server: Server, tmp_path: Path) -> None:
    def echo(request: BaseHTTPRequestHandler) -> None:
        body(request.rfile.read(int(request.headers["Content-Length"])))(request)

    server.answers["/api"] = echo
    get(server.address("/api"), tmp_path, method="POST", data=b"data=out;")
    assert (tmp_path / "answer").read_bytes() == b"data=out;"


@pytest.mark.parametrize(
    "address",
    [
        "ftp://example.org/a", "file:///etc/hostname", "gopher://example.org/", "//example.org/a", "example.org", "",
        "https://user:word@example.org/", "https://user@example.org/", "https:///a", "https://exa mple.org/",
        "https://example.org/\r\nX: 1",
        "https://example.org:99999/", "https://example.org:0/", "https://[::1%25lo]/", "https://[::1/", "https://a\\b.org/",
        "https://" + "a" * 70 + ".org/", "https://example.org/" + "a" * 2_000,
    ],
)  # fmt: skip
def test_what_is_no_plain_web_address_is_refused(address: str, tmp_path: Path) -> None:
    refused(address, tmp_path, OutgoingRefused)
    with pytest.raises(OutgoingRefused):
        check_address(address)


@pytest.mark.parametrize(
    "address",
    [
        "127.0.0.1", "127.9.9.9", "0.0.0.0", "10.1.2.3", "172.16.0.1", "192.168.1.1", "169.254.169.254", "100.64.0.1", "192.0.0.8",  # noqa: S104
        "192.0.2.1", "198.18.0.1", "198.51.100.1", "203.0.113.1", "224.0.0.1", "239.1.1.1", "240.0.0.1", "255.255.255.255", "192.88.99.1",
        "::", "::1", "::7f00:1", "::ffff:127.0.0.1", "::ffff:8.8.8.8", "fe80::1", "fe80::1%2", "fec0::1", "fc00::1", "fd12::1", "ff02::1",
        "64:ff9b::7f00:1", "64:ff9b::a00:1", "64:ff9b:1::808:808", "2002:7f00:1::", "2001::1", "2001:db8::1", "3fff::1", "100::1",
        "5f00::1",
    ],
)  # fmt: skip
def test_an_address_that_is_not_public_is_known(address: str) -> None:
    assert not is_global(address)


@pytest.mark.parametrize("address", ["8.8.8.8", "193.5.216.1", "2606:4700::1111", "2a00:1450:4001::1", "64:ff9b::808:808"])
def test_a_public_address_is_known(address: str) -> None:
    assert is_global(address)


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "2130706433", "0x7f.1", "0177.0.0.1", "127.1", "[::ffff:127.0.0.1]"])
def test_no_spelling_of_this_machine_is_connected_to(host: str, servers: Callable[[], Server], settings: Any, tmp_path: Path) -> None:
    settings.OUTGOING_ALLOWED_HOSTS = []
    server = servers()
    server.answers["/"] = body()
    assert "not a host of the public internet" in refused(server.address(host=host), tmp_path, OutgoingRefused)
    assert server.asked == []


def test_a_name_that_is_not_known_is_answered_as_one_of_this_network(settings: Any, tmp_path: Path) -> None:
    """Else the answers tell which names the network behind the machine has."""
    settings.OUTGOING_ALLOWED_HOSTS = []
    unknown = refused("https://no-such-host.invalid/zones.json", tmp_path, OutgoingFailed)
    inside = refused("https://localhost/zones.json", tmp_path, OutgoingRefused)
    assert unknown.replace("no-such-host.invalid", "localhost") == inside


def test_a_host_is_allowed_with_its_port_alone(servers: Callable[[], Server], settings: Any, tmp_path: Path) -> None:
    allowed, other = servers(), servers()
    settings.OUTGOING_ALLOWED_HOSTS = [f"127.0.0.1:{allowed.server_port}"]
    allowed.answers["/"] = other.answers["/"] = body()
    assert get(allowed.address(), tmp_path).status == 200
    (tmp_path / "answer").unlink()
    refused(other.address(), tmp_path, OutgoingRefused)
    assert other.asked == []


def test_a_redirect_into_our_own_network_is_refused(server: Server, servers: Callable[[], Server], tmp_path: Path) -> None:
    inside = servers()
    inside.answers["/secrets"] = body()
    server.answers["/"] = redirect(inside.address("/secrets"))
    refused(server.address(), tmp_path, OutgoingRefused)
    assert inside.asked == []


@pytest.mark.parametrize(
    "to", ["file:///etc/hostname", "ftp://example.org/", "http://user:word@example.org/", "http://169.254.169.254/latest"]
)
def test_a_redirect_to_what_is_not_fetched_is_refused(to: str, server: Server, tmp_path: Path) -> None:
    server.answers["/"] = redirect(to)
    refused(server.address(), tmp_path, OutgoingRefused)


def test_three_redirects_are_followed_and_no_more(server: Server, tmp_path: Path) -> None:
    for step in range(4):
        server.answers[f"/{step}"] = redirect(f"/{step + 1}", 307)
    server.answers["/4"] = body()
    fetched = get(server.address("/1"), tmp_path)
    assert (fetched.status, fetched.address) == (200, server.address("/4"))
    (tmp_path / "answer").unlink()
    assert "more than 3 times" in refused(server.address("/0"), tmp_path)


def test_a_question_with_data_is_not_turned_into_one_without(server: Server, tmp_path: Path) -> None:
    server.answers["/"] = redirect("/other", 302)
    assert "redirects a question" in refused(server.address(), tmp_path, method="POST", data=b"a")


def test_a_name_that_points_inside_is_refused(server: Server, names: dict[str, list[list[str]]], tmp_path: Path) -> None:
    for addresses in ([["127.0.0.1"]], [["8.8.8.8", "127.0.0.1"]], [["::ffff:127.0.0.1"]], [[]]):
        names["evil.test"] = addresses
        assert "evil.test" in refused(server.address(host="evil.test"), tmp_path, OutgoingRefused)
    assert server.asked == []


def test_a_name_is_asked_for_once_and_the_checked_address_is_connected_to(
    server: Server, names: dict[str, list[list[str]]], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Rebinding: the second answer of the name service would be this machine."""
    names["evil.test"] = [["8.8.8.8"], ["127.0.0.1"]]
    connected: list[Any] = []

    def connect(address: Any, timeout: float) -> socket.socket:
        connected.append(address)
        raise ConnectionRefusedError

    monkeypatch.setattr(http_client.socket, "create_connection", connect)
    refused(server.address(host="evil.test"), tmp_path)
    assert connected == [("8.8.8.8", server.server_port)]
    assert (names["evil.test"], server.asked) == ([["127.0.0.1"]], [])


def test_a_name_is_checked_again_when_a_redirect_leads_back_to_it(
    server: Server, names: dict[str, list[list[str]]], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    names["evil.test"] = [["8.8.8.8"], ["127.0.0.1"]]
    connect = socket.create_connection
    monkeypatch.setattr(http_client.socket, "create_connection", lambda address, timeout: connect(("127.0.0.1", address[1]), timeout))
    server.answers["/"] = redirect("/again")
    refused(server.address(host="evil.test"), tmp_path, OutgoingRefused)
    assert [asked[1] for asked in server.asked] == ["/"]


HEAD = b"HTTP/1.1 200 OK\r\n"
SLOW = {
    "a slow body": endless(HEAD + b"Content-Length: 1000\r\n\r\n", b"z", 0.05),
    "a slow body without a length": endless(HEAD + b"\r\n", b"z", 0.05),
    "slow chunks": endless(HEAD + b"Transfer-Encoding: chunked\r\n\r\n", b"1\r\nz\r\n", 0.05),
    "slow headers": endless(HEAD, b"X-A: 1\r\n", 0.05),
    "a slow status": endless(b"HTTP/1.1 200 ", b"a", 0.05),
    "interim answers without end": endless(b"", b"HTTP/1.1 100 Continue\r\n\r\n", 0.05),
    "slow trailers": endless(HEAD + b"Transfer-Encoding: chunked\r\n\r\n1\r\nz\r\n0\r\n", b"X-A: 1\r\n", 0.05),
}  # fmt: skip


@pytest.mark.parametrize("name", SLOW)
def test_whoever_drips_is_cut_off_when_the_whole_time_is_up(name: str, server: Server, tmp_path: Path) -> None:
    server.answers["/"] = SLOW[name]
    refused(server.address(), tmp_path, timeout_s=1.0, total_s=0.5)


def test_silence_is_cut_off_before_the_whole_time_is_up(server: Server, tmp_path: Path) -> None:
    server.answers["/"] = raw(HEAD, b"", pause_s=0.6)
    assert refused(server.address(), tmp_path, timeout_s=0.2, total_s=60.0) == "127.0.0.1 did not answer in time."


LARGE = {
    "announced": body(b"", Content_Length=str(2**30)),
    "not announced": endless(HEAD + b"\r\n", b"z" * 65_536),
    "in chunks": endless(HEAD + b"Transfer-Encoding: chunked\r\n\r\n", b"10000\r\n" + b"z" * 65_536 + b"\r\n"),
    "one chunk": endless(HEAD + b"Transfer-Encoding: chunked\r\n\r\n40000000\r\n", b"z" * 65_536),
    "with a negative length": endless(HEAD + b"Content-Length: -5\r\n\r\n", b"z" * 65_536),
}  # fmt: skip


@pytest.mark.parametrize("name", LARGE)
def test_a_gigabyte_is_refused_at_the_cap(name: str, server: Server, tmp_path: Path) -> None:
    server.answers["/"] = LARGE[name]
    assert "more than 1 MiB" in refused(server.address(), tmp_path, max_bytes=2**20)


def test_an_endless_header_is_refused(server: Server, tmp_path: Path) -> None:
    server.answers["/"] = endless(HEAD + b"X-A: ", b"z" * 65_536)
    assert "not HTTP" in refused(server.address(), tmp_path)


BROKEN = {
    "cut after a part": (raw(HEAD + b"Content-Length: 1000\r\n\r\nzones"), "cut after 5 bytes"),
    "a chunk cut": (raw(HEAD + b"Transfer-Encoding: chunked\r\n\r\nff\r\nzones"), "cut"),
    "not HTTP": (raw(b"SSH-2.0-server\r\n"), "not HTTP"),
    "nothing": (raw(b""), "not HTTP"),
    "packed": (body(b"\x1f\x8b", Content_Encoding="gzip"), "packed form"),
    "a part only": (body(b"zo", 206), "answers 206"),
    "not there": (body(b"<h1>no</h1>", 404), "answers 404 Not Found."),
    "to nowhere": (body(b"", 302), "redirects to nowhere"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_half_an_answer_is_none(name: str, server: Server, tmp_path: Path) -> None:
    server.answers["/"], words = BROKEN[name]
    assert words in refused(server.address(), tmp_path)


def test_the_status_and_the_wish_to_wait_are_told(server: Server, tmp_path: Path) -> None:
    server.answers["/"] = body(b"", 429, Retry_After="30")
    with pytest.raises(OutgoingFailed) as caught:
        get(server.address(), tmp_path)
    assert (caught.value.status, caught.value.retry_after_s) == (429, 30)


def test_a_port_that_nobody_listens_on_is_said(server: Server, settings: Any, tmp_path: Path) -> None:
    with socket.socket() as held:
        held.bind(("127.0.0.1", 0))
        port = held.getsockname()[1]
        settings.OUTGOING_ALLOWED_HOSTS = [f"127.0.0.1:{port}"]
        assert refused(f"http://127.0.0.1:{port}/", tmp_path) == f"127.0.0.1 takes no connections on port {port}."


def test_whoever_watches_the_progress_can_stop_it(server: Server, tmp_path: Path) -> None:
    server.answers["/"] = body(b"z" * 300_000)

    def stop(size: int) -> None:
        raise KeyError(size)

    refused(server.address(), tmp_path, KeyError, progress=stop)


@pytest.fixture
def secure(
    server: Server, names: dict[str, list[list[str]]], settings: Any, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: Any
) -> Server:
    """The server speaks TLS with a certificate of its own for zones.test, which this process trusts."""
    folder = tmp_path_factory.mktemp("tls")
    command = [
        "openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
        "-subj", "/CN=zones.test",
        "-addext", "subjectAltName=DNS:zones.test", "-keyout", str(folder / "key.pem"), "-out", str(folder / "certificate.pem"),
    ]  # fmt: skip
    subprocess.run(command, check=True, capture_output=True)  # noqa: S603
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(folder / "certificate.pem", folder / "key.pem")
    server.socket = context.wrap_socket(server.socket, server_side=True, do_handshake_on_connect=False)
    monkeypatch.setenv("SSL_CERT_FILE", str(folder / "certificate.pem"))
    names["zones.test"] = names["other.test"] = [["127.0.0.1"]]
    settings.OUTGOING_ALLOWED_HOSTS = [f"{host}:{server.server_port}" for host in ("zones.test", "other.test")]
    return server


def test_the_certificate_is_checked_by_the_name_and_not_by_the_address(secure: Server, tmp_path: Path) -> None:
    secure.answers["/"] = body()
    assert get(secure.address(host="zones.test", scheme="https"), tmp_path).status == 200
    (tmp_path / "answer").unlink()
    assert "certificate of other.test does not hold" in refused(secure.address(host="other.test", scheme="https"), tmp_path)


def test_a_certificate_that_nobody_trusts_is_refused(secure: Server, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("SSL_CERT_FILE")
    secure.answers["/"] = body()
    assert "certificate of zones.test does not hold" in refused(secure.address(host="zones.test", scheme="https"), tmp_path)


def test_a_redirect_from_https_to_http_is_refused(secure: Server, tmp_path: Path) -> None:
    secure.answers["/"] = redirect(secure.address("/plain", host="zones.test"))
    assert "from https to http" in refused(secure.address(host="zones.test", scheme="https"), tmp_path, OutgoingRefused)


def test_a_handshake_that_never_comes_is_cut_off(settings: Any, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as deaf:
        port = deaf.getsockname()[1]
        settings.OUTGOING_ALLOWED_HOSTS = [f"127.0.0.1:{port}"]
        refused(f"https://127.0.0.1:{port}/", tmp_path, timeout_s=30.0, total_s=0.5)
