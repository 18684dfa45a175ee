"""Whole numbers in the query, described in the OpenAPI document and validated by the same bounds."""

from dataclasses import dataclass
from typing import Any

from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter
from rest_framework.request import Request

from workspace.api.errors import ApiProblem

MAX_NUMBER = 999_999_999


@dataclass(frozen=True)
class WholeNumber:
    """A query parameter, by default an id. With `max_values` it may be repeated up to that number."""

    name: str
    description: str = ""
    minimum: int = 1
    maximum: int = MAX_NUMBER
    max_values: int = 1
    required: bool = False

    @property
    def documented(self) -> OpenApiParameter:
        schema: dict[str, Any] = {"type": "integer", "minimum": self.minimum, "maximum": self.maximum}
        if self.max_values > 1:
            schema = {"type": "array", "items": schema, "maxItems": self.max_values} | ({"minItems": 1} if self.required else {})
        return OpenApiParameter(self.name, schema, required=self.required, description=self.description)

    def asked(self, request: Request) -> int | None:
        """Return the value of a request; None without one. Raises ApiProblem 400."""
        text = request.query_params.get(self.name, "")
        if not text and not self.required:
            return None
        return self._read(text)

    def all_asked(self, request: Request) -> list[int]:
        """Return the values of a request, each once. Raises ApiProblem 400."""
        texts = request.query_params.getlist(self.name)
        if len(texts) > self.max_values or (self.required and not texts):
            raise self._invalid(_("From 1 to %(most)s numbers are needed.") % {"most": self.max_values})
        return list(dict.fromkeys(map(self._read, texts)))

    def _read(self, text: str) -> int:
        if text.isascii() and text.isdigit() and len(text) <= len(str(self.maximum)) and self.minimum <= int(text) <= self.maximum:
            return int(text)
        raise self._invalid(
            _("A whole number from %(minimum)s to %(maximum)s is needed.") % {"minimum": self.minimum, "maximum": self.maximum}
        )

    def _invalid(self, fault: str) -> ApiProblem:
        return ApiProblem(400, "invalid", f"{self.name}: {fault}", details={self.name: [fault]})
