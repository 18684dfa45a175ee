"""Rehearsals: simulated flights of a plan, their conditions and results."""

import uuid

from django.conf import settings
from django.db import models
from django.db.models import Q
from django.db.models.functions import Now
from django.utils.translation import gettext_lazy as _

from missions.models import Mission, UavType
from simulation.vehicle_models import SimulatedAutopilotType as SimulatedAutopilotType
from simulation.vehicle_models import SimulatedVehicle as SimulatedVehicle
from simulation.vehicle_models import Simulation as Simulation
from simulation.vehicle_models import SimulationChange as SimulationChange
from simulation.vehicle_models import SimulationState as SimulationState
from workspace.models import Job, Organisation


class AssessmentLevel(models.TextChoices):
    PASS = "pass", _("Pass")
    WARNINGS = "warnings", _("Pass with warnings")
    FAIL = "fail", _("Fail")


class Rehearsal(models.Model):
    """A simulated flight of one plan of a mission. It is valid for the content of its hash only."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, related_name="rehearsals")
    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, related_name="rehearsals")
    job = models.OneToOneField(Job, on_delete=models.CASCADE, related_name="rehearsal", help_text="its state, lease and progress")
    content_sha256 = models.CharField(max_length=64, editable=False, help_text="of the routes, what flies them and when")
    mission_revision = models.PositiveIntegerField(help_text="of the mission when it was asked for")
    ground_revision = models.PositiveBigIntegerField(help_text="zones, assets and terrain that it is held against")
    ground_sha256 = models.CharField(
        max_length=64, blank=True, default="", db_default="", editable=False, help_text="of zones, heights and what stands about the routes"
    )
    uavs = models.JSONField(default=list, help_text="by place in the mission: airframe, why, battery; see services/fleet.py")
    seed = models.PositiveIntegerField(default=7, help_text="of gusts and turbulence: the same seed, the same flight")
    level = models.CharField(max_length=10, choices=AssessmentLevel.choices, blank=True, help_text="of all runs; empty until they are done")
    limits = models.JSONField(default=dict, help_text="that it is held against, each with its source")
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="rehearsals")
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["-created_at", "-pk"]
        constraints = [models.CheckConstraint(condition=Q(level="") | Q(level__in=AssessmentLevel.values), name="rehearsal_level_known")]
        indexes = [models.Index(fields=["mission", "-created_at"], name="rehearsal_newest_idx")]

    def __str__(self) -> str:
        return f"{self.mission} {self.created_at:%Y-%m-%d %H:%M}"


class RehearsalRun(models.Model):
    """All routes under one set of conditions, stored when complete: after the loss of a worker only the present run is repeated."""

    rehearsal = models.ForeignKey(Rehearsal, on_delete=models.CASCADE, related_name="runs")
    sequence = models.PositiveSmallIntegerField()
    conditions = models.JSONField(help_text="wind, gusts, battery; see rehearsing/weather_scenario.py")
    level = models.CharField(max_length=10, choices=AssessmentLevel.choices, blank=True, help_text="empty until it has been flown")
    assessment = models.JSONField(db_column="verdict", null=True, blank=True, help_text="see assessment/stored.py")
    took_s = models.FloatField(null=True, blank=True, help_text="of the worker's time")
    finished_at = models.DateTimeField(null=True, blank=True)

    class Meta:
        ordering = ["sequence"]
        constraints = [
            models.UniqueConstraint(fields=["rehearsal", "sequence"], name="rehearsal_run_sequence"),
            models.CheckConstraint(condition=Q(level="") | Q(level__in=AssessmentLevel.values), name="rehearsal_run_level_known"),
        ]

    def __str__(self) -> str:
        return f"{self.conditions.get('code')} of {self.rehearsal_id}"


class RehearsalTrack(models.Model):
    """The track of one UAV in a run, one row per second."""

    run = models.ForeignKey(RehearsalRun, on_delete=models.CASCADE, related_name="tracks")
    uav = models.PositiveSmallIntegerField(help_text="its place in the mission")
    flights = models.JSONField(help_text="columns of each flight; see assessment/stored.py")

    class Meta:
        ordering = ["uav"]
        constraints = [models.UniqueConstraint(fields=["run", "uav"], name="rehearsal_track_uav")]

    def __str__(self) -> str:
        return f"{self.uav} in {self.run_id}"


class SimulatedAirframe(models.Model):
    """The simulated airframe for the UAVs of a type; without a row it is the nearest one."""

    uav_type = models.OneToOneField(UavType, on_delete=models.CASCADE, primary_key=True, related_name="simulated_airframe")
    airframe = models.CharField(max_length=40, help_text="a code of simulation/flight/airframe.py")
    updated_at = models.DateTimeField(auto_now=True)

    def __str__(self) -> str:
        return f"{self.airframe} for {self.uav_type_id}"


class RehearsalRule(models.Model):
    """Whether an organisation requires a passed rehearsal for approval; without a row it does not."""

    organisation = models.OneToOneField(Organisation, on_delete=models.CASCADE, primary_key=True, related_name="rehearsal_rule")
    requires_green = models.BooleanField(default=False, help_text="approval needs a rehearsal of the present plan without a fail")
    updated_at = models.DateTimeField(auto_now=True)

    def __str__(self) -> str:
        return f"{self.organisation}: {'required' if self.requires_green else 'not required'}"
