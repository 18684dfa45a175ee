"""The admin's field for JSON: the same strict reading as at every other door."""

from typing import Any

from django import forms
from django.conf import settings
from django.core.exceptions import ValidationError
from django.forms.fields import InvalidJSONInput

from inspection.importers.strict_json import JsonFault, can_be_stored, parse_strict_json


class StrictJSONField(forms.JSONField):
    """Refuses what is no JSON (NaN, endless nesting) and what PostgreSQL cannot hold, and shows it back with the fault."""

    def to_python(self, value: Any) -> Any:
        if isinstance(value, str) and value.strip():
            try:
                parsed = parse_strict_json(value, max_bytes=settings.DATA_UPLOAD_MAX_MEMORY_SIZE)
            except JsonFault as fault:
                raise ValidationError(str(fault), code="invalid") from fault
            if not can_be_stored(parsed):
                raise ValidationError("The texts have characters that are none.", code="invalid")
        return super().to_python(value)

    def bound_data(self, data: Any, initial: Any) -> Any:
        try:
            bound = super().bound_data(data, initial)
        except (ValueError, RecursionError):
            return InvalidJSONInput(data)
        return bound if can_be_stored(bound) else InvalidJSONInput(data)


class JSONObjectField(StrictJSONField):
    """A JSON object: a mapping of names to values."""

    def to_python(self, value: Any) -> Any:
        value = {} if value in self.empty_values else super().to_python(value)
        if not isinstance(value, dict):
            raise ValidationError('An object is needed here, such as {"power": "tower"}.', code="invalid")
        return value
