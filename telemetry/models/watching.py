"""Estimates of UAVs, and their latest state for live pages."""

from django.contrib.gis.db import models
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
