"""Missions: targets, UAVs, routes and waypoints, and saved selections."""

import uuid
from collections.abc import Sequence

from django.conf import settings
from django.contrib.gis.db import models
from django.contrib.gis.geos import Point
from django.contrib.postgres.fields import ArrayField
from django.db.models import Q
from django.db.models.functions import Now

from inspection.models import Asset
from missions.models.fleet import END_ACTIONS, Uav
from planning.problem import Objective
from planning.request import EndAction
from planning.trajectory.waypoints import WaypointKind
from workspace.api.external_data import MAX_EXTERNAL_ID_LENGTH
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation

MAX_NAME_LENGTH = 200
MAX_SENSOR_LENGTH = 100


class MissionState(models.TextChoices):
    DRAFT = "draft", "Draft"
    PLANNED = "planned", "Planned"
    APPROVED = "approved", "Approved"
    DISPATCHED = "dispatched", "Dispatched"
    ACTIVE = "active", "Active"
    COMPLETED = "completed", "Completed"
    ABORTED = "aborted", "Aborted"
    FAILED = "failed", "Failed"


ENDED_STATES = (MissionState.COMPLETED, MissionState.ABORTED, MissionState.FAILED)
OBJECTIVES = [
    (Objective.TOTAL.value, "Fly least"), (Objective.MAKESPAN.value, "Even routes"), (Objective.TIME.value, "Least flying time"),
    (Objective.ENERGY.value, "Least energy"),
]  # fmt: skip
WAYPOINT_KINDS = [
    (WaypointKind.START.value, "Start"), (WaypointKind.PASS.value, "Pass"), (WaypointKind.TARGET.value, "Target"),
    (WaypointKind.END.value, "End"), (WaypointKind.BASE.value, "Between two flights"),
]  # fmt: skip


class Mission(models.Model):
    """Targets, UAVs and options, and the plan made from them on one version of the graph."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="missions")
    name = models.CharField(max_length=MAX_NAME_LENGTH)
    author = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="missions")
    state = models.CharField(max_length=20, choices=MissionState.choices, default=MissionState.DRAFT)
    objective = models.CharField(max_length=10, choices=OBJECTIVES, default=Objective.TOTAL.value)
    return_to_start = models.BooleanField(default=False)
    departs_at = models.DateTimeField(null=True, blank=True, help_text="planned take-off; empty = at any time")
    conditions = models.JSONField(default=dict, blank=True, help_text="wind by height and temperature; see planning/energy/conditions.py")
    charging_w = models.FloatField(null=True, blank=True, help_text="watts of charging at towers on the way; empty = none")
    lost_link = models.JSONField(default=dict, blank=True, help_text="what UAVs do without a link; see services/planning/requests.py")
    revision = models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")
    planned_at = models.DateTimeField(null=True, blank=True)
    graph_version = models.BigIntegerField(null=True, blank=True, help_text="the graph that the routes were planned on")
    ground_revision = models.PositiveBigIntegerField(null=True, blank=True, help_text="the ground that the routes were checked against")
    flat_ground_assumed = models.BooleanField(null=True, blank=True)
    total_length_m = models.FloatField(null=True, blank=True)
    longest_route_m = models.FloatField(null=True, blank=True)
    total_energy_wh = models.FloatField(null=True, blank=True, help_text="of the routes of UAVs with a battery; empty = none has one")
    lost_link_check = models.JSONField(null=True, blank=True, help_text="from where UAVs cannot do so")
    separation = models.JSONField(null=True, blank=True, help_text="how the routes are kept apart, and what could not be")
    last_plan = models.JSONField(null=True, blank=True, help_text="summary of the plan before the present one, to compare with")
    locks = models.JSONField(default=list, blank=True, help_text="runs of targets that one UAV flies in this order; targets by sequence")
    plan_quality = models.JSONField(null=True, blank=True, help_text="bound, gap and method of the plan, and what its locks cost")
    plan_warnings = models.JSONField(default=list, blank=True, help_text="what the plan says about UAVs that cannot start")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)
    deleted_at = models.DateTimeField(null=True, blank=True, help_text="deleted missions can be brought back")
    is_demo = models.BooleanField(default=False, db_default=False, help_text="made with the demo data, and goes with them")
    external_id = models.CharField(
        max_length=MAX_EXTERNAL_ID_LENGTH,
        blank=True,
        default="",
        db_default="",
        help_text="another system's id, such as a work order's; several missions may have one",
    )
    attributes = models.JSONField(default=dict, db_default={}, blank=True, help_text="names and values of other systems")
    call_number = models.PositiveSmallIntegerField(
        null=True, blank=True, help_text="before the letters of its UAVs while several missions fly: 2 of 2B; empty: never sent to UAVs"
    )
    colours = ArrayField(
        models.PositiveSmallIntegerField(),
        default=list,
        db_default=[],
        blank=True,
        help_text="numbers of the colours of its UAVs by their places; empty: never sent to UAVs, those of the places",
    )
    started_at = models.DateTimeField(null=True, blank=True, help_text="when its first UAV began to fly")
    ended_at = models.DateTimeField(null=True, blank=True, help_text="when it was completed, aborted, or had failed")
    continues = models.ForeignKey(
        "self",
        on_delete=models.SET_NULL,
        null=True,
        blank=True,
        related_name="continued_by",
        help_text="the mission whose rest this one flies",
    )
    simulates = models.ForeignKey(
        "self",
        on_delete=models.CASCADE,
        null=True,
        blank=True,
        related_name="simulated_copies",
        help_text="the mission of which this is a copy with simulated twins of its UAVs",
    )
    campaign = models.ForeignKey(
        "Campaign", on_delete=models.SET_NULL, null=True, blank=True, related_name="missions", help_text="that it was planned in"
    )
    alert_limits = models.JSONField(
        default=dict,
        db_default={},
        blank=True,
        help_text="limits of alerts that differ from the UAVs' types; see telemetry/alerting/limits.py",
    )

    class Meta:
        ordering = ["-updated_at"]
        indexes = [
            models.Index(fields=["organisation"], condition=Q(state__in=["dispatched", "active"]), name="mission_on_its_way_idx"),
            models.Index(fields=["organisation", "ended_at"], condition=Q(ended_at__isnull=False), name="mission_just_ended_idx"),
            models.Index(fields=["organisation", "external_id"], condition=~Q(external_id=""), name="mission_external_id_idx"),
        ]
        constraints = [
            models.CheckConstraint(condition=Q(state__in=MissionState.values), name="mission_state_known"),
            models.CheckConstraint(
                condition=Q(state=MissionState.DRAFT) | Q(planned_at__isnull=False, graph_version__isnull=False), name="mission_plan_stated"
            ),
        ]

    def __str__(self) -> str:
        return self.name


class MissionUav(models.Model):
    """A UAV's place in a mission; `sequence` determines its letter, `start` is its take-off position."""

    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, related_name="mission_uavs")
    uav = models.ForeignKey(Uav, on_delete=models.PROTECT, null=True, blank=True, related_name="mission_uavs")
    sequence = models.PositiveSmallIntegerField()
    name = models.CharField(max_length=100)
    start = models.PointField(srid=4326)
    max_range_m = models.FloatField(null=True, blank=True)
    cruise_speed_mps = models.FloatField()
    end_action = models.CharField(max_length=10, choices=END_ACTIONS, default=EndAction.HOVER.value)
    most_targets = models.PositiveIntegerField(null=True, blank=True, help_text="that it does at most; empty = not limited")
    sorties = models.PositiveSmallIntegerField(default=1, db_default=1, help_text="flights that it makes at most, each on a full battery")
    sensors = ArrayField(models.CharField(max_length=MAX_SENSOR_LENGTH), default=list, blank=True)
    performance = models.JSONField(default=dict, blank=True, help_text="battery, mass and airspeed; see planning/energy/performance.py")
    own_figures = ArrayField(
        models.CharField(max_length=20),
        default=list,
        db_default=[],
        blank=True,
        help_text="names of the figures that are said for this mission; the others were the UAV's when it was made",
    )
    fleet_figures = models.JSONField(
        default=dict, db_default={}, blank=True, help_text="of the own figures: what the UAV had for them when they were said"
    )
    home = models.PointField(srid=4326, null=True, blank=True, help_text="where it took off, if it is in the air already; empty = at start")
    home_amsl_m = models.FloatField(null=True, blank=True, help_text="of the ground there; empty without terrain data")

    class Meta:
        ordering = ["sequence"]
        verbose_name = "UAV in a mission"
        verbose_name_plural = "UAVs in missions"
        constraints = [
            models.UniqueConstraint(fields=["mission", "sequence"], name="mission_uav_sequence"),
            models.CheckConstraint(condition=Q(most_targets=None) | Q(most_targets__gte=1), name="mission_uav_does_something"),
        ]

    def __str__(self) -> str:
        return self.name


class TargetState(models.TextChoices):
    PENDING = "pending", "Pending"
    IN_PROGRESS = "in-progress", "In progress"
    COMPLETE = "complete", "Complete"
    SKIPPED = "skipped", "Skipped"
    FAILED = "failed", "Failed"


class TargetPriority(models.TextChoices):
    LOW = "low", "Low"
    NORMAL = "normal", "Normal"
    HIGH = "high", "High"


class InspectionTarget(models.Model):
    """A target of inspection: an asset, a point or stretch of one, or a bare position. It outlives a deleted asset."""

    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, related_name="targets")
    sequence = models.PositiveIntegerField(help_text="place in the operator's list, from 0")
    asset = models.ForeignKey(Asset, on_delete=models.SET_NULL, null=True, blank=True, related_name="targets")
    label = models.CharField(max_length=255, help_text="the asset's name when it was picked")
    position = models.PointField(srid=4326, null=True, blank=True, help_text="empty: the asset's centre, or the whole line")
    stretch = models.LineStringField(srid=4326, null=True, blank=True, help_text="two points on the asset; empty = not a stretch")
    task = models.JSONField(default=dict, help_text="see planning/problem.py, Task")
    priority = models.CharField(max_length=6, choices=TargetPriority.choices, default=TargetPriority.NORMAL)
    uav_name = models.CharField(max_length=100, blank=True, help_text="the only UAV that may do it; empty = any")
    sensor = models.CharField(max_length=MAX_SENSOR_LENGTH, blank=True, help_text="that its UAV must have; empty = any")
    external_id = models.CharField(
        max_length=MAX_EXTERNAL_ID_LENGTH, blank=True, default="", db_default="", help_text="another system's id, such as a work item's"
    )
    attributes = models.JSONField(default=dict, db_default={}, blank=True, help_text="names and values of other systems")
    state = models.CharField(max_length=20, choices=TargetState.choices, default=TargetState.PENDING)
    state_at = models.DateTimeField(null=True, blank=True, help_text="since when, while the mission flies")
    state_reason = models.CharField(max_length=300, blank=True, default="", db_default="", help_text="why it was skipped or failed")
    state_why = models.JSONField(null=True, blank=True, help_text="the same as reasons, if it was no person; see workspace/reason_texts.py")
    reached_at = models.DateTimeField(null=True, blank=True, help_text="by the log; empty: not known, or it was not reached")
    held_s = models.FloatField(null=True, blank=True, help_text="the longest that its UAV can have stayed; empty: not known")
    visit_stored_at = models.DateTimeField(null=True, blank=True, help_text="when reached_at and held_s were stored or changed")
    unassigned_reason = models.CharField(max_length=40, blank=True)
    unassigned_message = models.CharField(max_length=500, blank=True, help_text="in English")
    unassigned_why = models.JSONField(default=list, db_default=[], blank=True, help_text="the reasons as codes; see operation/reasons.py")
    unassigned_missing = models.JSONField(default=dict, db_default={}, blank=True, help_text="what the message tells to be missing")

    class Meta:
        ordering = ["sequence"]
        indexes = [
            models.Index(fields=["external_id"], condition=~Q(external_id=""), name="target_external_id_idx"),
            models.Index(fields=["-state_at", "-id"], condition=Q(state_at__isnull=False), name="target_state_at_idx"),
        ]
        constraints = [
            models.UniqueConstraint(fields=["mission", "sequence"], name="target_sequence", deferrable=models.Deferrable.DEFERRED),
            models.CheckConstraint(condition=Q(state__in=TargetState.values), name="target_state_known"),
            models.CheckConstraint(condition=Q(priority__in=TargetPriority.values), name="target_priority_known"),
        ]

    def __str__(self) -> str:
        return self.label

    @property
    def place(self) -> Point | None:
        """Where it is shown: as picked, the middle between the ends of a stretch, or the asset's centre; None if that was deleted."""
        if self.position is not None:
            return self.position
        if self.stretch is not None:
            return between_ends(self.stretch.coords)
        return None if self.asset is None else self.asset.centre


def between_ends(ends: Sequence[Sequence[float]]) -> Point:
    """Return the middle between the ends of a stretch, lon lat [deg]; near the 180th meridian its first end."""
    (west, south), (east, north) = (end[:2] for end in ends)
    return Point(west, south, srid=4326) if abs(east - west) > 180.0 else Point((west + east) / 2.0, (south + north) / 2.0, srid=4326)


class Route(models.Model):
    """One UAV's part of a mission's plan."""

    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, related_name="routes")
    mission_uav = models.OneToOneField(MissionUav, on_delete=models.CASCADE, related_name="route")
    graph_version = models.BigIntegerField(help_text="equals the mission's: a mission is never mixed from two plans")
    length_m = models.FloatField()
    duration_s = models.FloatField()
    departs_s = models.FloatField(default=0.0, db_default=0.0, help_text="seconds after the mission's departure")
    energy_wh = models.FloatField(null=True, blank=True, help_text="empty without a battery")
    charging = models.JSONField(default=list, blank=True, help_text="stops at towers to charge; see services/planning/plan_json.py")
    battery_percent = models.FloatField(null=True, blank=True, help_text="left at the end; empty without a battery")
    base_name = models.CharField(max_length=100, blank=True, default="", help_text="the base at which it lands, where it ends at one")
    lands_at = models.PointField(srid=4326, null=True, blank=True, help_text="where that base was when the route was planned")
    flights_flown = models.PositiveSmallIntegerField(default=0, db_default=0, help_text="of its flights, since it was approved")
    has_failed = models.BooleanField(default=False, db_default=False, help_text="a flight of it, since it was approved: it is not flown on")
    continued_by = models.ForeignKey(
        Mission,
        on_delete=models.SET_NULL,
        null=True,
        blank=True,
        related_name="continued_routes",
        help_text="the mission that has taken over what was left of it: it is not flown on",
    )
    begun_by = models.PositiveIntegerField(
        null=True, blank=True, help_text="of one that is begun in the air: the waypoint until which that may be; empty = it takes off"
    )
    geometry = models.LineStringField(srid=4326, null=True, blank=True, help_text="empty when the UAV is not used")
    before_hand = models.JSONField(
        default=list,
        db_default=[],
        blank=True,
        help_text="its waypoints before each change by hand that can be taken back; see services/manual_edits/edits.py",
    )

    class Meta:
        ordering = ["mission_uav__sequence"]

    def __str__(self) -> str:
        return f"{self.mission_uav} in {self.mission}"


class Waypoint(models.Model):
    """One point of a route with its height over three references; relative is above the take-off point."""

    route = models.ForeignKey(Route, on_delete=models.CASCADE, related_name="waypoints")
    sequence = models.PositiveIntegerField()
    kind = models.CharField(max_length=10, choices=WAYPOINT_KINDS)
    position = models.PointField(srid=4326)
    asset = models.ForeignKey(Asset, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    target = models.ForeignKey(InspectionTarget, on_delete=models.CASCADE, null=True, blank=True, related_name="waypoints")
    task = models.JSONField(null=True, blank=True)
    altitude_agl_m = models.FloatField()
    altitude_amsl_m = models.FloatField(null=True, blank=True, help_text="empty without terrain data")
    altitude_relative_m = models.FloatField()
    arrival_s = models.FloatField(null=True, blank=True, help_text="seconds after the mission's departure; empty in older plans")
    used_wh = models.FloatField(null=True, blank=True, help_text="since take-off; empty without a battery")
    battery_left_percent = models.FloatField(null=True, blank=True)
    speed_mps = models.FloatField(null=True, blank=True, help_text="over ground on the leg to it, by hand; empty = the UAV's own")
    is_by_hand = models.BooleanField(default=False, db_default=False, help_text="put in, moved or flown otherwise by a person")

    class Meta:
        ordering = ["sequence"]
        constraints = [models.UniqueConstraint(fields=["route", "sequence"], name="waypoint_sequence")]

    def __str__(self) -> str:
        return f"{self.sequence} {self.kind}"


class SavedSelection(models.Model):
    """Targets that a user saved for later use by the whole organisation."""

    organisation = models.ForeignKey(
        Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="saved_selections"
    )
    author = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="saved_selections")
    name = models.CharField(max_length=100)
    targets = models.JSONField(help_text="as in a mission's request, each with the label it had")
    revision = models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["name"]
        constraints = [models.UniqueConstraint(fields=["organisation", "name"], name="saved_selection_name_unique")]

    def __str__(self) -> str:
        return self.name
