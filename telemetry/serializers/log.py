"""Responses of the log, for the OpenAPI document."""

from rest_framework import serializers

from mavlink.decoding.companion_reports import INTEGERS, NUMBERS
from missions.serializers.uavs import PointSerializer
from telemetry.exports.logged_record import FLAGS


class RecordPropertiesSerializer(serializers.Serializer):
    """Heights name their reference; angles are in degrees, speeds in m/s; null is unknown."""

    uav = serializers.IntegerField()
    uav_name = serializers.CharField()
    mission = serializers.UUIDField(allow_null=True)
    stream = serializers.CharField(help_text="one run of the sender's counter")
    sequence = serializers.IntegerField(help_text="within the stream")
    measured_at = serializers.DateTimeField(help_text="by the UAV's clock, set right where it is known to be wrong")
    received_at = serializers.DateTimeField(help_text="by the server's clock")
    stored_at = serializers.DateTimeField(help_text="when it was written down")
    mode = serializers.CharField(allow_blank=True)
    is_armed = serializers.BooleanField(allow_null=True)
    is_in_air = serializers.BooleanField(allow_null=True)
    is_from_future = serializers.BooleanField(help_text="measured more than a minute after it was received: never shown as the latest")
    is_late = serializers.BooleanField(help_text="measured before a record that was stored earlier")

    def get_fields(self) -> dict[str, serializers.Field]:
        fields: dict[str, serializers.Field] = super().get_fields()
        fields |= {name: serializers.FloatField(allow_null=True) for name in NUMBERS}
        fields |= {name: serializers.IntegerField(allow_null=True) for name in INTEGERS}
        fields["mission_item"] = serializers.IntegerField(
            allow_null=True, help_text="that the autopilot's list is at, as it counts (ArduPilot: 0 is home); by MAVLink only"
        )
        flags = {name: fields.pop(name) for name in FLAGS}
        return fields | flags


class RecordFeatureSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Feature"])
    id = serializers.IntegerField()
    geometry = PointSerializer(allow_null=True)
    properties = RecordPropertiesSerializer()


class RecordCollectionSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = RecordFeatureSerializer(many=True)
    every_s = serializers.FloatField(allow_null=True, help_text="how far apart the records of a UAV were chosen; null: all of them")
    next = serializers.CharField(allow_null=True, help_text="path and query of the next page")


class VehicleTextSerializer(serializers.Serializer):
    severity = serializers.IntegerField(help_text="MAV_SEVERITY: 0 emergency to 7 debug")
    text = serializers.CharField()
    received_at = serializers.DateTimeField()


class VehicleTextPageSerializer(serializers.Serializer):
    results = VehicleTextSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class FlightLogSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    mission = serializers.UUIDField(allow_null=True)
    started_at = serializers.DateTimeField()
    ended_at = serializers.DateTimeField(allow_null=True, help_text="null: it is being written")
    size_bytes = serializers.IntegerField()
    file = serializers.CharField(help_text="path of the tlog file")


class FlightLogPageSerializer(serializers.Serializer):
    results = FlightLogSerializer(many=True)
    next = serializers.CharField(allow_null=True)
