"""Findings: what is wrong with an asset, where photos show it, and what has come of it."""

import uuid

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from inspection.models import Asset
from missions.models import InspectionTarget, Mission
from results.finding_states import FindingState
from results.models.media import Medium
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation

MAX_MARKS = 50  # of a finding
MAX_NOTE_LENGTH = 2_000
MAX_REFERENCE_LENGTH = 100
STATES = [
    (FindingState.OPEN.value, "Open"),
    (FindingState.WORK_ORDERED.value, "Work ordered"),
    (FindingState.DONE.value, "Done"),
    (FindingState.VERIFIED.value, "Verified"),
    (FindingState.REJECTED.value, "Rejected"),
]


class SeveritySource(models.TextChoices):
    USER = "user", "User"
    RULE = "rule", "Rule"
    IMPORT = "import", "Import"


class Finding(models.Model):
    """One defect of one asset, however many photos show it."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="findings")
    number = models.PositiveIntegerField(help_text="within the organisation, from 1")
    asset = models.ForeignKey(Asset, on_delete=models.SET_NULL, null=True, blank=True, related_name="findings")
    asset_label = models.CharField(max_length=300, blank=True, default="", db_default="", help_text="when the finding was made")
    mission = models.ForeignKey(Mission, on_delete=models.SET_NULL, null=True, blank=True, related_name="findings")
    target = models.ForeignKey(InspectionTarget, on_delete=models.SET_NULL, null=True, blank=True, related_name="findings")
    position = models.PointField(srid=4326, null=True, blank=True, help_text="of the asset, else of the camera")
    category = models.CharField(max_length=40, help_text="code; see results/categories.py")
    scheme = models.CharField(max_length=40, help_text="the list of categories that the code is of")
    note = models.CharField(max_length=MAX_NOTE_LENGTH, blank=True, default="", db_default="")
    severity = models.PositiveSmallIntegerField(help_text="1 danger to 4 note")
    severity_source = models.CharField(max_length=10, choices=SeveritySource.choices, default=SeveritySource.USER)
    state = models.CharField(max_length=12, choices=STATES, default=FindingState.OPEN.value)
    done_at = models.DateTimeField(null=True, blank=True)
    due_on = models.DateField(null=True, blank=True)
    work_reference = models.CharField(max_length=MAX_REFERENCE_LENGTH, blank=True, default="", db_default="")
    first_seen_at = models.DateTimeField()
    last_seen_at = models.DateTimeField()
    revision = models.PositiveIntegerField(default=1, db_default=1, help_text="counts the changes; the ETag")
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["severity", "-created_at"]
        constraints = [
            models.UniqueConstraint(fields=["organisation", "number"], name="finding_number_once"),
            models.CheckConstraint(condition=Q(severity__gte=1, severity__lte=4), name="finding_severity_1_to_4"),
            models.CheckConstraint(condition=Q(state__in=[state.value for state in FindingState]), name="finding_state_known"),
            models.CheckConstraint(condition=Q(severity_source__in=SeveritySource.values), name="finding_severity_source_known"),
        ]
        indexes = [
            models.Index(fields=["asset", "state"], name="finding_of_asset_idx"),
            models.Index(fields=["organisation", "severity", "-created_at"], name="finding_by_severity_idx"),
        ]

    def __str__(self) -> str:
        return f"{self.number} {self.category}"


class Evidence(models.Model):
    """Where a medium shows a finding: a box or polygon in pixels of the upright original, or nothing for the whole picture."""

    finding = models.ForeignKey(Finding, on_delete=models.CASCADE, related_name="evidence")
    medium = models.ForeignKey(Medium, on_delete=models.PROTECT, related_name="evidence")
    shape = models.JSONField(
        null=True, blank=True, help_text='{"type": "box", "x", "y", "width", "height"} or {"type": "polygon", "points"}'
    )
    author = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["pk"]
        verbose_name_plural = "evidence"

    def __str__(self) -> str:
        return f"{self.finding_id} on {self.medium_id}"


class ObservationOutcome(models.TextChoices):
    SEEN = "seen", "Seen again"
    NOT_SEEN = "not_seen", "Looked, and not seen"


class Observation(models.Model):
    """A statement that a later medium shows a finding, or does not. Without one, the finding was not looked for."""

    finding = models.ForeignKey(Finding, on_delete=models.CASCADE, related_name="observations")
    medium = models.ForeignKey(Medium, on_delete=models.PROTECT, related_name="observations")
    outcome = models.CharField(max_length=10, choices=ObservationOutcome.choices)
    observed_at = models.DateTimeField(help_text="when the medium was taken")
    author = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["observed_at", "pk"]
        constraints = [models.CheckConstraint(condition=Q(outcome__in=ObservationOutcome.values), name="observation_outcome_known")]

    def __str__(self) -> str:
        return f"{self.outcome} of {self.finding_id}"


class FindingComment(models.Model):
    finding = models.ForeignKey(Finding, on_delete=models.CASCADE, related_name="comments")
    author = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    text = models.CharField(max_length=MAX_NOTE_LENGTH)
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["created_at", "pk"]

    def __str__(self) -> str:
        return self.text[:50]
