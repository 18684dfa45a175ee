"""Offers of another plan for the rest of a mission that flies."""

import uuid

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from missions.models.missions import Mission


class OfferState(models.TextChoices):
    COMPUTING = "computing", "Being worked out"
    OPEN = "open", "Waits for a decision"
    ACCEPTED = "accepted", "Accepted"
    DECLINED = "declined", "Declined"
    OUTDATED = "outdated", "Outdated"
    IMPOSSIBLE = "impossible", "No way was found"


class ReplanOffer(models.Model):
    """A new assignment of the remaining targets, offered beside the flying plan. Nothing changes until a user confirms it.

    A confirmed offer becomes a mission of its own that continues this one: a mission never mixes two plans.
    """

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, related_name="replan_offers")
    code = models.CharField(max_length=50, help_text="why: uav-out, zone-active, battery-short, asked-for")
    cause = models.JSONField(default=dict, blank=True, help_text="UAV, zone, figures of the cause")
    state = models.CharField(max_length=12, choices=OfferState.choices, default=OfferState.COMPUTING)
    difference = models.JSONField(default=dict, blank=True, help_text="what would change, per UAV and target")
    continuation = models.OneToOneField(
        Mission,
        on_delete=models.SET_NULL,
        null=True,
        blank=True,
        related_name="offered_by",
        help_text="the planned mission that is offered",
    )
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    decided_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    decided_at = models.DateTimeField(null=True, blank=True)
    outcome = models.CharField(max_length=500, blank=True, help_text="why it is outdated or impossible, in English")
    outcome_why = models.JSONField(null=True, blank=True, help_text="the same as reasons; see workspace/reason_texts.py")

    class Meta:
        ordering = ["-created_at"]
        constraints = [
            models.UniqueConstraint(fields=["mission"], condition=Q(state__in=["computing", "open"]), name="replan_offer_one_undecided"),
            models.CheckConstraint(condition=Q(state__in=OfferState.values), name="replan_offer_state_known"),
        ]

    def __str__(self) -> str:
        return f"{self.code} {self.state}"
