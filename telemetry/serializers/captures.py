"""Photos, for the OpenAPI document."""

from rest_framework import serializers

from mavlink.decoding.captures import AttitudeSource, CaptureTimeSource, PositionSource
from mavlink.decoding.gimbal_attitude import YawFrame
from missions.serializers.uavs import PointSerializer


class CapturePropertiesSerializer(serializers.Serializer):
    """A photo. Null is unknown, an empty source too; bounds are those of 95 %."""

    uav = serializers.IntegerField()
    uav_name = serializers.CharField()
    mission = serializers.UUIDField(allow_null=True)
    taken_at = serializers.DateTimeField(help_text="by the server's clock")
    received_at = serializers.DateTimeField()
    time_source = serializers.ChoiceField(choices=[(one.value, one.value) for one in CaptureTimeSource])
    time_bound_s = serializers.FloatField(allow_null=True)
    flight = serializers.IntegerField(allow_null=True, help_text="of the approved route, from 1")
    waypoint_sequence = serializers.IntegerField(allow_null=True, help_text="of the approved route")
    mission_item = serializers.IntegerField(allow_null=True, help_text="that the autopilot's list was at, as it counts")
    is_taken = serializers.BooleanField(help_text="false: the camera reported a failure")
    camera = serializers.IntegerField(allow_null=True, help_text="MAVLink component of the camera")
    image_index = serializers.IntegerField(allow_null=True, help_text="as its sender counts; begins anew after a restart")
    position_source = serializers.ChoiceField(choices=[(one.value, one.value) for one in PositionSource], allow_blank=True)
    position_bound_m = serializers.FloatField(allow_null=True, help_text="radius")
    altitude_amsl_m = serializers.FloatField(allow_null=True)
    altitude_relative_m = serializers.FloatField(allow_null=True, help_text="above take-off")
    altitude_agl_m = serializers.FloatField(allow_null=True, help_text="above ground, as the UAV measured it")
    roll_deg = serializers.FloatField(allow_null=True, help_text="right side down")
    pitch_deg = serializers.FloatField(allow_null=True, help_text="from the horizon; -90 is straight down")
    yaw_deg = serializers.FloatField(allow_null=True, help_text="clockwise")
    yaw_frame = serializers.ChoiceField(
        choices=[(one.value, one.value) for one in YawFrame], allow_blank=True, help_text="earth: from true north; vehicle: from the nose"
    )
    attitude_source = serializers.ChoiceField(
        choices=[(one.value, one.value) for one in AttitudeSource], allow_blank=True,
        help_text="vehicle: of the airframe; where the camera looked is unknown",
    )  # fmt: skip
    file_url = serializers.CharField(allow_blank=True, help_text="of the picture, as the camera names it")


class CaptureFeatureSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Feature"])
    id = serializers.IntegerField()
    geometry = PointSerializer(allow_null=True)
    properties = CapturePropertiesSerializer()


class CaptureCollectionSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = CaptureFeatureSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="path and query of the next page")
