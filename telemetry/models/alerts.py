"""What an operator must know at once."""

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q

from missions.models import Mission, Uav
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation


class AlertLevel(models.TextChoices):
    CRITICAL = "critical", "Critical"
    WARNING = "warning", "Warning"
    ADVISORY = "advisory", "Advisory"


class Alert(models.Model):
    """One cause, one alert: open until the cause is gone."""

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="alerts")
    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, null=True, blank=True, related_name="alerts")
    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, null=True, blank=True, related_name="alerts")
    level = models.CharField(max_length=10, choices=AlertLevel.choices)
    code = models.CharField(max_length=50, help_text="the cause: mission-mixed, …")
    message = models.CharField(max_length=500)
    details = models.JSONField(default=dict, blank=True)
    opened_at = models.DateTimeField()
    closed_at = models.DateTimeField(null=True, blank=True)
    acknowledged_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    acknowledged_at = models.DateTimeField(null=True, blank=True)

    class Meta:
        ordering = ["-opened_at"]
        constraints = [
            models.UniqueConstraint(fields=["uav", "code"], condition=Q(closed_at=None), name="alert_one_open_of_a_cause"),
            models.CheckConstraint(condition=Q(level__in=AlertLevel.values), name="alert_level_known"),
        ]

    def __str__(self) -> str:
        return f"{self.level} {self.message}"
