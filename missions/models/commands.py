"""Approvals, which freeze what may be flown, the outbox of commands, starts by the plan, and offers of another plan for the rest."""

import uuid

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from missions.models.fleet import LinkKind, Uav
from missions.models.missions import Mission
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation


class Approval(models.Model):
    """A plan as a user approved it. `document` never changes: everything sent to a UAV is read from it."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, related_name="approvals")
    document = models.JSONField(help_text="routes, items, zones, conditions and terrain; see services/approval/approval.py")
    content_sha256 = models.CharField(max_length=64, help_text="of the document in its canonical form")
    approved_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, related_name="+")
    approved_at = models.DateTimeField(db_default=Now(), editable=False)
    failed_rehearsal_reason = models.CharField(
        max_length=300,
        blank=True,
        default="",
        db_default="",
        help_text="why it was approved without a passed rehearsal",
    )
    revoked_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    revoke_requested_at = models.DateTimeField(null=True, blank=True, help_text="since when UAVs are being rid of it")
    revoked_at = models.DateTimeField(null=True, blank=True)
    revoke_reason = models.CharField(max_length=300, blank=True)

    class Meta:
        ordering = ["-approved_at"]
        constraints = [models.UniqueConstraint(fields=["mission"], condition=Q(revoked_at=None), name="approval_one_in_force")]

    def __str__(self) -> str:
        return f"{self.mission} {self.content_sha256[:12]}"


class CommandPriority(models.IntegerChoices):
    """Priority of a command; the smallest is delivered first."""

    SAFETY = 0, "Safety"
    PAUSE = 1, "Pause"
    MISSION = 2, "Mission"
    PARAMETER = 3, "Parameter"


class CommandKind(models.TextChoices):
    UPLOAD_MISSION = "upload-mission", "Send the mission"
    CLEAR_MISSION = "clear-mission", "Take the mission off the UAV"
    ARM = "arm", "Arm"
    TAKE_OFF = "take-off", "Take off"
    START = "start", "Start the mission"
    PAUSE = "pause", "Pause"
    RESUME = "resume", "Resume"
    HOLD = "hold", "Hold"
    RETURN = "return", "Return"
    LAND = "land", "Land"
    ABORT = "abort", "Abort the mission"
    CHANGE_SPEED = "change-speed", "Change speed"
    SET_RETURN_HEIGHT = "set-return-height", "Set the return height"


class CommandState(models.TextChoices):
    QUEUED = "queued", "Queued"
    SENT = "sent", "Sent"
    ACKNOWLEDGED = "acknowledged", "Acknowledged"
    APPLIED = "applied", "Applied"
    FAILED = "failed", "Failed"
    EXPIRED = "expired", "Expired"


class CommandAxis(models.TextChoices):
    """State that a command sets; see command_rules.py."""

    FLIGHT = "flight", "Flight"
    MISSION = "mission", "Mission"
    SPEED = "speed", "Speed"
    PARAMETER = "parameter", "Parameter"


OPEN_COMMANDS = (CommandState.QUEUED, CommandState.SENT, CommandState.ACKNOWLEDGED)


class UavCommand(models.Model):
    """A command to a UAV and its outcome. The row is authoritative; the dispatcher holds it by a lease.

    A command sets a state, so delivering it twice changes nothing. `sequence` counts the commands of one UAV in the order in which they
    were given. A command that a later one on the same axis replaces expires and is never delivered after it. Ended commands stay ended.
    At most one command of an axis is open, so an open command is always the latest of its kind.
    """

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="uav_commands")
    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="commands")
    mission = models.ForeignKey(Mission, on_delete=models.CASCADE, null=True, blank=True, related_name="commands")
    approval = models.ForeignKey(Approval, on_delete=models.PROTECT, null=True, blank=True, related_name="commands")
    sequence = models.BigIntegerField()
    kind = models.CharField(max_length=20, choices=CommandKind.choices)
    priority = models.PositiveSmallIntegerField(choices=CommandPriority.choices)
    axis = models.CharField(max_length=10, choices=CommandAxis.choices, help_text="what it sets: one open command of a UAV each")
    parameters = models.JSONField(default=dict, blank=True)
    state = models.CharField(max_length=12, choices=CommandState.choices, default=CommandState.QUEUED)
    link = models.CharField(max_length=10, choices=LinkKind.choices, help_text="the door by which it goes")
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    why = models.CharField(max_length=300, blank=True, help_text="as the person who gave it wrote")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    expires_at = models.DateTimeField(null=True, blank=True)
    attempts = models.PositiveIntegerField(default=0)
    holder = models.CharField(max_length=100, blank=True, help_text="the gateway that carries it")
    lease_expires_at = models.DateTimeField(null=True, blank=True)
    sent_at = models.DateTimeField(null=True, blank=True, help_text="first")
    acknowledged_at = models.DateTimeField(null=True, blank=True)
    finished_at = models.DateTimeField(null=True, blank=True)
    progress = models.JSONField(null=True, blank=True, help_text="of an upload: items done and in all")
    outcome_code = models.CharField(max_length=50, blank=True)
    outcome = models.CharField(max_length=500, blank=True, help_text="why it failed or expired, in English")
    outcome_why = models.JSONField(null=True, blank=True, help_text="the same as reasons; see workspace/reason_texts.py")

    class Meta:
        ordering = ["-created_at", "-sequence"]
        verbose_name = "UAV command"
        constraints = [
            models.UniqueConstraint(fields=["uav", "sequence"], name="uav_command_sequence"),
            models.UniqueConstraint(
                fields=["uav", "axis"], condition=Q(state__in=["queued", "sent", "acknowledged"]), name="uav_command_one_open_of_an_axis"
            ),
            models.CheckConstraint(condition=Q(state__in=CommandState.values), name="uav_command_state_known"),
            models.CheckConstraint(condition=Q(kind__in=CommandKind.values), name="uav_command_kind_known"),
            models.CheckConstraint(
                condition=~Q(kind=CommandKind.UPLOAD_MISSION) | Q(approval__isnull=False), name="uav_command_upload_is_approved"
            ),
        ]
        indexes = [
            models.Index(
                fields=["priority", "created_at"], condition=Q(state__in=["queued", "sent", "acknowledged"]), name="uav_command_open_idx"
            ),
            models.Index(fields=["mission", "-created_at"], name="uav_command_of_mission_idx"),
            models.Index(fields=["organisation", "finished_at"], name="uav_command_just_ended_idx"),
        ]

    def __str__(self) -> str:
        return f"{self.get_kind_display()} to {self.uav}"


class UavCommandEvent(models.Model):
    """One step in the life of a command. Never updated."""

    command = models.ForeignKey(UavCommand, on_delete=models.CASCADE, related_name="events")
    state = models.CharField(max_length=12, choices=CommandState.choices)
    attempt = models.PositiveIntegerField()
    holder = models.CharField(max_length=100, blank=True)
    note = models.CharField(max_length=500, blank=True)
    recorded_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["pk"]

    def __str__(self) -> str:
        return f"{self.state} {self.command_id}"


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
