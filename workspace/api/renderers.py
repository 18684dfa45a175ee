"""Renderers, and the choice of a response's format."""

from collections.abc import Mapping
from typing import Any

import orjson
from rest_framework.negotiation import BaseContentNegotiation, DefaultContentNegotiation
from rest_framework.renderers import BaseRenderer
from rest_framework.request import Request

from workspace.api.errors import PROBLEM_JSON


class ProblemNegotiation(DefaultContentNegotiation):
    """Treats `application/problem+json` in Accept as for errors only: a client that names just it gets any format."""

    def select_renderer(self, request: Request, renderers: Any, format_suffix: str | None = None) -> Any:
        """Return the first renderer at once for a client that accepts anything, or names only it."""
        first = renderers[0]
        if format_suffix is None and request.META.get("HTTP_ACCEPT", "*/*") in ("*/*", first.media_type):
            return first, first.media_type
        return super().select_renderer(request, renderers, format_suffix)

    def get_accept_list(self, request: Request) -> list[str]:
        accepted = super().get_accept_list(request)
        return [entry for entry in accepted if entry.partition(";")[0].strip().lower() != PROBLEM_JSON] or ["*/*"]


class OneAnswer(BaseContentNegotiation):
    """Always returns the file, and errors as JSON, whatever the client prefers."""

    def select_parser(self, request: Request, parsers: Any) -> Any:
        return parsers[0]

    def select_renderer(self, request: Request, renderers: Any, format_suffix: str | None = None) -> Any:
        return renderers[0], renderers[0].media_type


class FastJSONRenderer(BaseRenderer):
    """JSON for large responses of plain values: a plan of some hundred waypoints renders ten times as fast as by the standard library."""

    media_type = "application/json"
    format = "json"
    charset = None

    def render(self, data: Any, accepted_media_type: str | None = None, renderer_context: Mapping[str, Any] | None = None) -> bytes:
        return b"" if data is None else orjson.dumps(data, default=str)
