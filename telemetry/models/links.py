"""Links of UAVs to gateways, unknown vehicles, flight logs and status texts."""

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from missions.models import Uav
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation


class UavLink(models.Model):
    """State of a UAV's link, written by the gateway that serves it under a lease."""

    uav = models.OneToOneField(Uav, on_delete=models.CASCADE, related_name="connection", primary_key=True)
    holder = models.CharField(max_length=100, blank=True, help_text="the gateway that serves it")
    lease_expires_at = models.DateTimeField(null=True, blank=True)
    last_message_at = models.DateTimeField(
        db_column="heard_at", null=True, blank=True, help_text="when anything was last received, by the server's clock"
    )
    address = models.CharField(max_length=100, blank=True, help_text="whence it was received: transport, host and port")
    autopilot = models.CharField(max_length=20, blank=True, help_text="px4, ardupilot or other")
    firmware = models.CharField(max_length=50, blank=True)
    vehicle_type = models.PositiveSmallIntegerField(null=True, blank=True, help_text="MAV_TYPE of its heartbeat")
    mode = models.CharField(max_length=30, blank=True)
    is_armed = models.BooleanField(null=True, blank=True)
    is_in_air = models.BooleanField(null=True, blank=True)
    home = models.PointField(srid=4326, null=True, blank=True)
    home_amsl_m = models.FloatField(null=True, blank=True)
    mission_item = models.IntegerField(null=True, blank=True, help_text="that its list is at, as the autopilot counts; by MAVLink only")
    waypoint_sequence = models.IntegerField(null=True, blank=True, help_text="of its approved route that it flies to, or is at")
    loaded_sha256 = models.CharField(
        max_length=64, blank=True, help_text="of the approved mission found on it by reading back; empty = none"
    )
    loaded_approval = models.UUIDField(null=True, blank=True)
    loaded_flight = models.PositiveSmallIntegerField(null=True, blank=True)
    loaded_read_at = models.DateTimeField(null=True, blank=True, help_text="when it was last read back, by the server's clock")
    loaded_doubt = models.CharField(
        max_length=20,
        default="",
        db_default="",
        blank=True,
        help_text="why it may hold something else by now; empty = nothing says so",
    )
    loaded_beside = models.JSONField(
        default=dict, db_default={}, blank=True, help_text="SHA-256 of lists of its own that were left beside it: fence, rally"
    )
    clock_offset_s = models.FloatField(null=True, blank=True, help_text="server's time at the vehicle's time since boot of 0")
    clock_rate = models.FloatField(null=True, blank=True, help_text="vehicle's seconds a second; a simulation may run faster")
    boots = models.JSONField(
        default=list, db_default=[], blank=True, help_text="runs of the vehicle's clock, the last one last; see mavlink/decoding/boots.py"
    )
    signing = models.JSONField(default=dict, blank=True, help_text="last timestamps by link, so that nothing is taken twice")
    losses = models.JSONField(default=dict, blank=True, help_text="what was refused or lost, by cause")
    limits = models.JSONField(
        default=dict,
        db_default={},
        blank=True,
        help_text="what it would not fly, by its parameters' names [m]; see mavlink/mission_sync/limits.py",
    )

    cameras = models.JSONField(
        default=list, db_default=[], blank=True, help_text="what its cameras report of themselves; see mavlink/decoding/cameras.py"
    )
    battery_state = models.CharField(
        max_length=20, default="", db_default="", blank=True, help_text="as the vehicle itself has it: ok, low, critical, …"
    )
    received_bytes_s = models.FloatField(null=True, blank=True, help_text="bytes a second of its frames, of late")
    received_messages_s = models.FloatField(null=True, blank=True)

    class Meta:
        verbose_name = "UAV's link"

    def __str__(self) -> str:
        return f"link of {self.uav}"


class UnknownVehicleState(models.TextChoices):
    NEW = "new", "New"
    IGNORED = "ignored", "Ignored"
    ADOPTED = "adopted", "Adopted"


class UnknownVehicle(models.Model):
    """A vehicle that a gateway received and that belongs to no UAV; an administrator adopts or ignores it."""

    mavlink_system_id = models.PositiveSmallIntegerField(unique=True)
    autopilot = models.CharField(max_length=20, blank=True)
    vehicle_type = models.CharField(max_length=50, blank=True)
    address = models.CharField(max_length=100, blank=True)
    is_signed = models.BooleanField(default=False)
    location = models.PointField(srid=4326, null=True, blank=True)
    state = models.CharField(max_length=10, choices=UnknownVehicleState.choices, default=UnknownVehicleState.NEW)
    first_message_at = models.DateTimeField(db_column="first_heard_at", db_default=Now(), editable=False)
    last_message_at = models.DateTimeField(db_column="heard_at")
    settled_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    settled_at = models.DateTimeField(null=True, blank=True)
    uav = models.ForeignKey(Uav, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")

    class Meta:
        ordering = ["-last_message_at"]
        constraints = [models.CheckConstraint(condition=Q(state__in=UnknownVehicleState.values), name="unknown_vehicle_state_known")]

    def __str__(self) -> str:
        return f"system {self.mavlink_system_id}"


class FlightLog(models.Model):
    """A tlog file: every MAVLink frame of one flight, in both directions."""

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="flight_logs")
    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="flight_logs")
    mission = models.ForeignKey("missions.Mission", on_delete=models.SET_NULL, null=True, blank=True, related_name="flight_logs")
    path = models.CharField(max_length=200, help_text="under the folder of logs")
    started_at = models.DateTimeField()
    ended_at = models.DateTimeField(null=True, blank=True)
    size_bytes = models.BigIntegerField(default=0)

    class Meta:
        ordering = ["-started_at"]

    def __str__(self) -> str:
        return self.path


class VehicleText(models.Model):
    """A status text of a vehicle (STATUSTEXT)."""

    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="texts")
    severity = models.PositiveSmallIntegerField(help_text="MAV_SEVERITY: 0 emergency to 7 debug")
    text = models.CharField(max_length=500)
    received_at = models.DateTimeField()

    class Meta:
        ordering = ["-received_at", "-pk"]
        indexes = [models.Index(fields=["uav", "-received_at"], name="vehicle_text_newest_idx")]

    def __str__(self) -> str:
        return self.text
