"""Estimates of UAVs, their latest state for live pages, and alerts to operators."""

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from missions.models import Mission, Uav
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation


class PositionEstimate(models.Model):
    """Estimated position of a UAV for a moment without a report. Bounds hold with 95 %.

    A later report for this moment sets `replaced_at`. The row is kept, so that the mission report can compare both.
    """

    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="estimates", db_index=False)
    mission = models.ForeignKey(Mission, on_delete=models.SET_NULL, null=True, blank=True, related_name="estimates", db_index=False)
    estimated_for = models.DateTimeField(help_text="the moment that it speaks of")
    made_at = models.DateTimeField(db_default=Now(), editable=False)
    report_at = models.DateTimeField(null=True, help_text="when the last report that it rests on was measured")
    position = models.PointField(srid=4326, spatial_index=False)
    altitude_amsl_m = models.FloatField(null=True, blank=True)
    altitude_relative_m = models.FloatField(null=True, blank=True, help_text="above take-off")
    speed_mps = models.FloatField(help_text="over ground")
    heading_deg = models.FloatField(null=True, blank=True)
    bound_along_m = models.FloatField(help_text="semi-axis of the ellipse along its bearing")
    bound_across_m = models.FloatField()
    bound_bearing_deg = models.FloatField()
    bound_height_m = models.FloatField()
    bound_speed_mps = models.FloatField()
    waypoint_sequence = models.IntegerField(null=True, blank=True)
    is_lost = models.BooleanField(default=False, help_text="past what the estimator vouches for")
    replaced_at = models.DateTimeField(null=True, blank=True)

    class Meta:
        ordering = ["estimated_for"]
        constraints = [models.UniqueConstraint(fields=["uav", "estimated_for"], name="position_estimate_once")]
        indexes = [models.Index(fields=["mission", "estimated_for"], name="estimate_of_mission_idx")]

    def __str__(self) -> str:
        return f"{self.uav_id} {self.estimated_for}"


class UavWatch(models.Model):
    """Latest state of a UAV for live pages. `measured` is written with the log, `estimated` by the estimator that holds its lease."""

    uav = models.OneToOneField(Uav, on_delete=models.CASCADE, related_name="watch", primary_key=True)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="+")
    mission = models.ForeignKey(Mission, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    holder = models.CharField(max_length=100, blank=True, help_text="the watch that estimates it")
    lease_expires_at = models.DateTimeField(null=True, blank=True)
    version = models.BigIntegerField(default=1, db_default=1, help_text="counts the changes")
    measured = models.JSONField(null=True, blank=True, help_text="the newest report that is not from the future")
    estimated = models.JSONField(null=True, blank=True, help_text="see estimation/estimate.py; empty: it is not flying a mission")
    updated_at = models.DateTimeField(db_default=Now())

    class Meta:
        verbose_name_plural = "UAV watches"

    def __str__(self) -> str:
        return f"watch of {self.uav_id}"


class AlertLevel(models.TextChoices):
    CRITICAL = "critical", "Critical"
    WARNING = "warning", "Warning"
    ADVISORY = "advisory", "Advisory"


class Alert(models.Model):
    """One alert per cause, open until the cause is gone."""

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="alerts")
    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, null=True, blank=True, related_name="alerts")
    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, null=True, blank=True, related_name="alerts")
    level = models.CharField(max_length=10, choices=AlertLevel.choices)
    code = models.CharField(max_length=50, help_text="the cause: mission-mixed, …")
    subject = models.CharField(max_length=100, blank=True, default="", db_default="", help_text="which of a kind: a zone, another UAV")
    message = models.CharField(max_length=500, help_text="in English; a template where there are values")
    values = models.JSONField(default=dict, db_default={}, blank=True, help_text="what is put into the message when it is shown")
    details = models.JSONField(default=dict, blank=True)
    opened_at = models.DateTimeField()
    written_at = models.DateTimeField(db_default=Now(), help_text="when its words were written")
    closed_at = models.DateTimeField(null=True, blank=True)
    close_reason = models.CharField(
        max_length=30, blank=True, db_default="", default="", help_text="cleared, landed, mission-ended, by-person"
    )
    acknowledged_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    acknowledged_at = models.DateTimeField(null=True, blank=True)
    course = models.JSONField(default=list, db_default=[], blank=True, help_text="what became of it: at, what, level, by, reason")
    revision = models.PositiveIntegerField(default=1, db_default=1, help_text="counts the changes")

    class Meta:
        ordering = ["-opened_at"]
        indexes = [
            models.Index(fields=["organisation", "closed_at"], name="alert_open_or_just_closed_idx"),
            models.Index(
                fields=["organisation", "closed_at"], name="alert_waits_to_be_seen_idx",
                condition=Q(level="critical", acknowledged_at=None, closed_at__isnull=False),
            ),
        ]  # fmt: skip
        constraints = [
            models.UniqueConstraint(fields=["uav", "code", "subject"], condition=Q(closed_at=None), name="alert_one_open_of_a_cause"),
            models.CheckConstraint(condition=Q(level__in=AlertLevel.values), name="alert_level_known"),
        ]

    def __str__(self) -> str:
        return f"{self.level} {self.message}"


class AlertNote(models.Model):
    """A user's note on an alert. Never changed."""

    alert = models.ForeignKey(Alert, on_delete=models.CASCADE, related_name="notes")
    author = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, related_name="+")
    text = models.CharField(max_length=1_000)
    written_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["written_at", "pk"]

    def __str__(self) -> str:
        return self.text
