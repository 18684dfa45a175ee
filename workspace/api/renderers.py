"""Writing answers, and which form an answer has."""

from collections.abc import Mapping
from typing import Any

import orjson
from rest_framework.negotiation import BaseContentNegotiation, DefaultContentNegotiation
from rest_framework.renderers import BaseRenderer
from rest_framework.request import Request

from workspace.api.errors import PROBLEM_JSON


class ProblemNegotiation(DefaultContentNegotiation):
    """Accept's `application/problem+json` is for errors alone (workspace/api/errors.py): a client that names only it takes any answer."""

    def select_renderer(self, request: Request, renderers: Any, format_suffix: str | None = None) -> Any:
        """The first one at once for whoever takes anything, or names just it."""
        first = renderers[0]
        if format_suffix is None and request.META.get("HTTP_ACCEPT", "*/*") in ("*/*", first.media_type):
            return first, first.media_type
        return super().select_renderer(request, renderers, format_suffix)

    def get_accept_list(self, request: Request) -> list[str]:
        accepted = super().get_accept_list(request)
        return [entry for entry in accepted if entry.partition(";")[0].strip().lower() != PROBLEM_JSON] or ["*/*"]


class OneAnswer(BaseContentNegotiation):
    """A file is that file and errors are JSON, whatever the client says that it prefers."""

    def select_parser(self, request: Request, parsers: Any) -> Any:
        return parsers[0]

    def select_renderer(self, request: Request, renderers: Any, format_suffix: str | None = None) -> Any:
        return renderers[0], renderers[0].media_type


class FastJSONRenderer(BaseRenderer):
    """JSON for large answers of plain values: a plan of some hundred waypoints is written ten times faster than by the standard library."""

    media_type = "application/json"
    format = "json"
    charset = None

    def render(self, data: Any, accepted_media_type: str | None = None, renderer_context: Mapping[str, Any] | None = None) -> bytes:
        return b"" if data is None else orjson.dumps(data, default=str)
