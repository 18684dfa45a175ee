"""Requests whose fields are all known: a name that is mistyped is told instead of passed over."""

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

_of_thread = threading.local()  # `serializers`: by class, whose fields are made


class _Read(NamedTuple):
    """A field that a body may name; `validate` is the serializer's own `validate_...` for it."""

    field: serializers.Field
    validate: Callable[[Any], Any] | None
    may_be_missing: bool


class KnownFieldsSerializer(serializers.Serializer):
    """Refuses a field that it does not have, and names the one that is most like it; of long lists for the first few only."""

    refuses_other_fields = True

    @classmethod
    def read(cls, body: Any, **context: Any) -> Any:
        """Return the values of a request's body. Raises ValidationError.

        A serializer's fields cost more to make than to read with: each thread makes those of a class once.
        """
        known: dict[type, Any] = _of_thread.__dict__.setdefault("serializers", {})
        if cls not in known:
            known[cls] = cls()
        known[cls]._context = dict(context)
        try:
            return known[cls].run_validation(body)
        except serializers.ValidationError:  # REST framework keeps some messages in the language in which a field first wrote them
            serializer = cls(data=body, context=dict(context))
            serializer.is_valid(raise_exception=True)
            return serializer.validated_data

    def to_internal_value(self, data: Any) -> Any:
        """As REST framework's, but fields that the body does not name, and that need not be there, cost nothing."""
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
        """As REST framework's, which looks for what is not there: no object is empty, and there are no validators of a whole one."""
        if not isinstance(data, dict):
            return super().run_validation(data)
        values = self.to_internal_value(data)
        try:
            return self.validate(values)
        except (serializers.ValidationError, DjangoValidationError) as error:
            raise serializers.ValidationError(serializers.as_serializer_error(error)) from error

    @cached_property
    def _reads(self) -> dict[str, _Read]:
        return {
            name: _Read(field, getattr(self, f"validate_{name}", None), not field.required and field.default is empty)
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
