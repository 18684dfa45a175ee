"""Shapes of media and their uploads."""

from typing import Any

from django.urls import reverse
from rest_framework import serializers as answers

from missions.serializers.uavs import PointSerializer
from operation.reasons import Reason
from results.media_metadata.record import CameraHeightReference
from results.models import MediaUpload, Medium, MediumKind, MediumState, Placement, Review, TakenAtSource
from results.services.uploads import PART_BYTES
from workspace.api import strict_serializers as serializers
from workspace.reason_texts import reason_text

SHA256 = r"^[0-9a-f]{64}$"
MAX_LOOKED_UP = 500
MAX_BYTES = 2**53 - 1
MAX_ID = 999_999_999


class HeightSerializer(answers.Serializer):
    value_m = answers.FloatField()
    reference = answers.ChoiceField(choices=[reference.value for reference in CameraHeightReference])
    source = answers.CharField(help_text="the tag that states it")  # type: ignore[assignment]


class CandidateSerializer(answers.Serializer):
    target = answers.IntegerField()
    asset = answers.IntegerField(allow_null=True)
    label = answers.CharField()  # type: ignore[assignment]
    distance_m = answers.FloatField(help_text="from the camera")
    is_in_visit = answers.BooleanField(allow_null=True, help_text="taken while it was visited; null: one of the times is not known")


class MediumSerializer(answers.Serializer):
    id = answers.UUIDField()
    sha256 = answers.CharField()
    kind = answers.ChoiceField(choices=MediumKind.choices)
    media_type = answers.CharField(help_text="by its content")
    file_name = answers.CharField()
    size_bytes = answers.IntegerField()
    state = answers.ChoiceField(choices=MediumState.choices)
    fault = answers.CharField(allow_blank=True, help_text="why it is not shown, in your language")
    fault_code = answers.CharField(allow_blank=True)
    width_px = answers.IntegerField(allow_null=True, help_text="of the upright picture; marks are in these pixels")
    height_px = answers.IntegerField(allow_null=True)
    taken_at = answers.DateTimeField(allow_null=True)
    taken_at_source = answers.ChoiceField(choices=TakenAtSource.choices, allow_blank=True)
    position = PointSerializer(allow_null=True, help_text="of the camera")
    heights = HeightSerializer(many=True, help_text="of the camera, each with what it is above")
    camera_yaw_deg = answers.FloatField(allow_null=True, help_text="of the optical axis, clockwise from true north")
    camera_pitch_deg = answers.FloatField(allow_null=True, help_text="of the optical axis above the horizon, -90 straight down")
    camera_roll_deg = answers.FloatField(allow_null=True, help_text="around the optical axis, clockwise")
    attitude_source = answers.CharField(allow_blank=True)
    camera_model = answers.CharField(allow_blank=True)
    focal_length_mm = answers.FloatField(allow_null=True)
    mission = answers.UUIDField(allow_null=True)
    uav = answers.IntegerField(allow_null=True)
    target = answers.IntegerField(allow_null=True)
    target_label = answers.CharField(allow_blank=True)
    asset = answers.IntegerField(allow_null=True)
    asset_label = answers.CharField(allow_blank=True)
    capture = answers.IntegerField(allow_null=True, help_text="the UAV's report of it, where one was found by time and position")
    placement = answers.ChoiceField(choices=Placement.choices, help_text="how it is known what it shows")
    candidates = CandidateSerializer(many=True, help_text="at most two targets that come into question")
    review = answers.ChoiceField(choices=Review.choices, allow_blank=True, help_text="empty: not reviewed yet")
    reviewed_at = answers.DateTimeField(allow_null=True)
    received_at = answers.DateTimeField()
    original = answers.CharField(help_text="path of the file as it was sent")
    previews = answers.DictField(child=answers.CharField(), help_text="paths of smaller WebP pictures, by their longest edge in pixels")


class MediumPageSerializer(answers.Serializer):
    results = MediumSerializer(many=True)
    next = answers.CharField(allow_null=True, help_text="path and query of the next page")


class MediumChangeSerializer(serializers.Serializer):
    """target and asset place it by hand, both null unplaces it; review states that you have looked at it."""

    refuses_other_fields = True

    mission = serializers.UUIDField(required=False, allow_null=True)
    target = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=MAX_ID)
    asset = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=MAX_ID)
    review = serializers.ChoiceField(choices=Review.choices, required=False, allow_blank=True)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        unknown = set(self.initial_data) - set(self.fields)
        if unknown:
            raise serializers.ValidationError(dict.fromkeys(sorted(unknown), "There is no such field."))
        return attrs


class MediaLookupInputSerializer(serializers.Serializer):
    sha256 = serializers.ListField(child=serializers.RegexField(SHA256), min_length=1, max_length=MAX_LOOKED_UP)


class KnownMediumSerializer(answers.Serializer):
    sha256 = answers.CharField()
    id = answers.UUIDField()
    file_name = answers.CharField()


class MediaLookupSerializer(answers.Serializer):
    known = KnownMediumSerializer(many=True, help_text="what your organisation has already: it need not be sent")


class MediaUseSerializer(answers.Serializer):
    used_bytes = answers.IntegerField()
    max_bytes = answers.IntegerField()


class UploadSubjectSerializer(serializers.Serializer):
    mission = serializers.UUIDField(required=False, allow_null=True)
    uav = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=MAX_ID)
    target = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=MAX_ID, help_text="what it shows, if known")
    asset = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=MAX_ID, help_text="what it shows, if known")


class MediaUploadInputSerializer(UploadSubjectSerializer):
    file_name = serializers.CharField(max_length=1_000)
    size_bytes = serializers.IntegerField(min_value=1, max_value=MAX_BYTES)
    sha256 = serializers.RegexField(SHA256, required=False, allow_blank=True, help_text="checked when the last byte has arrived")


class MediaUploadSerializer(answers.Serializer):
    id = answers.UUIDField(allow_null=True, help_text="null: the file is known and need not be sent")
    file_name = answers.CharField()
    size_bytes = answers.IntegerField()
    received_bytes = answers.IntegerField()
    part_bytes = answers.IntegerField(help_text="that one request takes at most")
    is_known = answers.BooleanField(help_text="your organisation had this file before")
    medium = answers.UUIDField(allow_null=True, help_text="what the complete upload has become")


def upload_json(upload: MediaUpload) -> dict[str, Any]:
    return {
        "id": str(upload.pk),
        "file_name": upload.file_name,
        "size_bytes": upload.size_bytes,
        "received_bytes": upload.received_bytes,
        "part_bytes": PART_BYTES,
        "is_known": False,
        "medium": None if upload.medium_id is None else str(upload.medium_id),
    }


def known_upload_json(medium: Medium) -> dict[str, Any]:
    return {
        "id": None,
        "file_name": medium.file_name,
        "size_bytes": medium.size_bytes,
        "received_bytes": medium.size_bytes,
        "part_bytes": PART_BYTES,
        "is_known": True,
        "medium": str(medium.pk),
    }


PLAIN_FIELDS = (
    "sha256", "kind", "media_type", "file_name", "size_bytes", "state", "width_px", "height_px", "taken_at", "taken_at_source", "heights",
    "camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg", "attitude_source", "camera_model", "focal_length_mm", "placement",
    "candidates", "review", "reviewed_at", "received_at",
)  # fmt: skip


def medium_json(medium: Medium, asset_labels: dict[int, str]) -> dict[str, Any]:
    """Return a medium. asset_labels: by key, of its asset."""
    position = medium.position
    return {name: getattr(medium, name) for name in PLAIN_FIELDS} | {
        "id": str(medium.pk),
        "fault": reason_text(Reason(medium.fault)) if medium.fault else "",
        "fault_code": medium.fault,
        "position": None if position is None else {"type": "Point", "coordinates": [position.x, position.y]},
        "mission": None if medium.mission_id is None else str(medium.mission_id),
        "uav": medium.uav_id,
        "target": medium.target_id,
        "target_label": medium.target.label if medium.target is not None else "",
        "asset": medium.asset_id,
        "capture": medium.capture_id,
        "asset_label": asset_labels.get(medium.asset_id or 0, ""),
        "original": reverse("api-medium-file", args=[medium.pk]),
        "previews": {edge: reverse("api-medium-preview", args=[medium.pk, int(edge)]) for edge in medium.derivatives},
    }
