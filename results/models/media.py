"""Media: photos, thermal photos and videos of inspections. Their bytes are in the media store, by SHA-256."""

import uuid

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from inspection.models import Asset
from missions.models import InspectionTarget, Mission, Uav
from telemetry.models import Capture
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation

MAX_FILE_NAME_LENGTH = 200


class MediumKind(models.TextChoices):
    PHOTO = "photo", "Photo"
    THERMAL = "thermal", "Thermal photo"
    VIDEO = "video", "Video"


class MediumState(models.TextChoices):
    WAITING = "waiting", "Waiting to be read"
    READY = "ready", "Ready"
    NOT_SHOWN = "not_shown", "Stored, but cannot be shown"


class TakenAtSource(models.TextChoices):
    GPS = "gps", "UTC of the receiver"
    CAMERA = "camera", "Camera's clock with its offset"
    LOCAL = "local", "Camera's clock, in the organisation's time zone"
    USER = "user", "A user"


class Placement(models.TextChoices):
    """How it is known what a medium shows."""

    WAITING = "waiting", "Waiting to be read"
    STATED = "stated", "Stated with the upload"
    CAPTURED = "captured", "By the UAV's report of the capture"
    NEAREST = "nearest", "Nearest target by position and time"
    MANUAL = "manual", "By a user"
    UNPLACED = "unplaced", "Not known"


class Review(models.TextChoices):
    NOTHING = "nothing", "Nothing to see"
    FINDINGS = "findings", "Has findings"


class Medium(models.Model):
    """One file of an organisation. The original is never changed; width and height are those of the upright picture."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="media")
    sha256 = models.CharField(max_length=64, editable=False)
    kind = models.CharField(max_length=10, choices=MediumKind.choices)
    media_type = models.CharField(max_length=50, help_text="by its content")
    file_name = models.CharField(max_length=MAX_FILE_NAME_LENGTH, help_text="as it was sent")
    size_bytes = models.BigIntegerField()
    state = models.CharField(max_length=10, choices=MediumState.choices, default=MediumState.WAITING, db_default=MediumState.WAITING)
    fault = models.CharField(
        max_length=40, blank=True, default="", db_default="", help_text="why it cannot be shown; see results/reasons.py"
    )
    width_px = models.PositiveIntegerField(null=True, blank=True)
    height_px = models.PositiveIntegerField(null=True, blank=True)
    derivatives = models.JSONField(default=dict, db_default={}, blank=True, help_text="width and height by longest edge")
    record = models.JSONField(null=True, blank=True, help_text="what the file states; see results/media_metadata/record.py")
    taken_at = models.DateTimeField(null=True, blank=True)
    taken_at_source = models.CharField(max_length=10, choices=TakenAtSource.choices, blank=True, default="", db_default="")
    position = models.PointField(srid=4326, null=True, blank=True, help_text="of the camera")
    heights = models.JSONField(
        default=list, db_default=[], blank=True, help_text="of the camera, each with what it is above and its source"
    )
    camera_yaw_deg = models.FloatField(null=True, blank=True, help_text="of the optical axis, clockwise from true north")
    camera_pitch_deg = models.FloatField(null=True, blank=True, help_text="of the optical axis above the horizon")
    camera_roll_deg = models.FloatField(null=True, blank=True, help_text="around the optical axis, clockwise")
    attitude_source = models.CharField(max_length=20, blank=True, default="", db_default="")
    camera_model = models.CharField(max_length=210, blank=True, default="", db_default="")
    focal_length_mm = models.FloatField(null=True, blank=True)
    mission = models.ForeignKey(Mission, on_delete=models.SET_NULL, null=True, blank=True, related_name="media")
    uav = models.ForeignKey(Uav, on_delete=models.SET_NULL, null=True, blank=True, related_name="media")
    target = models.ForeignKey(InspectionTarget, on_delete=models.SET_NULL, null=True, blank=True, related_name="media")
    asset = models.ForeignKey(Asset, on_delete=models.SET_NULL, null=True, blank=True, related_name="media")
    capture = models.ForeignKey(
        Capture, on_delete=models.SET_NULL, null=True, blank=True, db_constraint=False, related_name="media",
        help_text="the UAV's report of it; telemetry is forgotten before media are",
    )  # fmt: skip
    placement = models.CharField(max_length=10, choices=Placement.choices, default=Placement.WAITING, db_default=Placement.WAITING)
    candidates = models.JSONField(default=list, db_default=[], blank=True, help_text="at most two targets that come into question")
    review = models.CharField(
        max_length=10, choices=Review.choices, blank=True, default="", db_default="", help_text="empty: not looked at"
    )
    reviewed_at = models.DateTimeField(null=True, blank=True)
    reviewed_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    uploaded_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    received_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["-received_at"]
        verbose_name_plural = "media"
        constraints = [
            models.UniqueConstraint(fields=["organisation", "sha256"], name="medium_once"),
            models.CheckConstraint(condition=Q(kind__in=MediumKind.values), name="medium_kind_known"),
            models.CheckConstraint(condition=Q(state__in=MediumState.values), name="medium_state_known"),
            models.CheckConstraint(condition=Q(placement__in=Placement.values), name="medium_placement_known"),
            models.CheckConstraint(condition=Q(size_bytes__gte=1), name="medium_not_empty"),
        ]
        indexes = [
            models.Index(fields=["received_at"], condition=Q(state="waiting"), name="medium_waiting_idx"),
            models.Index(fields=["mission", "taken_at"], name="medium_of_mission_idx"),
            models.Index(fields=["asset", "-taken_at"], name="medium_of_asset_idx"),
        ]

    def __str__(self) -> str:
        return self.file_name


class MediaUpload(models.Model):
    """A file that is being received. Its bytes are in a folder until they are complete and their hash is right."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="media_uploads")
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    file_name = models.CharField(max_length=MAX_FILE_NAME_LENGTH)
    size_bytes = models.BigIntegerField()
    sha256 = models.CharField(max_length=64, blank=True, help_text="announced; empty: not announced")
    received_bytes = models.BigIntegerField(default=0, db_default=0)
    mission = models.ForeignKey(Mission, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    uav = models.ForeignKey(Uav, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    target = models.ForeignKey(InspectionTarget, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    asset = models.ForeignKey(Asset, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    medium = models.ForeignKey(
        Medium, on_delete=models.CASCADE, null=True, blank=True, related_name="uploads", help_text="what it has become"
    )
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["created_at"]
        constraints = [
            models.CheckConstraint(
                condition=Q(received_bytes__gte=0, received_bytes__lte=models.F("size_bytes")), name="media_upload_within_size"
            )
        ]
        indexes = [models.Index(fields=["updated_at"], name="media_upload_age_idx")]

    def __str__(self) -> str:
        return self.file_name
