"""Unknown vehicles, and the links of UAVs."""

from datetime import datetime
from typing import Any

from mavlink.decoding.cameras import ReportedCamera, camera_differences
from mavlink.vehicle_class import type_name
from missions.fields import PositionField
from missions.models import LinkKind, Uav
from missions.serializers.known_fields import KnownFieldsSerializer
from planning.views.camera import camera_from_json
from telemetry.models import UavLink, UnknownVehicle, UnknownVehicleState
from telemetry.services.links.approved_vehicles import connection_warnings
from telemetry.services.links.onboard_lists import Doubt
from workspace.api import strict_serializers as serializers


class UnknownVehicleSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    mavlink_system_id = serializers.IntegerField()
    autopilot = serializers.CharField(allow_blank=True)
    vehicle_type = serializers.CharField(allow_blank=True)
    address = serializers.CharField(allow_blank=True, help_text="whence it was heard")
    is_signed = serializers.BooleanField()
    position = PositionField(allow_null=True)
    state = serializers.ChoiceField(choices=UnknownVehicleState.choices)
    first_message_at = serializers.DateTimeField()
    last_message_at = serializers.DateTimeField()
    settled_by = serializers.CharField(allow_null=True)
    settled_at = serializers.DateTimeField(allow_null=True)
    uav = serializers.IntegerField(allow_null=True, help_text="that it was adopted as")


class UnknownVehiclePageSerializer(serializers.Serializer):
    results = UnknownVehicleSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class AdoptionSerializer(KnownFieldsSerializer):
    """Either `uav`, which receives the system id, or the data of a new UAV."""

    uav = serializers.IntegerField(required=False, min_value=1, max_value=2**63 - 1)
    name = serializers.CharField(required=False, max_length=100)
    uav_type = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=2**63 - 1)
    position = PositionField(required=False, help_text="of a new one; without it where the vehicle is")

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if ("uav" in attrs) == ("name" in attrs):
            raise serializers.ValidationError({"uav": "Either a UAV that exists, or the name of a new one."})
        return attrs


def vehicle_json(vehicle: UnknownVehicle) -> dict[str, Any]:
    by = vehicle.settled_by
    return {
        "id": vehicle.pk,
        "mavlink_system_id": vehicle.mavlink_system_id,
        "autopilot": vehicle.autopilot,
        "vehicle_type": vehicle.vehicle_type,
        "address": vehicle.address,
        "is_signed": vehicle.is_signed,
        "position": list(vehicle.location.coords[:2]) if vehicle.location else None,
        "state": vehicle.state,
        "first_message_at": vehicle.first_message_at,
        "last_message_at": vehicle.last_message_at,
        "settled_by": by.display_name if by else None,
        "settled_at": vehicle.settled_at,
        "uav": vehicle.uav_id,
    }


class GatewayAddressSerializer(serializers.Serializer):
    protocol = serializers.ChoiceField(choices=["udp", "tcp"])
    host = serializers.CharField()
    port = serializers.IntegerField()
    is_local = serializers.BooleanField(help_text="reachable from the gateway's own machine alone")


class ReportedCameraSerializer(serializers.Serializer):
    """What a camera of a UAV reports of itself (CAMERA_INFORMATION of MAVLink); null is unknown."""

    component = serializers.IntegerField(help_text="of the vehicle that reported it")
    name = serializers.CharField(allow_blank=True, help_text="vendor and model")
    focal_length_mm = serializers.FloatField(allow_null=True, help_text="of a zoom at any of its steps")
    sensor_width_mm = serializers.FloatField(allow_null=True)
    sensor_height_mm = serializers.FloatField(allow_null=True)
    pixels_wide = serializers.IntegerField(allow_null=True)
    pixels_high = serializers.IntegerField(allow_null=True)
    is_of_type = serializers.BooleanField(help_text="whether the UAV's type has a camera from whose figures none of these differ")


class UavConnectionSerializer(serializers.Serializer):
    """State of a UAV's link; null or empty if unknown."""

    link = serializers.ChoiceField(choices=LinkKind.choices, help_text="the door by which it is told what to do")
    last_message_at = serializers.DateTimeField(allow_null=True, help_text="when anything was last received, by the server's clock")
    last_message_link = serializers.ChoiceField(choices=LinkKind.choices, allow_null=True, help_text="the door by which it was")
    address = serializers.CharField(allow_blank=True)
    autopilot = serializers.CharField(allow_blank=True)
    firmware = serializers.CharField(allow_blank=True)
    vehicle_type = serializers.CharField(allow_blank=True, help_text="as its autopilot says: quadrotor, fixed wing, …")
    warnings = serializers.ListField(child=serializers.CharField(), help_text="what keeps it from missions or from a fence")
    mode = serializers.CharField(allow_blank=True)
    is_armed = serializers.BooleanField(allow_null=True)
    is_in_air = serializers.BooleanField(allow_null=True)
    battery_percent = serializers.FloatField(allow_null=True)
    battery_state = serializers.CharField(allow_blank=True, help_text="as the vehicle itself has it: ok, low, critical, …")
    received_bytes_s = serializers.FloatField(allow_null=True, help_text="of its frames, by MAVLink only")
    received_messages_s = serializers.FloatField(allow_null=True)
    waypoint_sequence = serializers.IntegerField(allow_null=True, help_text="of its approved route that it flies to, or is at")
    loaded_approval = serializers.UUIDField(allow_null=True, help_text="of the mission that is on it, as it was seen")
    loaded_flight = serializers.IntegerField(allow_null=True)
    loaded_read_at = serializers.DateTimeField(allow_null=True, help_text="when that was last read back from it")
    loaded_doubt = serializers.ChoiceField(
        choices=[(doubt.value, doubt.value) for doubt in Doubt], allow_blank=True, help_text="why it may hold something else by now"
    )
    cameras = ReportedCameraSerializer(many=True, help_text="by MAVLink only")
    server = serializers.CharField(help_text="base address of the HTTP link")
    gateway = GatewayAddressSerializer(many=True, help_text="where vehicles that speak MAVLink connect; empty: no gateway")
    server_time = serializers.DateTimeField(help_text="to tell an age by, whatever the reader's clock says")


def _cameras_json(uav: Uav, link: UavLink) -> list[dict[str, Any]]:
    of_type = [camera_from_json(value) for value in uav.uav_type.cameras] if link.cameras and uav.uav_type else []
    cameras = [ReportedCamera.from_json(value) for value in link.cameras]
    return [
        one.to_json() | {"is_of_type": one.has_sensor and any(not camera_differences(one, camera) for camera in of_type)} for one in cameras
    ]


def connection_json(uav: Uav, link: UavLink, now: datetime) -> dict[str, Any]:
    by = None if link.last_message_at is None else LinkKind.HTTP if link.address.startswith("http ") else LinkKind.MAVLINK
    return {
        "link": uav.link,
        "last_message_at": link.last_message_at,
        "last_message_link": by,
        "address": link.address,
        "autopilot": link.autopilot,
        "firmware": link.firmware,
        "vehicle_type": "" if link.vehicle_type is None else type_name(link.vehicle_type),
        "warnings": connection_warnings(uav, link),
        "mode": link.mode,
        "is_armed": link.is_armed,
        "is_in_air": link.is_in_air,
        "battery_percent": uav.battery_percent,
        "battery_state": link.battery_state,
        "received_bytes_s": link.received_bytes_s,
        "received_messages_s": link.received_messages_s,
        "waypoint_sequence": link.waypoint_sequence,
        "loaded_approval": link.loaded_approval,
        "loaded_flight": link.loaded_flight,
        "loaded_read_at": link.loaded_read_at,
        "loaded_doubt": link.loaded_doubt,
        "cameras": _cameras_json(uav, link),
        "server_time": now,
    }
