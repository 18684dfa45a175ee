"""What the websocket program answers to plain HTTP."""

import json
from collections.abc import Awaitable, Callable
from typing import Any

from channels.security.websocket import AllowedHostsOriginValidator

from workspace.authentication import bearer_token

BODY = json.dumps({"error": {"code": "upgrade_required", "message": "This address is for websockets.", "details": None}}).encode()

Receive = Callable[[], Awaitable[dict[str, Any]]]
Send = Callable[[dict[str, Any]], Awaitable[None]]
Application = Callable[[dict[str, Any], Receive, Send], Awaitable[None]]


class OriginCheck:
    """Lets through who comes from this host, and programs with a token that name no origin at all. A cookie alone is never enough."""

    def __init__(self, application: Application) -> None:
        self.application = application
        self.checked: Application = AllowedHostsOriginValidator(application)

    async def __call__(self, scope: dict[str, Any], receive: Receive, send: Send) -> None:
        names_none = all(name != b"origin" for name, _ in scope["headers"])
        through = self.application if names_none and bearer_token(scope) is not None else self.checked
        await through(scope, receive, send)


async def upgrade_required(scope: dict[str, Any], receive: Receive, send: Send) -> None:
    headers = [(b"content-type", b"application/json"), (b"upgrade", b"websocket"), (b"content-length", str(len(BODY)).encode())]
    await send({"type": "http.response.start", "status": 426, "headers": headers})
    await send({"type": "http.response.body", "body": BODY})
