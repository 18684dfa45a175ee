"""Data issues, for a curator to repair or dismiss. Tables, constraints and indexes keep their former names."""

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now


class DataIssueKind(models.TextChoices):
    LONG_SPAN = "long_span", "Span far longer than the line's others"
    MISSING_SUPPORT = "missing_support", "Line vertex without a tower"
    TOWER_ON_NO_LINE = "tower_on_no_line", "Tower on no line"
    LINE_WITHOUT_TOWERS = "line_without_towers", "Line without towers"
    DEAD_END = "dead_end", "Line that ends in nothing"
    ENDS_APART = "ends_apart", "Ends that should join"
    BRIDGE_WITHOUT_WAY = "bridge_without_way", "Bridge without a way"
    IMPOSSIBLE_VOLTAGE = "impossible_voltage", "Impossible voltage"


class DataIssueState(models.TextChoices):
    OPEN = "open", "Open"
    REPAIRED = "repaired", "Repaired"  # no longer found, or repaired here
    DISMISSED = "dismissed", "Left as it is"


class DataIssue(models.Model):
    """One place where map data look wrong. Its key stays the same for each dataset version, so that a decision is kept."""

    kind = models.CharField(max_length=30, choices=DataIssueKind.choices)
    key = models.CharField(max_length=200, unique=True, help_text="kind and the places that it is about; the same on every run")
    state = models.CharField(max_length=20, choices=DataIssueState.choices, default=DataIssueState.OPEN)
    asset = models.ForeignKey("inspection.Asset", on_delete=models.CASCADE, null=True, blank=True, related_name="issues")
    other_asset = models.ForeignKey("inspection.Asset", on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    position = models.PointField(srid=4326)
    geometry = models.GeometryField(srid=4326, null=True, blank=True, help_text="what to draw: the span, the two ends")
    details = models.JSONField(default=dict, blank=True, help_text="figures with units in their names")
    cut_off_m = models.FloatField(default=0.0, help_text="length of network that it cuts off")
    ground_revision = models.PositiveBigIntegerField(help_text="where it was last found")
    note = models.CharField(max_length=500, blank=True)
    decided_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    decided_at = models.DateTimeField(null=True, blank=True)
    found_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        db_table = "inspection_datagap"
        ordering = ["-cut_off_m", "pk"]
        constraints = [
            models.CheckConstraint(condition=Q(kind__in=DataIssueKind.values), name="gap_kind_known"),
            models.CheckConstraint(condition=Q(state__in=DataIssueState.values), name="gap_state_known"),
        ]
        indexes = [models.Index(fields=["state", "-cut_off_m", "id"], name="gap_worst_idx")]

    def __str__(self) -> str:
        return f"{self.get_kind_display()} {self.key}"


class DataIssueSearch(models.Model):
    """One row: the dataset version of the last search, its rules, and its duration."""

    SINGLE_ID = 1

    id = models.PositiveSmallIntegerField(primary_key=True, default=SINGLE_ID)
    ground_revision = models.PositiveBigIntegerField()
    ground_changed_at = models.DateTimeField(null=True, help_text="two grounds may have the same revision")
    recipe = models.PositiveSmallIntegerField(help_text="of quality/repair.py")
    found = models.PositiveIntegerField()
    search_s = models.FloatField()
    searched_at = models.DateTimeField()

    class Meta:
        db_table = "inspection_gapsearch"
        verbose_name_plural = "issue searches"
        constraints = [models.CheckConstraint(condition=Q(id=1), name="gap_search_single")]

    def __str__(self) -> str:
        return f"revision {self.ground_revision}: {self.found} issues"
