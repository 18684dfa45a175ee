"""Requests and responses of the HTTP link, for the OpenAPI document, and the envelopes of requests."""

import json
from typing import Any

from drf_spectacular.utils import extend_schema_serializer
from rest_framework import serializers

from mavlink.decoding.companion_reports import (
    CAPTURE_INTEGERS,
    CAPTURE_NUMBERS,
    FLAGS,
    INTEGERS,
    MAX_MODE_LENGTH,
    MAX_URL_LENGTH,
    NUMBERS,
    instant,
)
from missions.fields import PositionField
from missions.models import CommandKind, TargetState
from missions.serializers.known_fields import KnownFieldsSerializer
from missions.services.commands.flight_progress import FlightEnd
from telemetry.services.results import NewResult
from workspace.jobs.serializers import Declared

MAX_RECORDS = 1_000
MAX_ACKNOWLEDGEMENTS = 100
MAX_RESULTS = 100
MAX_CAPTURES = 200
MAX_FLIGHTS = 10_000
MAX_PLACE = 2**31 - 1
MAX_RESULT_BYTES = 64 * 1024
MAX_STREAM_LENGTH = 64
MAX_SEQUENCE = 2**63 - 1


class StreamField(serializers.RegexField):
    """Name of one run of the sender's counter."""

    def __init__(self, **options: Any) -> None:
        words = "one run of the UAV's counter: a new one whenever its numbers begin anew"
        super().__init__(r"^[A-Za-z0-9._:-]+$", max_length=MAX_STREAM_LENGTH, help_text=words, **options)


class ReportSerializer(serializers.Serializer):
    """One report. Heights name their reference; angles are in degrees, speeds in m/s. Unknown values are omitted or null."""

    sequence = serializers.IntegerField(min_value=0, max_value=MAX_SEQUENCE, help_text="grows within the stream")
    measured_at = serializers.DateTimeField(help_text="by the UAV's clock, with its zone")
    mission = serializers.UUIDField(required=False, allow_null=True, help_text="without it: the one that the UAV flies")
    position = PositionField(required=False, allow_null=True)
    mode = serializers.CharField(required=False, allow_null=True, max_length=MAX_MODE_LENGTH)

    def get_fields(self) -> dict[str, serializers.Field]:
        fields: dict[str, serializers.Field] = super().get_fields()
        for name, (lowest, highest) in NUMBERS.items():
            fields[name] = serializers.FloatField(required=False, allow_null=True, min_value=lowest, max_value=highest)
        for name, (lowest, highest) in INTEGERS.items():
            fields[name] = serializers.IntegerField(required=False, allow_null=True, min_value=lowest, max_value=highest)
        for name in FLAGS:
            fields[name] = serializers.BooleanField(required=False, allow_null=True)
        return fields


class ReportsSerializer(serializers.Serializer):
    stream = StreamField()
    records: serializers.ListSerializer[Any] = serializers.ListSerializer(child=ReportSerializer(), min_length=1, max_length=MAX_RECORDS)


class ReportsEnvelopeSerializer(KnownFieldsSerializer):
    """A batch whose records are validated one by one later."""

    stream = StreamField()
    records = serializers.ListField(min_length=1, max_length=MAX_RECORDS)


class LinkCaptureSerializer(serializers.Serializer):
    """One photo. Its angles are those of the camera, the yaw from true north. Unknown values are omitted or null."""

    sequence = serializers.IntegerField(min_value=0, max_value=MAX_SEQUENCE, help_text="grows within the stream")
    taken_at = serializers.DateTimeField(help_text="by the UAV's clock, with its zone")
    mission = serializers.UUIDField(required=False, allow_null=True, help_text="without it: the one that the UAV flies")
    position = PositionField(required=False, allow_null=True)
    is_taken = serializers.BooleanField(required=False, allow_null=True, help_text="false: the camera failed")
    file_url = serializers.CharField(required=False, allow_null=True, max_length=MAX_URL_LENGTH, help_text="name or address of the picture")

    def get_fields(self) -> dict[str, serializers.Field]:
        fields: dict[str, serializers.Field] = super().get_fields()
        for name, (lowest, highest) in CAPTURE_NUMBERS.items():
            fields[name] = serializers.FloatField(required=False, allow_null=True, min_value=lowest, max_value=highest)
        for name, (lowest, highest) in CAPTURE_INTEGERS.items():
            fields[name] = serializers.IntegerField(required=False, allow_null=True, min_value=lowest, max_value=highest)
        return fields


class LinkCapturesSerializer(serializers.Serializer):
    stream = StreamField()
    captures: serializers.ListSerializer[Any] = serializers.ListSerializer(
        child=LinkCaptureSerializer(), min_length=1, max_length=MAX_CAPTURES
    )


class LinkCapturesEnvelopeSerializer(KnownFieldsSerializer):
    """A batch whose photos are validated one by one later."""

    stream = StreamField()
    captures = serializers.ListField(min_length=1, max_length=MAX_CAPTURES)


class RefusedSerializer(serializers.Serializer):
    index = serializers.IntegerField(help_text="its place in the batch")
    sequence = serializers.JSONField(allow_null=True, help_text="as it was sent")
    faults = serializers.DictField(child=serializers.CharField(), help_text="what is wrong, by field")


class StoredReportsSerializer(serializers.Serializer):
    """Every record of the batch is stored, known or refused; none needs to be sent again unchanged."""

    stored = serializers.IntegerField(help_text="new ones")
    known = serializers.IntegerField(help_text="that had been stored before, under the same stream and sequence")
    from_future = serializers.IntegerField(help_text="of the stored: measured more than a minute after they came")
    late = serializers.IntegerField(help_text="of the stored: measured before one that was stored earlier")
    refused = RefusedSerializer(many=True)


class StoredCapturesSerializer(serializers.Serializer):
    """Every photo of the batch is stored, known or refused; none needs to be sent again unchanged."""

    stored = serializers.IntegerField(help_text="new reports, also of photos that another message reported before")
    known = serializers.IntegerField(help_text="that had been stored before, under the same stream and sequence")
    refused = RefusedSerializer(many=True)


class AcknowledgementSerializer(KnownFieldsSerializer):
    """State of a command: received, done, or failed with a reason. May be sent again."""

    command = serializers.UUIDField()
    state = serializers.ChoiceField(choices=["acknowledged", "applied", "failed"])
    reason = serializers.CharField(required=False, allow_blank=True, max_length=500)
    content_sha256 = serializers.RegexField(
        r"^[0-9a-f]{64}$", required=False, allow_null=True, help_text="of an upload: what the autopilot holds, as it was read back from it"
    )


class AcknowledgementsSerializer(KnownFieldsSerializer):
    acknowledgements: serializers.ListSerializer[Any] = serializers.ListSerializer(
        child=AcknowledgementSerializer(), min_length=1, max_length=MAX_ACKNOWLEDGEMENTS
    )


class NotedSerializer(serializers.Serializer):
    command = serializers.UUIDField()
    noted = serializers.BooleanField(help_text="false: the command had ended, or is none of this UAV's")
    state = serializers.CharField(allow_null=True, help_text="the command's; null: it is none of this UAV's")
    words = serializers.CharField(allow_blank=True)


class NotedListSerializer(serializers.Serializer):
    results = NotedSerializer(many=True)


@extend_schema_serializer(component_name="Result")
class LinkResultSerializer(KnownFieldsSerializer):
    """What the UAV found at a target."""

    sequence = serializers.IntegerField(min_value=0, max_value=MAX_SEQUENCE)
    approval = serializers.UUIDField(help_text="of the route that was flown")
    place = serializers.IntegerField(min_value=0, max_value=MAX_PLACE, help_text="of the target, as the route has it")
    outcome = serializers.ChoiceField(choices=["complete", "skipped", "failed"])
    measured_at = serializers.DateTimeField(help_text="by the UAV's clock, with its zone")
    note = serializers.CharField(required=False, allow_blank=True, max_length=2_000)
    values = serializers.DictField(required=False, help_text=f"as the payload measured them; at most {MAX_RESULT_BYTES // 1024} kB")


class EndedFlightSerializer(KnownFieldsSerializer):
    """End of a flight. May be sent again."""

    approval = serializers.UUIDField()
    flight = serializers.IntegerField(min_value=1, max_value=MAX_FLIGHTS)
    outcome = serializers.ChoiceField(choices=[end.value for end in FlightEnd])


def read_result(sent: Any) -> tuple[NewResult | None, dict[str, str]]:
    """Return the result, or its faults by field."""
    serializer = LinkResultSerializer(data=sent)
    if not serializer.is_valid():
        return None, {str(name): " ".join(map(str, words)) for name, words in serializer.errors.items()}
    faults: dict[str, str] = {}
    values = sent.get("values") or {}
    try:
        if len(json.dumps(values, allow_nan=False)) > MAX_RESULT_BYTES:
            faults["values"] = f"At most {MAX_RESULT_BYTES // 1024} kB."
    except ValueError:
        faults["values"] = "NaN and infinities are no values: send null."
    try:
        measured_at = instant(sent["measured_at"])
    except ValueError as error:
        faults["measured_at"] = str(error)
    if faults:
        return None, faults
    read = serializer.validated_data
    result = NewResult(
        sequence=read["sequence"],
        approval_id=read["approval"],
        place=read["place"],
        outcome=TargetState(read["outcome"]),
        measured_at=measured_at,
        note=read.get("note", ""),
        values=values,
    )
    return result, {}


class ResultsSerializer(serializers.Serializer):
    stream = StreamField()
    results: serializers.ListSerializer[Any] = serializers.ListSerializer(child=LinkResultSerializer(), max_length=MAX_RESULTS)
    flights: serializers.ListSerializer[Any] = serializers.ListSerializer(
        child=EndedFlightSerializer(), required=False, max_length=MAX_RESULTS
    )


class ResultsEnvelopeSerializer(KnownFieldsSerializer):
    """A batch whose results are validated one by one later."""

    stream = StreamField()
    results = serializers.ListField(max_length=MAX_RESULTS)
    flights: serializers.ListSerializer[Any] = serializers.ListSerializer(
        child=EndedFlightSerializer(), required=False, max_length=MAX_RESULTS
    )


class StoredResultsSerializer(serializers.Serializer):
    """Every result of the batch is stored, known or refused; none needs to be sent again unchanged."""

    stored = serializers.IntegerField()
    known = serializers.IntegerField()
    refused = RefusedSerializer(many=True)
    refused_flights = serializers.ListField(child=serializers.IntegerField(), help_text="places of flights that this UAV was never sent")


class WaitingCommandSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    sequence = serializers.IntegerField(help_text="grows with each command to this UAV")
    kind = serializers.ChoiceField(choices=CommandKind.choices)
    priority = serializers.IntegerField(help_text="0 is the most urgent")
    parameters = serializers.DictField()
    expires_at = serializers.DateTimeField(allow_null=True, help_text="after which it is not wanted any more")


class TakeOffSerializer(serializers.Serializer):
    position = PositionField()
    altitude_amsl_m = serializers.FloatField(allow_null=True, help_text="of the ground there; null without terrain data")


class RouteTaskSerializer(serializers.Serializer):
    kind = serializers.CharField()
    hold_s = serializers.FloatField()


class RouteWaypointSerializer(serializers.Serializer):
    sequence = serializers.IntegerField(help_text="its place in the whole route")
    kind = serializers.CharField()
    position = PositionField()
    altitude_agl_m = serializers.FloatField(help_text="above the ground")
    altitude_amsl_m = serializers.FloatField(allow_null=True, help_text="above mean sea level; null without terrain data")
    altitude_relative_m = serializers.FloatField(help_text="above the take-off of this flight")
    speed_mps = serializers.FloatField(allow_null=True, help_text="over ground on the leg to it; null: the route's")
    arrival_s = serializers.FloatField(allow_null=True, help_text="seconds after the mission's departure")
    task = RouteTaskSerializer(allow_null=True)
    target = serializers.IntegerField(allow_null=True, help_text="the target's place")


class RouteContentSerializer(serializers.Serializer):
    """The flight to fly, identified by `content_sha256`."""

    flight = serializers.IntegerField(help_text="which of the route's flights, from 1")
    take_off = TakeOffSerializer()
    cruise_speed_mps = serializers.FloatField()
    end_action = serializers.CharField()
    departs_s = serializers.FloatField(help_text="seconds after the mission's departure")
    waypoints = RouteWaypointSerializer(many=True)


class RouteTargetSerializer(serializers.Serializer):
    place = serializers.IntegerField(help_text="in the mission's list, from 0")
    label: Declared = serializers.CharField()
    kind = serializers.CharField(allow_null=True, help_text="of the asset: tower, line, railway, bridge; null: a bare position")
    task = RouteTaskSerializer()
    position = PositionField(allow_null=True)
    stretch = serializers.JSONField(allow_null=True, help_text="GeoJSON LineString of the part that is to be inspected")
    geometry = serializers.JSONField(allow_null=True, help_text="GeoJSON of the asset: a bridge's outline, a line's course")


class GivenRouteSerializer(serializers.Serializer):
    command = serializers.UUIDField(help_text="the upload-mission command to acknowledge")
    mission = serializers.UUIDField()
    mission_name = serializers.CharField()
    approval = serializers.UUIDField()
    flights = serializers.IntegerField()
    content = RouteContentSerializer()
    content_sha256 = serializers.CharField(help_text="of `content` in its canonical form, see docs/uav-link.md")
    targets = RouteTargetSerializer(many=True)


class GivenSerializer(serializers.Serializer):
    uav = serializers.IntegerField()
    route = GivenRouteSerializer(allow_null=True)
    commands = WaitingCommandSerializer(many=True, help_text="the most urgent first")
