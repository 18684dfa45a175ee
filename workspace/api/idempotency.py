"""`Idempotency-Key` for a POST that creates: decorate the view's `post` with `@idempotent`; nothing else is needed.

The key, the response and all writes of the view are committed together. A successful request is never repeated, a failed one leaves no
trace, and of two concurrent ones the second waits and gets the first one's response.
"""

import hashlib
import json
from collections.abc import Callable
from functools import wraps
from typing import Any

from django.db import transaction
from django.utils.translation import gettext as _
from rest_framework.request import Request
from rest_framework.response import Response

from workspace.api.errors import ApiProblem
from workspace.api.signed_in import SignedInRequest
from workspace.models import IdempotencyKey

MAX_KEY_LENGTH = 200
TAKES_KEY = "takes_idempotency_key"
KEPT_HEADERS = ("Location", "ETag")

Handler = Callable[..., Response]


def idempotent(handler: Handler) -> Handler:
    """Decorate a view's method; it must return a `Response` and do work after the commit by `transaction.on_commit`."""

    @wraps(handler)
    def answer_once(view: Any, request: SignedInRequest, *args: Any, **kwargs: Any) -> Response:
        key = request.META.get("HTTP_IDEMPOTENCY_KEY")
        if key is None:
            return handler(view, request, *args, **kwargs)
        if not (0 < len(key) <= MAX_KEY_LENGTH and key.isascii() and key.isprintable()):
            raise ApiProblem(
                400,
                "invalid",
                _("An Idempotency-Key has 1 to %(longest_key)s printable ASCII characters.") % {"longest_key": MAX_KEY_LENGTH},
            )
        digest = _digest(request)
        with transaction.atomic():
            # Waits here while another transaction holds the same key.
            IdempotencyKey.objects.bulk_create([IdempotencyKey(user=request.user, key=key, request_sha256=digest)], ignore_conflicts=True)
            kept = IdempotencyKey.objects.select_for_update().get(user=request.user, key=key)
            if kept.status is None:
                response = handler(view, request, *args, **kwargs)
                _keep(kept, response, view)
                return response
        if kept.request_sha256 != digest:
            raise ApiProblem(422, "idempotency_conflict", _("This Idempotency-Key was used for another request."))
        return Response(kept.body, status=kept.status, headers={**kept.headers, "Idempotency-Replayed": "true"})

    setattr(answer_once, TAKES_KEY, True)  # read by workspace/api/schema.py
    return answer_once


def _digest(request: Request) -> str:
    body = json.dumps(request.data, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(f"{request.method} {request.get_full_path()}\n{body}".encode()).hexdigest()


def _keep(kept: IdempotencyKey, response: Response, view: Any) -> None:
    if response.status_code >= 400:  # an error that was returned instead of raised: roll back everything
        transaction.set_rollback(True)
        return
    kept.status = response.status_code
    kept.headers = {name: response[name] for name in KEPT_HEADERS if name in response}
    kept.body = json.loads(view.get_renderers()[0].render(response.data) or b"null")
    kept.save(update_fields=["status", "headers", "body"])
