"""Request serializers that refuse unknown fields, so that a mistyped name is reported instead of ignored."""

import threading
from collections.abc import Callable, Collection, Mapping
from difflib import get_close_matches
from functools import cached_property
from typing import Any, NamedTuple

from django.core.exceptions import ValidationError as DjangoValidationError
from django.utils.translation import gettext as _
from rest_framework import serializers
from rest_framework.fields import empty, get_error_detail

MAX_NAMED = 10
MAX_REPORTED_LENGTH = 80
UNKNOWN_NAMED = "unknown_fields_told"

_of_thread = threading.local()  # `serializers`: by class, with their fields built


class _KnownField(NamedTuple):
    """A field that a body may name; `validate` is the serializer's `validate_...` method for it."""

    field: serializers.Field
    validate: Callable[[Any], Any] | None
    may_be_missing: bool


class KnownFieldsSerializer(serializers.Serializer):
    """Refuses unknown fields and suggests the most similar known one; in long lists only for the first few."""

    refuses_other_fields = True

    @classmethod
    def read(cls, body: Any, **context: Any) -> Any:
        """Return the values of a request's body. Raises ValidationError.

        Building a serializer's fields costs more than reading with them, so each thread builds those of a class once.
        """
        known: dict[type, Any] = _of_thread.__dict__.setdefault("serializers", {})
        if cls not in known:
            known[cls] = cls()
        known[cls]._context = dict(context)
        try:
            return known[cls].run_validation(body)
        except serializers.ValidationError:  # REST framework caches some messages in the language of their first use
            serializer = cls(data=body, context=dict(context))
            serializer.is_valid(raise_exception=True)
            return serializer.validated_data

    def to_internal_value(self, data: Any) -> Any:
        """Return the values as REST framework does, but spend no time on optional fields that the body does not name."""
        if not isinstance(data, Mapping):
            return super().to_internal_value(data)
        if not self._reads.keys() >= data.keys():
            self._refuse_unknown(data)
        values: dict[str, Any] = {}
        faults: dict[str, Any] = {}
        for name, (field, validate, may_be_missing) in self._reads.items():
            if may_be_missing and name not in data:
                continue
            try:
                value = field.run_validation(data.get(name, empty))
                values[name] = value if validate is None else validate(value)
            except serializers.ValidationError as error:
                faults[name] = error.detail
            except DjangoValidationError as error:
                faults[name] = get_error_detail(error)
            except serializers.SkipField:
                pass
        if faults:
            raise serializers.ValidationError(faults)
        return values

    def run_validation(self, data: Any = empty) -> Any:
        """Validate as REST framework does, but skip its checks for empty values and whole-object validators, which do not occur here."""
        if not isinstance(data, dict):
            return super().run_validation(data)
        values = self.to_internal_value(data)
        try:
            return self.validate(values)
        except (serializers.ValidationError, DjangoValidationError) as error:
            raise serializers.ValidationError(serializers.as_serializer_error(error)) from error

    @cached_property
    def _reads(self) -> dict[str, _KnownField]:
        return {
            name: _KnownField(field, getattr(self, f"validate_{name}", None), not field.required and field.default is empty)
            for name, field in self.fields.items()
            if not field.read_only
        }

    def _refuse_unknown(self, data: Mapping[Any, Any]) -> None:
        unknown = [str(name)[:MAX_REPORTED_LENGTH] for name in data if name not in self.fields]
        if not unknown:
            return
        context = self.context
        named = context.setdefault(UNKNOWN_NAMED, []) if isinstance(context, dict) else []
        full = unknown[: max(0, MAX_NAMED - len(named))]
        named += full
        words = {name: [_words(name, self.fields)] for name in full}
        raise serializers.ValidationError(words or {unknown[0]: [_("There is no such field.")]})


def _words(unknown: str, names: Collection[str]) -> str:
    nearest = get_close_matches(unknown, list(names), 1)
    return _("There is no such field; is %(name)s meant?") % {"name": nearest[0]} if nearest else _("There is no such field.")
