"""The log: measured positions and states of UAVs, photos, take-offs and landings, and results of targets."""

from django.contrib.gis.db import models
from django.contrib.postgres.indexes import BrinIndex
from django.db.models import Q
from django.db.models.functions import Now

from missions.models import Approval, InspectionTarget, LinkKind, Mission, Uav


class TelemetryStream(models.Model):
    """One run of a UAV's counter, since a boot of its autopilot or companion. A sequence number is unique within it."""

    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="streams")
    link = models.CharField(max_length=10, choices=LinkKind.choices)
    key = models.CharField(max_length=64, help_text="that the sender gives, or the gateway from the vehicle's clock")
    started_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["-started_at"]
        constraints = [models.UniqueConstraint(fields=["uav", "link", "key"], name="telemetry_stream_once")]

    def __str__(self) -> str:
        return f"{self.uav} {self.key}"


class TelemetryRecord(models.Model):
    """One report of a UAV. Heights name their reference; angles are in degrees, speeds in m/s north, east, down."""

    stream = models.ForeignKey(TelemetryStream, on_delete=models.CASCADE, related_name="records")
    sequence = models.BigIntegerField(help_text="within the stream; the time since boot [ms] where the vehicle counts nothing else")
    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="records", db_index=False)
    mission = models.ForeignKey(Mission, on_delete=models.SET_NULL, null=True, blank=True, related_name="records", db_index=False)
    measured_at = models.DateTimeField(help_text="by the UAV's clock, set right where it is known to be wrong")
    received_at = models.DateTimeField(help_text="by the server's clock")
    stored_at = models.DateTimeField(db_default=Now(), editable=False)
    position = models.PointField(srid=4326, null=True, blank=True, spatial_index=False)
    altitude_amsl_m = models.FloatField(null=True, blank=True)
    altitude_relative_m = models.FloatField(null=True, blank=True, help_text="above take-off")
    altitude_agl_m = models.FloatField(null=True, blank=True, help_text="above the terrain model, or as measured")
    velocity_north_mps = models.FloatField(null=True, blank=True)
    velocity_east_mps = models.FloatField(null=True, blank=True)
    velocity_down_mps = models.FloatField(null=True, blank=True)
    airspeed_mps = models.FloatField(null=True, blank=True)
    roll_deg = models.FloatField(null=True, blank=True)
    pitch_deg = models.FloatField(null=True, blank=True)
    heading_deg = models.FloatField(null=True, blank=True, help_text="from true north, clockwise")
    battery_percent = models.FloatField(null=True, blank=True)
    battery_v = models.FloatField(null=True, blank=True)
    battery_a = models.FloatField(null=True, blank=True)
    mode = models.CharField(max_length=30, blank=True)
    is_armed = models.BooleanField(null=True, blank=True)
    is_in_air = models.BooleanField(null=True, blank=True)
    link_quality_percent = models.FloatField(null=True, blank=True)
    gps_fix = models.PositiveSmallIntegerField(null=True, blank=True, help_text="GPS_FIX_TYPE: 3 is a fix in space")
    satellites = models.PositiveSmallIntegerField(null=True, blank=True)
    hdop = models.FloatField(null=True, blank=True)
    wind_north_mps = models.FloatField(null=True, blank=True, help_text="towards which the air moves")
    wind_east_mps = models.FloatField(null=True, blank=True)
    mission_item = models.IntegerField(
        null=True, blank=True, help_text="that its list is at, as the autopilot counts (ArduPilot: 0 is home); by MAVLink only"
    )
    waypoint_sequence = models.IntegerField(
        null=True, blank=True, help_text="of its approved route that it flies to, or is at; see services/waypoints.py"
    )
    is_from_future = models.BooleanField(default=False, db_default=False, help_text="measured more than a minute after it was received")
    is_late = models.BooleanField(default=False, db_default=False, help_text="measured before a record that was stored earlier")

    class Meta:
        ordering = ["measured_at", "pk"]
        constraints = [
            models.UniqueConstraint(fields=["stream", "sequence"], name="telemetry_record_once"),
            models.CheckConstraint(
                condition=Q(battery_percent=None) | Q(battery_percent__range=(0, 100)), name="telemetry_battery_percent"
            ),
        ]
        indexes = [
            BrinIndex(fields=["received_at"], name="telemetry_received_brin"),
            models.Index(fields=["uav", "-measured_at"], name="telemetry_of_uav_idx"),
            models.Index(fields=["mission", "measured_at"], condition=Q(mission__isnull=False), name="telemetry_of_mission_idx"),
        ]

    def __str__(self) -> str:
        return f"{self.uav_id} {self.measured_at}"


class InspectionResult(models.Model):
    """What a UAV reported about a target."""

    stream = models.ForeignKey(TelemetryStream, on_delete=models.CASCADE, related_name="results")
    sequence = models.BigIntegerField()
    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="results")
    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, related_name="results")
    approval = models.ForeignKey(Approval, on_delete=models.SET_NULL, null=True, related_name="results", help_text="that it was flown by")
    place = models.PositiveIntegerField(help_text="the target's place in the mission as it was approved, from 0")
    target = models.ForeignKey(
        InspectionTarget, on_delete=models.SET_NULL, null=True, related_name="results", help_text="empty: the mission is another one by now"
    )
    measured_at = models.DateTimeField()
    received_at = models.DateTimeField(db_default=Now(), editable=False)
    outcome = models.CharField(max_length=12, help_text="complete, skipped or failed")
    note = models.CharField(max_length=2_000, blank=True)
    values = models.JSONField(default=dict, blank=True, help_text="as the payload measured them")

    class Meta:
        ordering = ["-measured_at"]
        constraints = [models.UniqueConstraint(fields=["stream", "sequence"], name="inspection_result_once")]

    def __str__(self) -> str:
        return f"{self.target_id} {self.outcome}"


class FlightEventKind(models.TextChoices):
    TAKE_OFF = "take-off", "Take-off"
    LANDING = "landing", "Landing"


class FlightEvent(models.Model):
    """A take-off or landing of a UAV in a mission."""

    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, related_name="flight_events")
    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="flight_events")
    kind = models.CharField(max_length=10, choices=FlightEventKind.choices)
    at = models.DateTimeField(help_text="of the first report of it")

    class Meta:
        ordering = ["-at", "-pk"]
        constraints = [
            models.UniqueConstraint(fields=["mission", "uav", "kind", "at"], name="flight_event_once"),
            models.CheckConstraint(condition=Q(kind__in=FlightEventKind.values), name="flight_event_kind_known"),
        ]

    def __str__(self) -> str:
        return f"{self.kind} of {self.uav_id}"


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
