"""Take-offs and landings as reported by UAVs."""

from django.contrib.gis.db import models
from django.db.models import Q

from missions.models import Mission, Uav


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
