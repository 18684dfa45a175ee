"""The way to the server, over HTTPS."""

import json
import urllib.error
import urllib.request
from dataclasses import dataclass, field
from http.client import HTTPException
from typing import Any, Protocol
from urllib.parse import urlsplit

MAX_ANSWER_BYTES = 16 * 1024 * 1024
THIS_MACHINE = {"127.0.0.1", "::1", "localhost"}


class LinkDown(Exception):
    """Nothing came back, or nothing that can be read: whether the server has had the request is not known."""


@dataclass(frozen=True)
class Answer:
    """`body` is decoded JSON, None without one."""

    status: int
    body: Any = None
    headers: dict[str, str] = field(default_factory=dict)  # names in lower case


class Link(Protocol):
    def ask(self, method: str, what: str, body: Any = None, headers: dict[str, str] | None = None) -> Answer:
        """`what` is route, telemetry, acknowledgements, results or captures. Raises LinkDown."""


class HttpLink:
    """`server` is the address of Spanwise, such as https://spanwise.example. A token goes to this server and to no other."""

    def __init__(self, server: str, token: str, *, timeout_s: float = 4.0, plain_http: bool = False) -> None:
        parts = urlsplit(server)
        if parts.scheme != "https" and not (parts.scheme == "http" and (plain_http or parts.hostname in THIS_MACHINE)):
            raise ValueError("The server's address must begin with https://")
        self._base = f"{server.rstrip('/')}/api/v1/uav-link/"
        self._token = token
        self._timeout_s = timeout_s
        self._opener = urllib.request.build_opener(_NoRedirects)

    def ask(self, method: str, what: str, body: Any = None, headers: dict[str, str] | None = None) -> Answer:
        request = urllib.request.Request(self._base + what, method=method)  # noqa: S310 - the scheme was looked at
        request.add_header("Authorization", f"Bearer {self._token}")
        for name, value in (headers or {}).items():
            request.add_header(name, value)
        if body is not None:
            request.data = json.dumps(body, allow_nan=False).encode()
            request.add_header("Content-Type", "application/json")
        try:
            with self._opener.open(request, timeout=self._timeout_s) as response:
                return _answer(response.status, response.headers, response.read(MAX_ANSWER_BYTES))
        except urllib.error.HTTPError as error:
            with error:
                return _answer(error.code, error.headers, b"")
        except (OSError, HTTPException, ValueError) as error:
            raise LinkDown(str(error)) from error


class _NoRedirects(urllib.request.HTTPRedirectHandler):
    """The token would go along."""

    def redirect_request(self, *args: Any) -> None:
        return None


def _answer(status: int, headers: Any, body: bytes) -> Answer:
    return Answer(status, json.loads(body) if body else None, {name.lower(): value for name, value in headers.items()})
