"""UAVs, their types, bases and credentials."""

from django.conf import settings
from django.contrib.gis.db import models
from django.contrib.postgres.fields import ArrayField
from django.db.models import Q
from django.db.models.functions import Now

from planning.request import EndAction
from workspace.api.external_data import MAX_EXTERNAL_ID_LENGTH
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation, User

END_ACTIONS = [
    (EndAction.HOVER.value, "Hover at the last target"),
    (EndAction.RETURN.value, "Return to start"),
    (EndAction.LAND.value, "Land at the last target"),
    (EndAction.BASE.value, "Land at the nearest base"),
]


class UavType(models.Model):
    """Values common to UAVs of one make; a UAV's own values override them."""

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="uav_types")
    name = models.CharField(max_length=100)
    max_range_m = models.FloatField(null=True, blank=True, help_text="metres on one battery")
    range_unlimited = models.BooleanField(default=False, db_default=False, help_text="chosen on purpose: no range limits its UAVs")
    cruise_speed_mps = models.FloatField(default=12.0)
    battery_wh = models.FloatField(null=True, blank=True, help_text="watt-hours of a full battery")
    mass_kg = models.FloatField(null=True, blank=True, help_text="kilograms at take-off; empty = 1.545, the Iris's")
    reserve_percent = models.FloatField(default=20.0, db_default=20.0, help_text="of the battery, that no plan uses")
    max_airspeed_mps = models.FloatField(null=True, blank=True, help_text="through the air; empty = its cruise speed")
    rotor_disk_m2 = models.FloatField(null=True, blank=True, help_text="area swept by all rotors; empty = 0.206, the Iris's")
    hover_power_w = models.FloatField(null=True, blank=True, help_text="watts in a calm hover, if measured; empty = worked out")
    sensors = ArrayField(models.CharField(max_length=50), default=list, blank=True)
    cameras = models.JSONField(default=list, db_default=[], blank=True, help_text="see planning/views/camera.py, camera_to_json")
    alert_limits = models.JSONField(
        default=dict,
        db_default={},
        blank=True,
        help_text="limits of alerts that differ from the usual ones; see telemetry/alerting/limits.py",
    )
    revision = models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["name"]
        verbose_name = "UAV type"
        constraints = [
            models.UniqueConstraint(fields=["organisation", "name"], name="uav_type_name_unique"),
            models.CheckConstraint(condition=Q(max_range_m=None) | Q(max_range_m__gt=0), name="uav_type_range_positive"),
            models.CheckConstraint(condition=Q(cruise_speed_mps__gt=0), name="uav_type_speed_positive"),
            models.CheckConstraint(condition=Q(battery_wh=None) | Q(battery_wh__gt=0), name="uav_type_battery_positive"),
            models.CheckConstraint(condition=Q(mass_kg=None) | Q(mass_kg__gt=0), name="uav_type_mass_positive"),
            models.CheckConstraint(condition=Q(reserve_percent__gte=0, reserve_percent__lt=100), name="uav_type_reserve_percent"),
            models.CheckConstraint(condition=Q(max_airspeed_mps=None) | Q(max_airspeed_mps__gt=0), name="uav_type_airspeed_positive"),
            models.CheckConstraint(condition=Q(rotor_disk_m2=None) | Q(rotor_disk_m2__gt=0), name="uav_type_disk_positive"),
            models.CheckConstraint(condition=Q(hover_power_w=None) | Q(hover_power_w__gt=0), name="uav_type_hover_positive"),
            models.CheckConstraint(condition=Q(range_unlimited=False) | Q(max_range_m=None), name="uav_type_range_or_unlimited"),
        ]

    def __str__(self) -> str:
        return self.name


class Base(models.Model):
    """A place where UAVs stand and take off."""

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="bases")
    name = models.CharField(max_length=100)
    location = models.PointField(srid=4326)
    note = models.CharField(max_length=300, blank=True)
    revision = models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["name"]
        constraints = [models.UniqueConstraint(fields=["organisation", "name"], name="base_name_unique")]

    def __str__(self) -> str:
        return self.name


class UavState(models.TextChoices):
    ACTIVE = "active", "Active"
    MAINTENANCE = "maintenance", "In maintenance"
    RETIRED = "retired", "Retired"


class LinkKind(models.TextChoices):
    """The link by which a UAV receives commands."""

    MAVLINK = "mavlink", "MAVLink"
    HTTP = "http", "Companion computer over HTTP"


class Uav(models.Model):
    """An uncrewed aircraft of an organisation.

    `location` is its place on the ground or its last reported position. Its type supplies range, speed, battery, mass, reserve and airspeed
    where it has no value of its own.
    """

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="uavs")
    name = models.CharField(max_length=100)
    uav_type = models.ForeignKey(UavType, on_delete=models.PROTECT, null=True, blank=True, related_name="uavs")
    base = models.ForeignKey(Base, on_delete=models.PROTECT, null=True, blank=True, related_name="uavs")
    base_name = models.CharField(max_length=100, blank=True, help_text="the base's name where it is one of the list; else as it was typed")
    state = models.CharField(max_length=12, choices=UavState.choices, default=UavState.ACTIVE)
    serial_number = models.CharField(max_length=100, blank=True)
    mavlink_system_id = models.PositiveSmallIntegerField(null=True, blank=True, unique=True, help_text="1 to 254; one vehicle each")
    link = models.CharField(max_length=10, choices=LinkKind.choices, default=LinkKind.MAVLINK, db_default=LinkKind.MAVLINK)
    allows_unsigned = models.BooleanField(
        default=False, db_default=False, help_text="MAVLink without a signature is taken for this UAV's: only on a closed network"
    )
    is_simulated = models.BooleanField(default=False, db_default=False, help_text="no real aircraft; may fly without terrain data")
    twin_of = models.OneToOneField(
        "self",
        on_delete=models.CASCADE,
        null=True,
        blank=True,
        related_name="twin",
        help_text="the UAV that it is the simulated twin of: it flies copies of that one's missions",
    )
    is_demo = models.BooleanField(default=False, db_default=False, help_text="made with the demo data, and goes with them")
    location = models.PointField(srid=4326)
    located_at = models.DateTimeField(null=True, blank=True, help_text="when the location was set or reported")
    max_range_m = models.FloatField(null=True, blank=True, help_text="metres on one battery; empty = its type's")
    cruise_speed_mps = models.FloatField(null=True, blank=True, help_text="empty = its type's, else the usual speed")
    battery_wh = models.FloatField(null=True, blank=True, help_text="watt-hours of a full battery; empty = its type's")
    mass_kg = models.FloatField(null=True, blank=True, help_text="kilograms at take-off; empty = its type's")
    reserve_percent = models.FloatField(null=True, blank=True, help_text="of the battery, that no plan uses; empty = its type's, else 20")
    max_airspeed_mps = models.FloatField(null=True, blank=True, help_text="through the air; empty = its type's, else its cruise speed")
    heading_deg = models.FloatField(null=True, blank=True, help_text="degrees from true north, clockwise; empty = not known")
    battery_percent = models.FloatField(null=True, blank=True)
    autopilot_return = models.JSONField(
        default=dict, db_default={}, blank=True, help_text="parameters of its own return, as read from it; see mavlink/rtl.py"
    )
    autopilot_return_read_at = models.DateTimeField(null=True, blank=True)
    sensor = models.CharField(max_length=100, blank=True)
    external_id = models.CharField(
        max_length=MAX_EXTERNAL_ID_LENGTH, blank=True, default="", db_default="", help_text="another system's id of it; one UAV each"
    )
    attributes = models.JSONField(default=dict, db_default={}, blank=True, help_text="names and values of other systems")
    end_action = models.CharField(max_length=10, choices=END_ACTIONS, default=EndAction.RETURN.value)
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    revision = models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["name"]
        verbose_name = "UAV"
        verbose_name_plural = "UAVs"
        constraints = [
            models.UniqueConstraint(fields=["organisation", "name"], name="uav_name_unique"),
            models.UniqueConstraint(fields=["organisation", "external_id"], condition=~Q(external_id=""), name="uav_external_id_unique"),
            models.CheckConstraint(condition=Q(twin_of=None) | Q(is_simulated=True), name="uav_twin_is_simulated"),
            models.CheckConstraint(condition=Q(max_range_m=None) | Q(max_range_m__gt=0), name="uav_range_positive"),
            models.CheckConstraint(condition=Q(cruise_speed_mps__gt=0), name="uav_speed_positive"),
            models.CheckConstraint(condition=Q(battery_wh=None) | Q(battery_wh__gt=0), name="uav_battery_positive"),
            models.CheckConstraint(condition=Q(mass_kg=None) | Q(mass_kg__gt=0), name="uav_mass_positive"),
            models.CheckConstraint(
                condition=Q(reserve_percent=None) | Q(reserve_percent__gte=0, reserve_percent__lt=100), name="uav_reserve_percent"
            ),
            models.CheckConstraint(condition=Q(max_airspeed_mps=None) | Q(max_airspeed_mps__gt=0), name="uav_airspeed_positive"),
            models.CheckConstraint(condition=Q(heading_deg=None) | Q(heading_deg__gte=0, heading_deg__lt=360), name="uav_heading_degrees"),
            models.CheckConstraint(condition=Q(battery_percent=None) | Q(battery_percent__range=(0, 100)), name="uav_battery_percent"),
            models.CheckConstraint(condition=Q(state__in=UavState.values), name="uav_state_known"),
            models.CheckConstraint(condition=Q(link__in=LinkKind.values), name="uav_link_known"),
            models.CheckConstraint(condition=Q(mavlink_system_id=None) | Q(mavlink_system_id__range=(1, 254)), name="uav_system_id_range"),
        ]

    def __str__(self) -> str:
        return self.name

    @property
    def range_m(self) -> float | None:
        return self.uav_type.max_range_m if self.max_range_m is None and self.uav_type else self.max_range_m

    @property
    def missing(self) -> list[str]:
        """What must be stated before it can be planned: a type, and a limit of its flights, unless its type is unlimited on purpose."""
        of_type = self.uav_type
        battery_wh = self.battery_wh or (of_type.battery_wh if of_type else None)
        is_limited = self.range_m is not None or battery_wh is not None or (of_type is not None and of_type.range_unlimited)
        return [*([] if of_type else ["type"]), *([] if is_limited else ["range"])]

    @property
    def speed_mps(self) -> float:
        return self.cruise_speed_mps or (self.uav_type.cruise_speed_mps if self.uav_type else settings.FLIGHT_RULES.cruise_speed_mps)

    @property
    def sensors(self) -> list[str]:
        """Its own, its type's, and the names of its type's cameras."""
        of_type = [*self.uav_type.sensors, *(camera["name"] for camera in self.uav_type.cameras)] if self.uav_type else []
        return list(dict.fromkeys([*filter(None, [self.sensor]), *of_type]))


class CredentialKind(models.TextChoices):
    LINK_TOKEN = "link-token", "Token of the HTTP link"
    MAVLINK_KEY = "mavlink-key", "MAVLink signing key"


class UavCredential(models.Model):
    """A credential of a UAV. No token or key is stored: only a token's SHA-256, and the salt from which a key is derived."""

    uav = models.ForeignKey(Uav, on_delete=models.CASCADE, related_name="credentials")
    kind = models.CharField(max_length=12, choices=CredentialKind.choices)
    token_sha256 = models.CharField(max_length=64, null=True, blank=True, unique=True, editable=False)
    key_salt = models.CharField(max_length=64, blank=True, editable=False)
    created_by = models.ForeignKey(User, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    last_used_at = models.DateTimeField(null=True, blank=True)
    replaced_at = models.DateTimeField(null=True, blank=True, help_text="a newer one was made; this one counts until that was used")
    revoked_at = models.DateTimeField(null=True, blank=True)

    class Meta:
        ordering = ["-created_at"]
        verbose_name = "UAV credential"
        constraints = [
            models.UniqueConstraint(
                fields=["uav", "kind"], condition=Q(revoked_at=None, replaced_at=None), name="uav_credential_one_newest"
            ),
            models.CheckConstraint(condition=Q(kind__in=CredentialKind.values), name="uav_credential_kind_known"),
        ]

    def __str__(self) -> str:
        return f"{self.get_kind_display()} of {self.uav}"
