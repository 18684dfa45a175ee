"""SSRF-safe HTTP client: fetches addresses that users enter, without access to this machine's own network."""

import hashlib
import http.client
import ipaddress
import socket
import ssl
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from urllib.parse import quote, urljoin, urlsplit

from django.conf import settings
from django.utils.translation import gettext as _

MAX_REDIRECTS = 3
MAX_ADDRESS_LENGTH = 2_000
USER_AGENT = "Spanwise"
_BLOCK_BYTES = 64 * 1024
_REDIRECTS = {301, 302, 303, 307, 308}
_REPEATED = {307, 308}  # a request with data is repeated unchanged
_PORTS = {"http": 80, "https": 443}
_KEPT_SIGNS = "/?:@!$&'()*+,;=~%[]"  # kept as they are in a path and a query

_GLOBAL_UNICAST = ipaddress.IPv6Network("2000::/3")  # all that IANA has allocated
_NAT64 = ipaddress.IPv6Network("64:ff9b::/96")  # RFC 6052: the last 32 bits are the IPv4 address
_NEVER = (
    ipaddress.IPv6Network("2001::/23"),  # IETF protocols, Teredo among them, which like
    ipaddress.IPv6Network("2002::/16"),  # 6to4 holds an IPv4 address that may be private
    ipaddress.IPv6Network("3fff::/20"),  # documentation, RFC 9637
    ipaddress.IPv4Network("192.0.0.0/24"),  # IETF protocols
    ipaddress.IPv4Network("192.88.99.0/24"),  # the relays of 6to4
)


class OutgoingError(Exception):
    """Base error; the message is a sentence for the user who entered the address."""


class OutgoingRefused(OutgoingError):
    """Raised for an address that may not be fetched; nothing was sent there."""


class OutgoingFailed(OutgoingError):
    """Raised for no response or a wrong one. status and retry_after_s are the server's, if it sent them."""

    def __init__(self, message: str, *, status: int | None = None, retry_after_s: int | None = None) -> None:
        super().__init__(message)
        self.status, self.retry_after_s = status, retry_after_s


@dataclass(frozen=True)
class Fetched:
    status: int  # 200, or 304: not modified, nothing was written
    content_type: str
    etag: str
    last_modified: str
    bytes: int
    sha256: str
    address: str  # the one that responded, after redirects


@dataclass(frozen=True)
class _Target:
    address: str
    scheme: str
    host: str  # ASCII, without brackets
    port: int
    path: str


def fetch(
    address: str,
    *,
    to: Path,
    max_bytes: int,
    timeout_s: float = 20.0,
    total_s: float = 120.0,
    headers: Mapping[str, str] | None = None,
    method: str = "GET",
    data: bytes | None = None,
    progress: Callable[[int], None] | None = None,
) -> Fetched:
    """Write the response of an address to a file. Raises OutgoingRefused or OutgoingFailed; then there is no file.

    A name is resolved once, and the connection goes to the address that was checked; each redirect is checked again. timeout_s is the
    longest silence, total_s the longest total time. The headers must hold no secret: they are also sent to redirects.
    Proxies named in the environment are not used. progress is called with the bytes so far, and may raise to stop.
    """
    sent = {"User-Agent": USER_AGENT, "Accept-Encoding": "identity", "Connection": "close", **(headers or {})}
    target = _target(address)
    with _Deadline(total_s) as deadline:
        for _turn in range(MAX_REDIRECTS + 1):
            connection = _PinnedConnection(target, timeout_s, deadline)
            try:
                answer = _ask(connection, target, method, data, sent, deadline)
                if answer.status not in _REDIRECTS:
                    return _receive(answer, target, to, max_bytes, deadline, progress)
                target = _next_target(target, answer, data)
            except BaseException:
                to.unlink(missing_ok=True)
                raise
            finally:
                connection.close()
    raise OutgoingFailed(
        _("%(hostname)s redirects more than %(most_redirects)s times.")
        % {"hostname": urlsplit(address).hostname, "most_redirects": MAX_REDIRECTS}
    )


def check_address(address: str) -> None:
    """Raise OutgoingRefused if the address's text shows that it may not be fetched; its name is resolved when it is fetched."""
    target = _target(address)
    with suppress(ValueError):
        _check_reachable(target, [str(ipaddress.ip_address(target.host))])


def resolve(host: str, port: int) -> list[str]:
    """Return the addresses of a host, resolved once. Raises OSError."""
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    return list(dict.fromkeys(str(entry[4][0]) for entry in found))


def is_global(address: str) -> bool:
    """Whether the address belongs to the public internet; an IPv4 address embedded in an IPv6 one is checked too."""
    ip = ipaddress.ip_address(address)
    if isinstance(ip, ipaddress.IPv6Address):
        if ip in _NAT64:
            return is_global(str(ipaddress.IPv4Address(int(ip) & 0xFFFF_FFFF)))
        if ip not in _GLOBAL_UNICAST:
            return False
    return ip.is_global and not ip.is_multicast and not any(ip in network for network in _NEVER if network.version == ip.version)


class _Deadline:
    """Cuts the connection at the deadline in every phase: handshake, headers or body."""

    def __init__(self, total_s: float) -> None:
        self._ends_at = time.monotonic() + total_s
        self._total_s = total_s
        self._socket: socket.socket | None = None
        self._timer = threading.Timer(total_s, self._cut)
        self._timer.daemon = True

    def __enter__(self) -> "_Deadline":
        self._timer.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._timer.cancel()

    @property
    def is_over(self) -> bool:
        return time.monotonic() >= self._ends_at

    def left_s(self) -> float:
        """Return the seconds left; never 0, which a socket would take for "do not wait"."""
        return max(self._ends_at - time.monotonic(), 0.001)

    def watch(self, connected: socket.socket) -> None:
        self._socket = connected
        if self.is_over:
            self._cut()

    def check(self, host: str) -> None:
        if self.is_over:
            raise OutgoingFailed(_("%(host)s did not answer whole within %(total_s)s s.") % {"host": host, "total_s": f"{self._total_s:g}"})

    def _cut(self) -> None:
        if self._socket is not None:
            with suppress(OSError):
                socket.socket.shutdown(self._socket, socket.SHUT_RDWR)  # SSLSocket's own would let its reader see raw bytes


class _PinnedConnection(http.client.HTTPConnection):
    """Connects to an address that was resolved and checked; the name is used for the Host header, SNI and the certificate."""

    def __init__(self, target: _Target, timeout_s: float, deadline: _Deadline) -> None:
        super().__init__(target.host, target.port, timeout=timeout_s)
        self.default_port = _PORTS[target.scheme]
        self._target, self._deadline, self._timeout_s = target, deadline, timeout_s

    def connect(self) -> None:
        addresses = resolve(self._target.host, self._target.port)
        _check_reachable(self._target, addresses)
        self.sock = self._connected(addresses)
        self._deadline.watch(self.sock)
        self.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if self._target.scheme == "https":
            context = ssl.create_default_context()
            self.sock = context.wrap_socket(self.sock, server_hostname=self._target.host, do_handshake_on_connect=False)
            self._deadline.watch(self.sock)
            self.sock.do_handshake()

    def _connected(self, addresses: list[str]) -> socket.socket:
        failure: OSError = OSError("no address")
        for address in addresses:
            try:
                return socket.create_connection((address, self._target.port), min(self._timeout_s, self._deadline.left_s()))
            except OSError as error:
                failure = error
        raise failure


def _target(address: str) -> _Target:
    if len(address) > MAX_ADDRESS_LENGTH or any(character <= " " or character == "\x7f" or character == "\\" for character in address):
        raise OutgoingRefused(_("The address has blanks or signs that no address has, or is too long."))
    try:
        parts = urlsplit(address)
        port = parts.port
        host = (parts.hostname or "").rstrip(".")
        host = host if ":" in host else host.encode("idna").decode("ascii")
    except ValueError as error:  # including UnicodeError
        raise OutgoingRefused(_("This is not an address.")) from error
    if parts.scheme not in _PORTS:
        raise OutgoingRefused(_("Only addresses that begin with https:// or http:// are fetched."))
    if parts.username is not None or parts.password is not None:
        raise OutgoingRefused(_("An address with a user name or password is not fetched: it would be stored and shown."))
    if not host or port == 0 or "%" in host:
        raise OutgoingRefused(_("The address names no host."))
    path = quote(parts.path or "/", safe=_KEPT_SIGNS)
    if parts.query:
        path += f"?{quote(parts.query, safe=_KEPT_SIGNS)}"
    return _Target(address, parts.scheme, host, port or _PORTS[parts.scheme], path)


def _check_reachable(target: _Target, addresses: list[str]) -> None:
    """Raise OutgoingRefused if any address is not public: the name's owner decides which one a connection takes."""
    if f"{_shown(target)}:{target.port}" in settings.OUTGOING_ALLOWED_HOSTS:
        return
    if not addresses or not all(is_global(address) for address in addresses):
        raise OutgoingRefused(_no_public_host(target))


def _no_public_host(target: _Target) -> str:
    """Return the same text for an unknown name, or users could probe the names of this machine's network."""
    return _(
        "%(host)s is not a host of the public internet, or not known, so it is not fetched. "
        "An administrator can allow one with %(setting)s."
    ) % {"host": _shown(target), "setting": f"SPANWISE_OUTGOING_ALLOWED_HOSTS={_shown(target)}:{target.port}"}


def _shown(target: _Target) -> str:
    return f"[{target.host}]" if ":" in target.host else target.host


def _ask(
    connection: _PinnedConnection, target: _Target, method: str, data: bytes | None, headers: Mapping[str, str], deadline: _Deadline
) -> http.client.HTTPResponse:
    try:
        connection.request(method, target.path, body=data, headers=dict(headers))
        return connection.getresponse()
    except (OSError, http.client.HTTPException) as error:
        deadline.check(target.host)
        raise OutgoingFailed(_sentence(target, error)) from error


def _receive(
    answer: http.client.HTTPResponse, target: _Target, to: Path, max_bytes: int, deadline: _Deadline, progress: Callable[[int], None] | None
) -> Fetched:
    if answer.status not in {200, 304}:
        raise OutgoingFailed(
            _("%(host)s answers %(answer)s.") % {"host": target.host, "answer": f"{answer.status} {answer.reason}"[:150].rstrip()},
            status=answer.status, retry_after_s=_retry_after_s(answer),
        )  # fmt: skip
    if answer.getheader("Content-Encoding", "identity").strip().lower() not in {"", "identity"}:
        raise OutgoingFailed(_("%(host)s answers in a packed form that was not asked for.") % {"host": target.host})
    digest, size = hashlib.sha256(), 0
    if answer.status == 200:
        if answer.length is not None and answer.length > max_bytes:
            raise _too_large(target, max_bytes)
        try:
            with to.open("wb") as file:
                while block := answer.read(_BLOCK_BYTES):
                    size += len(block)
                    if size > max_bytes:
                        raise _too_large(target, max_bytes)
                    deadline.check(target.host)
                    file.write(block)
                    digest.update(block)
                    if progress is not None:
                        progress(size)
        except (OSError, http.client.HTTPException) as error:
            deadline.check(target.host)
            raise OutgoingFailed(_sentence(target, error)) from error
        deadline.check(target.host)
        if answer.length:  # announced bytes that never arrived
            raise OutgoingFailed(_("The connection to %(host)s was cut after %(size)s bytes.") % {"host": target.host, "size": size})
    return Fetched(
        status=answer.status, content_type=answer.getheader("Content-Type", "")[:200], etag=_header(answer, "ETag", 300),
        last_modified=_header(answer, "Last-Modified", 100), bytes=size, sha256=digest.hexdigest(), address=target.address,
    )  # fmt: skip


def _next_target(target: _Target, answer: http.client.HTTPResponse, data: bytes | None) -> _Target:
    location = answer.getheader("Location", "")
    if not location:
        raise OutgoingFailed(_("%(host)s redirects to nowhere.") % {"host": target.host}, status=answer.status)
    if data is not None and answer.status not in _REPEATED:
        raise OutgoingFailed(_("%(host)s redirects a question that holds data.") % {"host": target.host}, status=answer.status)
    following = _target(urljoin(target.address, location))
    if target.scheme == "https" and following.scheme != "https":
        raise OutgoingRefused(_("%(host)s redirects from https to http, which is not followed.") % {"host": target.host})
    return following


def _too_large(target: _Target, max_bytes: int) -> OutgoingFailed:
    size = f"{max_bytes / 2**20:g} MiB" if max_bytes >= 2**20 else f"{max_bytes} bytes"
    return OutgoingFailed(f"The answer of {target.host} has more than {size}.")


def _header(answer: http.client.HTTPResponse, name: str, longest: int) -> str:
    """Return a header to send back later; empty if it does not fit into its column."""
    value = answer.getheader(name, "")
    return value if len(value) <= longest and value.isascii() and value.isprintable() else ""


def _retry_after_s(answer: http.client.HTTPResponse) -> int | None:
    stated = answer.getheader("Retry-After", "")
    return min(int(stated), 86_400) if stated.isascii() and stated.isdigit() and len(stated) < 10 else None


def _sentence(target: _Target, error: Exception) -> str:
    host = target.host
    if isinstance(error, ssl.SSLCertVerificationError):
        return f"The certificate of {host} does not hold: {error.verify_message}."
    if isinstance(error, ssl.SSLError):
        return f"No secure connection to {host} came about."
    if isinstance(error, socket.gaierror):
        return _no_public_host(target)
    if isinstance(error, TimeoutError):
        return f"{host} did not answer in time."
    if isinstance(error, ConnectionRefusedError):
        return f"{host} takes no connections on port {target.port}."
    if isinstance(error, http.client.HTTPException):
        return f"What {host} answers is not HTTP, or the connection was cut."
    return f"The connection to {host} broke: {error.strerror or 'no reason given'}." if isinstance(error, OSError) else f"{host} failed."
