"""Shapes of the workspace's API."""

from typing import Any, TypeAlias

from drf_spectacular.utils import extend_schema_field
from rest_framework import serializers

from workspace.api.fields import WhySerializer
from workspace.jobs.result_texts import result_with_texts
from workspace.models import Job, JobState
from workspace.reason_texts import column_text, reasons_of_column, with_message

# These declared fields are named like attributes of serializers, such as `label`, or set to None to omit an inherited one. DRF removes
# declared fields from the class, so neither overrides anything.
Declared: TypeAlias = Any


class ErrorDetailSerializer(serializers.Serializer):
    code = serializers.CharField(help_text="for programs: stays the same")
    message = serializers.CharField(help_text="for people: one sentence")
    details = serializers.JSONField(allow_null=True, help_text='for invalid input: {"place.in.the.body": ["what is wrong"]}')


class ErrorSerializer(serializers.Serializer):
    """The shape of every error of the API: `error`, and beside it a problem of RFC 9457."""

    error = ErrorDetailSerializer()
    type = serializers.CharField(help_text="`urn:problem-type:spanwise:` and the error's code")
    title = serializers.CharField(help_text="the status in words")
    status = serializers.IntegerField(help_text="the HTTP status")
    detail = serializers.CharField(help_text="as `error.message`")
    instance = serializers.CharField(required=False, help_text="path of the request, where it is known")


class JobErrorSerializer(serializers.Serializer):
    code = serializers.CharField(help_text="for programs: stays the same")
    message = serializers.CharField(help_text="for people: one sentence")
    why = WhySerializer(many=True, help_text="the message for programs; empty where only a text is known")


@extend_schema_field(JobErrorSerializer(allow_null=True))
class JobErrorField(serializers.JSONField):
    """Reason of a failed job, as stored."""


class JobSerializer(serializers.ModelSerializer):
    """Work that takes longer than a request. `result` is set once the state is `done`, `error` once it is `failed`.

    During the search for a plan, `best` is the best one so far, updated at most once a second: `value` and the lower `bound` in `unit`
    (metres, or seconds where the longest route counts), the number of unassigned targets, and the `routes` as lines.
    """

    state = serializers.ChoiceField(choices=JobState.choices)
    why = serializers.SerializerMethodField(help_text="the message for programs; empty where only a text is known")
    error = JobErrorField(allow_null=True, read_only=True)

    class Meta:
        model = Job
        fields = ["id", "task", "state", "progress", "message", "why", "best", "result", "error", "created_at", "started_at", "finished_at"]
        read_only_fields = fields

    @extend_schema_field(WhySerializer(many=True))
    def get_why(self, instance: Job) -> list[dict[str, Any]]:
        return reasons_of_column(instance.message_why, instance.message)

    def to_representation(self, instance: Job) -> dict[str, Any]:
        shown = super().to_representation(instance)
        shown["message"] = column_text(instance.message_why, instance.message)
        if shown.get("result"):
            shown["result"] = result_with_texts(instance.task, instance.result)
        if instance.error:
            shown["error"] = with_message({"why": [], **instance.error})
        return shown


class ListedJobSerializer(JobSerializer):
    """A job in a list, without large fields."""

    class Meta(JobSerializer.Meta):
        fields = [name for name in JobSerializer.Meta.fields if name not in {"best", "result"}]
        read_only_fields = fields


class JobPageSerializer(serializers.Serializer):
    results = ListedJobSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")
