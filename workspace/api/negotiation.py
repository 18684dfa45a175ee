"""Which form an answer has."""

from typing import Any

from rest_framework.negotiation import BaseContentNegotiation, DefaultContentNegotiation
from rest_framework.request import Request

from workspace.api.errors import PROBLEM_JSON


class ProblemNegotiation(DefaultContentNegotiation):
    """Accept's `application/problem+json` is for errors alone (workspace/api/errors.py): a client that names only it takes any answer."""

    def get_accept_list(self, request: Request) -> list[str]:
        accepted = super().get_accept_list(request)
        return [entry for entry in accepted if entry.partition(";")[0].strip().lower() != PROBLEM_JSON] or ["*/*"]


class OneAnswer(BaseContentNegotiation):
    """A file is that file and errors are JSON, whatever the client says that it prefers."""

    def select_parser(self, request: Request, parsers: Any) -> Any:
        return parsers[0]

    def select_renderer(self, request: Request, renderers: Any, format_suffix: str | None = None) -> Any:
        return renderers[0], renderers[0].media_type
