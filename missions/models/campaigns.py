"""Campaigns: missions from several launch sites over several days."""

import uuid

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models.functions import Now

from workspace.models import DEFAULT_ORGANISATION_ID, Organisation

MAX_NAME_LENGTH = 150  # the names of its missions add to it


class Campaign(models.Model):
    """Targets, UAVs and crews, and the schedule made from them. Its missions are those that name it."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="campaigns")
    author = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="campaigns")
    name = models.CharField(max_length=MAX_NAME_LENGTH)
    request = models.JSONField(help_text="targets, UAVs and options; see planning/request.py")
    rules = models.JSONField(help_text="crews, launch sites and reach; see planning/campaigns/rules.py")
    schedule = models.JSONField(null=True, blank=True, help_text="sites, days and unassigned targets; empty until it is planned")
    target_count = models.PositiveIntegerField()
    mission_count = models.PositiveIntegerField(default=0)
    day_count = models.PositiveIntegerField(default=0)
    job = models.UUIDField(null=True, blank=True, help_text="the last job that planned it")
    planned_at = models.DateTimeField(null=True, blank=True)
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["-updated_at"]
        indexes = [models.Index(fields=["organisation", "-updated_at"], name="campaign_last_changed_idx")]

    def __str__(self) -> str:
        return self.name
