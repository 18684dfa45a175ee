"""Serializer fields for ids and attributes that other systems give to rows, with their limits."""

import json
import re
from typing import Any

from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, extend_schema_field
from rest_framework.request import Request

from workspace.api import strict_serializers as serializers
from workspace.api.errors import ApiProblem

MAX_EXTERNAL_ID_LENGTH = 200
MAX_ATTRIBUTES = 50
MAX_ATTRIBUTES_BYTES = 8_000
# Control characters, including newlines and tabs, and characters that change the direction of writing.
_REFUSED = re.compile("[\0-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")

ATTRIBUTES_SCHEMA = {
    "type": "object",
    "maxProperties": MAX_ATTRIBUTES,
    "additionalProperties": {"oneOf": [{"type": "string"}, {"type": "number"}, {"type": "boolean"}]},
}


EXTERNAL_ID = OpenApiParameter("external_id", str, description="only what has this id of another system")


def asked_external_id(request: Request, name: str = "external_id") -> str:
    """Return the id of a query parameter; empty without one. Raises ApiProblem 400 for an invalid id."""
    text = request.query_params.get(name, "").strip()
    if len(text) > MAX_EXTERNAL_ID_LENGTH or _REFUSED.search(text):
        fault = _("At most %(limit)s characters, and no control characters.") % {"limit": MAX_EXTERNAL_ID_LENGTH}
        raise ApiProblem(400, "invalid", f"{name}: {fault}", details={name: [fault]})
    return text


def _refuse_control_characters(text: str) -> None:
    if _REFUSED.search(text):
        raise serializers.ValidationError(_("Control characters are not allowed here."))


class ExternalIdField(serializers.CharField):
    """The id that another system has for a row; empty: none."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"max_length": MAX_EXTERNAL_ID_LENGTH, "allow_blank": True, "required": False} | options)

    def to_internal_value(self, data: Any) -> str:
        text: str = super().to_internal_value(data)
        _refuse_control_characters(text)
        return text


@extend_schema_field(ATTRIBUTES_SCHEMA)
class AttributesField(serializers.Field):
    """Attributes that other systems store with a row: at most 50 names, each with a text, number or boolean, 8 kB of JSON in total."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"required": False} | options)

    def to_internal_value(self, data: Any) -> dict[str, str | int | float | bool]:
        if not isinstance(data, dict):
            raise serializers.ValidationError(_("An object is needed."))
        if len(data) > MAX_ATTRIBUTES:
            raise serializers.ValidationError(_("At most %(limit)s attributes.") % {"limit": MAX_ATTRIBUTES})
        for name, value in data.items():
            if not isinstance(value, str | int | float):  # a boolean is an int
                raise serializers.ValidationError(_("An attribute is a text, a number or a boolean."))
            _refuse_control_characters(name)
            if isinstance(value, str):
                _refuse_control_characters(value)
        if len(json.dumps(data, ensure_ascii=False, separators=(",", ":")).encode()) > MAX_ATTRIBUTES_BYTES:
            raise serializers.ValidationError(_("The attributes take more than %(limit)s bytes.") % {"limit": MAX_ATTRIBUTES_BYTES})
        return data

    def to_representation(self, value: Any) -> Any:
        return value
