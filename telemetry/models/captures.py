"""Photos that UAVs took, and the reports of each."""

from django.contrib.gis.db import models
from django.contrib.postgres.indexes import BrinIndex
from django.db.models import Q

from missions.models import Mission, Uav
from telemetry.models.records import TelemetryStream


class Capture(models.Model):
    """One photo, combined from all its reports (mavlink/decoding/captures.py). Heights name their reference; null is unknown."""

    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="captures", db_index=False)
    mission = models.ForeignKey(Mission, on_delete=models.SET_NULL, null=True, blank=True, related_name="captures", db_index=False)
    flight = models.PositiveSmallIntegerField(null=True, blank=True, help_text="of the approved route, from 1")
    waypoint_sequence = models.IntegerField(null=True, blank=True, help_text="of the approved route")
    mission_item = models.IntegerField(null=True, blank=True, help_text="that the vehicle's list was at, as its autopilot counts")
    is_taken = models.BooleanField(default=True, db_default=True, help_text="false: the camera reported a failure")
    camera = models.PositiveSmallIntegerField(null=True, blank=True, help_text="MAVLink component of the camera")
    image_index = models.BigIntegerField(null=True, blank=True, help_text="as its sender counts; begins anew after a restart")
    taken_at = models.DateTimeField(help_text="by the server's clock")
    time_source = models.CharField(max_length=20, help_text="vehicle-clock, utc, uav or receipt")
    time_bound_s = models.FloatField(null=True, blank=True, help_text="95 %")
    received_at = models.DateTimeField(help_text="of the first report")
    position = models.PointField(srid=4326, null=True, blank=True, spatial_index=False)
    position_source = models.CharField(max_length=20, blank=True, help_text="photo: told with it; vehicle: where the UAV was last before")
    position_bound_m = models.FloatField(null=True, blank=True, help_text="radius of 95 %")
    altitude_amsl_m = models.FloatField(null=True, blank=True)
    altitude_relative_m = models.FloatField(null=True, blank=True, help_text="above take-off")
    altitude_agl_m = models.FloatField(null=True, blank=True, help_text="above ground, as the UAV measured it")
    roll_deg = models.FloatField(null=True, blank=True)
    pitch_deg = models.FloatField(null=True, blank=True, help_text="from the horizon; -90 is straight down")
    yaw_deg = models.FloatField(null=True, blank=True)
    yaw_frame = models.CharField(max_length=10, blank=True, help_text="earth: from true north; vehicle: from the nose")
    attitude_source = models.CharField(
        max_length=10, blank=True, help_text="camera, gimbal, or vehicle: where the camera looked is unknown"
    )
    file_url = models.CharField(max_length=205, blank=True, help_text="of the picture, as the camera names it")

    class Meta:
        ordering = ["taken_at", "pk"]
        indexes = [
            BrinIndex(fields=["received_at"], name="capture_received_brin"),
            models.Index(fields=["uav", "-taken_at"], name="capture_of_uav_idx"),
            models.Index(fields=["mission", "taken_at"], condition=Q(mission__isnull=False), name="capture_of_mission_idx"),
        ]

    def __str__(self) -> str:
        return f"{self.uav_id} {self.taken_at}"


class CaptureReport(models.Model):
    """One message about a photo. Its key is the same in each repetition of the message."""

    capture = models.ForeignKey(Capture, on_delete=models.CASCADE, related_name="reports")
    stream = models.ForeignKey(TelemetryStream, on_delete=models.CASCADE, related_name="capture_reports")
    key = models.CharField(max_length=64)
    source = models.CharField(max_length=30, help_text="the message")
    received_at = models.DateTimeField()
    values = models.JSONField(help_text="see mavlink/decoding/captures.py")

    class Meta:
        ordering = ["received_at", "pk"]
        constraints = [models.UniqueConstraint(fields=["stream", "key"], name="capture_report_once")]

    def __str__(self) -> str:
        return f"{self.source} of {self.capture_id}"
