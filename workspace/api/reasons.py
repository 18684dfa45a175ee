"""Reasons in responses of the API."""

from workspace.api import strict_serializers as serializers


class WhySerializer(serializers.Serializer):
    code = serializers.CharField(help_text="for programs: stays the same; see operation/reasons.py")
    params = serializers.DictField(help_text="what fills the sentence: names, numbers in the unit of the name's end, other reasons")
