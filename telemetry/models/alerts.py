"""Alerts to operators."""

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from missions.models import Mission, Uav
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation


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
