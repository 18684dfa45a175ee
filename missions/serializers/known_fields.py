"""Requests whose fields are all known: a name that is mistyped is told instead of passed over."""

from collections.abc import Collection, Mapping
from difflib import get_close_matches
from typing import Any

from django.utils.translation import gettext as _
from rest_framework import serializers

MAX_TOLD = 10
MAX_REPORTED_LENGTH = 80
UNKNOWN_TOLD = "unknown_fields_told"


class KnownFieldsSerializer(serializers.Serializer):
    """Refuses a field that it does not have, and names the one that is most like it; of long lists for the first few only."""

    refuses_other_fields = True

    def to_internal_value(self, data: Any) -> Any:
        if isinstance(data, Mapping):
            unknown = [str(name)[:MAX_REPORTED_LENGTH] for name in data if name not in self.fields]
            if unknown:
                context = self.context
                told = context.setdefault(UNKNOWN_TOLD, []) if isinstance(context, dict) else []
                full = unknown[: max(0, MAX_TOLD - len(told))]
                told += full
                words = {name: [_words(name, self.fields)] for name in full}
                raise serializers.ValidationError(words or {unknown[0]: [_("There is no such field.")]})
        return super().to_internal_value(data)


def _words(unknown: str, names: Collection[str]) -> str:
    nearest = get_close_matches(unknown, list(names), 1)
    return _("There is no such field; is %(name)s meant?") % {"name": nearest[0]} if nearest else _("There is no such field.")
