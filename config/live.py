"""The websocket program's middleware and its responses to plain HTTP: probes, and 426 for all else."""

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import Any

from channels.security.websocket import WebsocketDenier
from django.conf import settings
from django.db import connections
from django.http.request import split_domain_port, validate_host

from operation.readiness import Readiness
from workspace.api.authentication import bearer_token
from workspace.api.errors import error_body
from workspace.live.graceful_shutdown import shutdown_here

_readiness = Readiness()

BODY = json.dumps(error_body(426, "upgrade_required", "This address is for websockets.")).encode()

STOPS = json.dumps(error_body(503, "unavailable", "This program is being stopped; try again.")).encode()

Receive = Callable[[], Awaitable[dict[str, Any]]]
Send = Callable[[dict[str, Any]], Awaitable[None]]
Application = Callable[[dict[str, Any], Receive, Send], Awaitable[None]]


class OriginCheck:
    """Accepts connections from a page of this site, and programs with a token that send no origin.

    A page of this site has the scheme, host and port at which the socket is requested, or is one of CSRF_TRUSTED_ORIGINS. A cookie alone is
    never sufficient.
    """

    def __init__(self, application: Application) -> None:
        self.application = application
        self.denied: Application = WebsocketDenier()

    async def __call__(self, scope: dict[str, Any], receive: Receive, send: Send) -> None:
        origins = [value for name, value in scope["headers"] if name == b"origin"]
        may = is_own_origin(origins[0], scope) if len(origins) == 1 else not origins and bearer_token(scope) is not None
        await (self.application if may else self.denied)(scope, receive, send)


def is_own_origin(origin: bytes, scope: dict[str, Any]) -> bool:
    """Whether this origin is one of this site's."""
    host = dict(scope["headers"]).get(b"host", b"").decode("latin-1").lower()
    named = origin.decode("latin-1").lower()
    if named in settings.CSRF_TRUSTED_ORIGINS:
        return True
    is_allowed = validate_host(split_domain_port(host)[0], settings.ALLOWED_HOSTS)
    return is_allowed and named == f"{'https' if settings.HTTPS else 'http'}://{host}"


class SaysGoodbye:
    """The outermost application: handles SIGTERM from the first request on, and then refuses websockets.

    The refusal makes the proxy try the next program.
    """

    def __init__(self, application: Application) -> None:
        self.application = application
        self._receives = False

    async def __call__(self, scope: dict[str, Any], receive: Receive, send: Send) -> None:
        shutdown = shutdown_here()
        if not self._receives:
            self._receives = True
            shutdown.receive_signal()
        if shutdown.has_begun and scope["type"] == "websocket":
            await _refuse(send)
        else:
            await self.application(scope, receive, send)


async def _refuse(send: Send) -> None:
    headers = [(b"content-type", b"application/json"), (b"retry-after", b"1"), (b"content-length", str(len(STOPS)).encode())]
    await send({"type": "websocket.http.response.start", "status": 503, "headers": headers})
    await send({"type": "websocket.http.response.body", "body": STOPS})


async def probed_or_upgrade_required(scope: dict[str, Any], receive: Receive, send: Send) -> None:
    if scope["path"] == "/healthz":
        await _answer(send, 200, {"alive": True})
    elif scope["path"] == "/readyz":
        faults = await asyncio.get_running_loop().run_in_executor(None, _faults)
        await _answer(send, 503 if faults else 200, {"ready": not faults} | ({"reasons": faults} if faults else {}))
    else:
        await upgrade_required(scope, receive, send)


def _faults() -> list[str]:
    try:
        return _readiness.faults()
    finally:
        connections.close_all()  # only this thread's


async def _answer(send: Send, status: int, reported: dict[str, Any]) -> None:
    body = json.dumps(reported).encode()
    headers = [(b"content-type", b"application/json"), (b"cache-control", b"no-store"), (b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})


async def upgrade_required(scope: dict[str, Any], receive: Receive, send: Send) -> None:
    headers = [(b"content-type", b"application/json"), (b"upgrade", b"websocket"), (b"content-length", str(len(BODY)).encode())]
    await send({"type": "http.response.start", "status": 426, "headers": headers})
    await send({"type": "http.response.body", "body": BODY})
