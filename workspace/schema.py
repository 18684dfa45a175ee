"""What the OpenAPI document says about every address: paging, and the errors that any of them can answer."""

from typing import Any

from drf_spectacular.openapi import AutoSchema
from drf_spectacular.utils import OpenApiParameter
from rest_framework.permissions import SAFE_METHODS

from workspace.serializers import ErrorSerializer

PAGE_PARAMETERS = [
    OpenApiParameter("limit", int, description="rows a page; 100 unless told, 1,000 at most"),
    OpenApiParameter("cursor", str, description="taken from `next` of the page before"),
]

ERRORS = {
    400: "The input is not valid.",
    401: "Not signed in, or the token is not valid.",
    403: "The role does not allow this.",
    404: "Not here, or another organisation's.",
    406: "The wanted media type is not to be had here.",
    413: "The body is too large.",
    415: "The body is not JSON.",
    429: "Too many requests; see Retry-After.",
    503: "Not possible at the moment; see Retry-After.",
}
ONLY_WITH_BODY = {413, 415}


class SpanwiseSchema(AutoSchema):
    """Adds the errors that every operation shares, so that views name only what is their own."""

    def get_operation(self, *args: Any, **kwargs: Any) -> dict[str, Any] | None:
        operation = super().get_operation(*args, **kwargs)
        if operation is None:
            return None
        component = self.resolve_serializer(ErrorSerializer, "response")
        for status, description in ERRORS.items():
            if status in ONLY_WITH_BODY and self.method in SAFE_METHODS:
                continue
            operation["responses"].setdefault(
                str(status), {"description": description, "content": {"application/json": {"schema": component.ref}}}
            )
        return operation
