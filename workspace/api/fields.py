"""Finite numbers in requests, and reasons in responses."""

import math
from typing import Any

from rest_framework import serializers


class FiniteFloatField(serializers.FloatField):
    """A JSON number; texts such as "inf" are not numbers."""

    def to_internal_value(self, data: Any) -> float:
        if not is_number(data):
            self.fail("invalid")
        return float(data)


def is_number(value: Any) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) < 1e300 and math.isfinite(value)


class WhySerializer(serializers.Serializer):
    code = serializers.CharField(help_text="for programs: stays the same; see operation/reasons.py")
    params = serializers.DictField(help_text="what fills the sentence: names, numbers in the unit of the name's end, other reasons")
