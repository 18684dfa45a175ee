"""Serializers of request bodies: their fields take the JSON types that the OpenAPI document names, and no others.

    from workspace import strict_serializers as serializers

DRF's own fields read numbers as texts, texts as numbers and booleans, and numbers as UUIDs.
"""

from typing import Any

from rest_framework import fields
from rest_framework.serializers import (
    DateTimeField,
    DictField,
    Field,
    JSONField,
    ListField,
    ListSerializer,
    ModelSerializer,
    Serializer,
    SerializerMethodField,
    ValidationError,
)

from workspace.api.fields import FiniteFloatField as FloatField

__all__ = [
    "BooleanField",
    "CharField",
    "ChoiceField",
    "DateTimeField",
    "DictField",
    "EmailField",
    "Field",
    "FloatField",
    "IntegerField",
    "JSONField",
    "ListField",
    "ListSerializer",
    "ModelSerializer",
    "RegexField",
    "Serializer",
    "SerializerMethodField",
    "URLField",
    "UUIDField",
    "ValidationError",
]


class CharField(fields.CharField):
    def to_internal_value(self, data: Any) -> str:
        return super().to_internal_value(_text(self, data))


class EmailField(CharField, fields.EmailField):
    pass


class RegexField(CharField, fields.RegexField):
    pass


class URLField(CharField, fields.URLField):
    pass


class UUIDField(fields.UUIDField):
    def to_internal_value(self, data: Any) -> Any:
        return super().to_internal_value(_text(self, data))


class IntegerField(fields.IntegerField):
    def to_internal_value(self, data: Any) -> int:
        if isinstance(data, str):
            self.fail("invalid")
        return super().to_internal_value(data)


class BooleanField(fields.BooleanField):
    def to_internal_value(self, data: Any) -> bool:
        if not isinstance(data, bool):
            self.fail("invalid", input=data)
        return data


class ChoiceField(fields.ChoiceField):
    def to_internal_value(self, data: Any) -> Any:
        value = super().to_internal_value(data)
        if isinstance(value, str) and not isinstance(data, str):
            self.fail("invalid_choice", input=data)
        return value


def _text(field: Field, data: Any) -> str:
    if not isinstance(data, str):
        field.fail("invalid", value=data)
    return str(data)
