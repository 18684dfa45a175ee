"""Starts of a mission's UAVs in the order and at the intervals of its plan."""

import uuid

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from missions.models.missions import Mission


class StartsEnd(models.TextChoices):
    DONE = "done", "Every UAV was started or refused"
    STOPPED = "stopped", "Stopped by a user"
    COMMANDED = "commanded", "A UAV of the mission was told to stop, hold, return or land"
    MISSION_OVER = "mission-over", "The mission is not on its way any more"
    INTERRUPTED = "interrupted", "Nobody could look after it for too long"


class PlannedStarts(models.Model):
    """One run through a mission's starts. `uavs` has an entry for each, in order: see services/commands/planned_starts.py."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, related_name="planned_starts")
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, related_name="+")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    looked_at = models.DateTimeField(db_default=Now(), help_text="when its times were last compared with the clock")
    ended_at = models.DateTimeField(null=True, blank=True)
    ended_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    end = models.CharField(max_length=15, choices=StartsEnd.choices, blank=True, help_text="why it ended; empty: it goes on")
    uavs = models.JSONField(default=list, help_text="UAV, place, due time, state, command, reason")

    class Meta:
        ordering = ["-created_at"]
        verbose_name_plural = "planned starts"
        constraints = [
            models.UniqueConstraint(fields=["mission"], condition=Q(ended_at=None), name="planned_starts_one_open"),
            models.CheckConstraint(condition=Q(end__in=["", *StartsEnd.values]), name="planned_starts_end_known"),
        ]

    def __str__(self) -> str:
        return f"{self.mission} {self.end or 'goes on'}"
