"""Additions to the OpenAPI document for all endpoints: paging, headers, and common errors."""

import re
from collections.abc import Iterable
from typing import Any

from drf_spectacular.openapi import AutoSchema
from drf_spectacular.plumbing import get_doc
from drf_spectacular.utils import OpenApiExample, OpenApiParameter, PolymorphicProxySerializer
from rest_framework.permissions import SAFE_METHODS

from workspace.api.errors import PROBLEM_JSON
from workspace.api.headers import HEADERS_OF_ERRORS
from workspace.api.idempotency import MAX_KEY_LENGTH, TAKES_KEY
from workspace.api.paging import LIMIT
from workspace.api.permissions import InTheBrowserAlone
from workspace.jobs.serializers import ErrorSerializer

TIME = {"type": "string", "format": "date-time"}
DAY_OR_TIME = {"anyOf": [{"type": "string", "format": "date"}, TIME]}
PRINTABLE_ASCII = "^[ -~]+$"


def several_of(values: Iterable[str]) -> dict[str, Any]:
    """Return the schema of a query parameter with a comma-separated list of these values."""
    one = "|".join(map(re.escape, values))
    return {"type": "string", "pattern": f"^({one})?(,({one})?)*$"}


def request_example(value: Any) -> OpenApiExample:
    """Return an example of a body, for one whose required fields alone say little."""
    return OpenApiExample("request", value=value, request_only=True)


PAGE_PARAMETERS = [
    LIMIT.documented,
    OpenApiParameter("cursor", str, description="taken from `next` of the page before"),
]
CHANGED_SINCE = OpenApiParameter(
    "changed_since", DAY_OR_TIME, description="only what was made or changed at this time or later: date or time with offset, ISO 8601"
)

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
CONDITIONS = {"If-Match", "If-None-Match"}
OTHERS_WITH_ETAG = {"get_mission_approval", "get_scene", "get_tile", "undo_change"}  # these declare no such header, or return no revision
KEY_CONFLICT = "The Idempotency-Key was used for another request."

IDEMPOTENCY_KEY: dict[str, Any] = {
    "in": "header",
    "name": "Idempotency-Key",
    "schema": {"type": "string", "minLength": 1, "maxLength": MAX_KEY_LENGTH, "pattern": PRINTABLE_ASCII},
    "description": "a repeated request is answered as the first one was and changes nothing again; printable ASCII, a new one for each act",
}


class SpanwiseSchema(AutoSchema):
    """Adds the errors that every operation shares, so that views declare only their own."""

    def get_operation(self, *args: Any, **kwargs: Any) -> dict[str, Any] | None:
        operation = super().get_operation(*args, **kwargs)
        if operation is None:
            return None
        responses = operation["responses"]
        if self._takes_key():
            operation.setdefault("parameters", []).append(dict(IDEMPOTENCY_KEY))
            responses.setdefault("422", {"description": KEY_CONFLICT})
        error = {"schema": self.resolve_serializer(ErrorSerializer, "response").ref}
        for status, description in ERRORS.items():
            if status in ONLY_WITH_BODY and self.method in SAFE_METHODS:
                continue
            responses.setdefault(str(status), {"description": description})
        for status, response in responses.items():
            if status >= "400" and "content" not in response:
                response["content"] = {"application/json": error, PROBLEM_JSON: error}
        for status, response in responses.items():
            _name_headers(response, self._headers_of(status))
        return operation

    def get_auth(self) -> list[dict[str, Any]]:
        """Leave out the token where it is refused."""
        schemes: list[dict[str, Any]] = super().get_auth()
        is_refused = self.method not in SAFE_METHODS and _is_for_browsers(self.view)
        return [scheme for scheme in schemes if not is_refused or "bearerToken" not in scheme]

    def get_description(self) -> str:  # type: ignore[override]  # as in drf-spectacular
        """Return no docstring of a view's class, which is for readers of the code; `extend_schema` states descriptions."""
        return get_doc(getattr(self.view, self.method.lower(), None))

    def _get_request_for_media_type(self, serializer: Any, direction: Any = "request") -> Any:
        """Require a body of several shapes for POST; drf-spectacular does so only for single shapes."""
        schema, is_required = super()._get_request_for_media_type(serializer, direction)
        return schema, is_required or (self.method == "POST" and isinstance(serializer, PolymorphicProxySerializer))

    def _map_basic_serializer(self, serializer: Any, direction: Any) -> dict[str, Any]:
        """Forbid other fields in a body whose serializer refuses them, and leave out descriptions of base classes."""
        schema: dict[str, Any] = super()._map_basic_serializer(serializer, direction)
        kind = serializer if isinstance(serializer, type) else type(serializer)
        if not vars(kind).get("__doc__"):
            schema.pop("description", None)
        if direction == "request" and getattr(serializer, "refuses_other_fields", False):
            schema["additionalProperties"] = False
        return schema

    def _map_serializer_field(self, field: Any, direction: Any, bypass_extensions: bool = False) -> Any:
        """Add the minimum length of lists, which drf-spectacular omits where items are objects or required."""
        schema = super()._map_serializer_field(field, direction, bypass_extensions)
        least = max(int(getattr(field, "allow_empty", True) is False), getattr(field, "min_length", None) or 0)
        if direction == "request" and least and schema and schema.get("type") == "array":
            schema.setdefault("minItems", least)
        return schema

    def _insert_field_validators(self, field: Any, schema: dict[str, Any]) -> None:
        """Put a blank default beside drf-spectacular's choice: in its first branch, a blank would have to be an email address."""
        super()._insert_field_validators(field, schema)
        if (above := getattr(field, "above", None)) is not None:
            schema |= {"minimum": above, "exclusiveMinimum": True}
        for branch in schema.get("oneOf", []):
            if "default" in branch:
                schema["default"] = branch.pop("default")

    def _takes_key(self) -> bool:
        """Whether the handler, or a private method that it delegates to, is `@idempotent`."""
        handlers = [getattr(self.view, self.method.lower(), None)]
        if self.method == "POST":
            handlers += [member for name, member in vars(type(self.view)).items() if name.startswith("_")]
        return any(getattr(handler, TAKES_KEY, False) for handler in handlers)

    def _headers_of(self, status: str) -> list[str]:
        names = list(HEADERS_OF_ERRORS.get(status, []))
        if status < "400":
            names += ["Location"] if status in {"201", "202"} else []
            names += ["Idempotency-Replayed"] if self._takes_key() else []
        return names


def _is_for_browsers(view: Any) -> bool:
    return any(isinstance(each, type) and issubclass(each, InTheBrowserAlone) for each in view.permission_classes)


def name_etags(result: dict[str, Any], **_: Any) -> dict[str, Any]:
    """Add ETag to the responses of operations with conditional requests, and to others of the same shape. Hook of drf-spectacular."""
    operations = [each for methods in result["paths"].values() for each in methods.values()]
    shapes: set[str] = set()
    for operation in operations:
        if any(parameter["name"] in CONDITIONS for parameter in operation.get("parameters", [])):
            shapes |= {_shape_of(response) for response in _successes(operation)}
    schemas = result["components"]["schemas"]
    with_revision = {f"#/components/schemas/{name}" for name in schemas if "revision" in schemas[name].get("properties", {})}
    shapes = (shapes | with_revision) - {""}
    for operation in operations:
        for response in _successes(operation):
            if _shape_of(response) in shapes or operation["operationId"] in OTHERS_WITH_ETAG:
                _name_headers(response, ["ETag"])
        if "304" in operation["responses"]:
            _name_headers(operation["responses"]["304"], ["ETag"])
    return result


def _name_headers(response: dict[str, Any], names: list[str]) -> None:
    if names:
        response.setdefault("headers", {}).update({name: {"$ref": f"#/components/headers/{name}"} for name in names})


def _successes(operation: dict[str, Any]) -> list[dict[str, Any]]:
    return [response for status, response in operation["responses"].items() if status in {"200", "201", "202"}]


def _shape_of(response: dict[str, Any]) -> str:
    """Return the reference to the shape of a JSON response, or an empty text."""
    schema: dict[str, str] = response.get("content", {}).get("application/json", {}).get("schema", {})
    return schema.get("$ref", "")
