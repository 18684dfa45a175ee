"""Whether an answer or a message is what the OpenAPI document says."""

from typing import Any

from drf_spectacular.generators import SchemaGenerator
from openapi_schema_validator import OAS30Validator


def openapi_document() -> Any:
    """Return the OpenAPI document, with the nullable references of drf-spectacular as client generators read them."""
    return _with_null(SchemaGenerator().get_schema(request=None, public=True))


def validate(instance: Any, schema: Any, document: Any) -> None:
    """Raises ValidationError where the instance is not what a schema of the document says."""
    OAS30Validator({**_with_null(schema), "components": document["components"]}).validate(instance)


def _with_null(value: Any) -> Any:
    """Write `nullable` beside `allOf` as a choice: in a strict reading of OpenAPI 3.0.3 the referenced shape alone would count."""
    if isinstance(value, list):
        return [_with_null(inner) for inner in value]
    if not isinstance(value, dict):
        return value
    read = {name: _with_null(inner) for name, inner in value.items()}
    if read.get("nullable") is True and "allOf" in read:
        read["anyOf"] = [{"allOf": read.pop("allOf")}, {"enum": [None], "nullable": True}]
        del read["nullable"]
    return read
