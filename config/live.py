"""What the websocket program answers to plain HTTP."""

import json
from collections.abc import Awaitable, Callable
from typing import Any

BODY = json.dumps({"error": {"code": "upgrade_required", "message": "This address is for websockets.", "details": None}}).encode()


async def upgrade_required(
    scope: dict[str, Any], receive: Callable[[], Awaitable[dict[str, Any]]], send: Callable[[dict[str, Any]], Awaitable[None]]
) -> None:
    headers = [(b"content-type", b"application/json"), (b"upgrade", b"websocket"), (b"content-length", str(len(BODY)).encode())]
    await send({"type": "http.response.start", "status": 426, "headers": headers})
    await send({"type": "http.response.body", "body": BODY})
