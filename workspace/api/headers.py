"""Response headers that the OpenAPI document names. Settings import this module, so it imports nothing of Django."""

from typing import Any

HEADERS: dict[str, dict[str, Any]] = {
    "ETag": {"description": "the revision of what is answered, for If-Match and If-None-Match", "schema": {"type": "string"}},
    "Location": {"description": "path of what was created, or of the job that does the work", "schema": {"type": "string"}},
    "Retry-After": {"description": "seconds to wait before the next try", "schema": {"type": "integer", "minimum": 1}},
    "RateLimit": {
        "description": 'what is left, where a view has a limit of its own: `"plans";r=0;t=1`, t in seconds',
        "schema": {"type": "string"},
    },
    "RateLimit-Policy": {"description": 'the limit: `"plans";q=40;w=1`, q requests in w seconds', "schema": {"type": "string"}},
    "Idempotency-Replayed": {
        "description": "true: the answer to an earlier request with the same Idempotency-Key",
        "schema": {"type": "string", "enum": ["true"]},
    },
    "WWW-Authenticate": {"description": "how to say who asks: Bearer", "schema": {"type": "string"}},
}
HEADERS_OF_ERRORS = {"401": ["WWW-Authenticate"], "429": ["Retry-After", "RateLimit", "RateLimit-Policy"], "503": ["Retry-After"]}
