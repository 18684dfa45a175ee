"""No-fly zones, zone sets, and the subscriptions that update sets."""

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from inspection.models.imports import DataImport, ImportProposal


class ZoneSet(models.Model):
    """The zones of one source; importing the source's next file replaces them."""

    name = models.CharField(max_length=200, unique=True)
    data_import = models.ForeignKey(DataImport, on_delete=models.SET_NULL, null=True, blank=True, related_name="zone_sets")
    source_format = models.CharField(max_length=20, blank=True)

    class Meta:
        ordering = ["name"]

    def __str__(self) -> str:
        return self.name


class ZoneSetVersion(models.Model):
    """The zones of a set as one import left them, so that the set can be rolled back to it."""

    zone_set = models.ForeignKey(ZoneSet, on_delete=models.CASCADE, related_name="versions")
    number = models.PositiveIntegerField(help_text="counted from 1 in the set")
    data_import = models.ForeignKey(DataImport, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    zones = models.PositiveIntegerField()
    content = models.BinaryField(help_text="JSON of every zone, zlib")
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["-number"]
        constraints = [models.UniqueConstraint(fields=["zone_set", "number"], name="zone_set_version_number")]

    def __str__(self) -> str:
        return f"{self.zone_set} version {self.number}"


class ZoneSubscription(models.Model):
    """Source and interval of a set's next file. A fetched file becomes a proposal; a curator decides."""

    zone_set = models.OneToOneField(ZoneSet, on_delete=models.CASCADE, related_name="subscription")
    address = models.URLField(max_length=500)
    source_format = models.CharField(max_length=20, blank=True, help_text="ed269, ed318, openair, geojson; empty = found out from the file")
    licence = models.CharField(max_length=200, blank=True)
    attribution = models.CharField(max_length=300, blank=True)
    interval_h = models.PositiveIntegerField(default=24)
    is_active = models.BooleanField(default=True)
    etag = models.CharField(max_length=300, blank=True, editable=False)
    last_modified = models.CharField(max_length=100, blank=True, editable=False)
    next_fetch_at = models.DateTimeField(db_default=Now())
    fetched_at = models.DateTimeField(null=True, blank=True, help_text="when the source last answered")
    sha256 = models.CharField(max_length=64, blank=True, editable=False, help_text="of what it answered")
    problem = models.CharField(max_length=500, blank=True, help_text="why the last fetch brought nothing; empty = it did")
    failures = models.PositiveSmallIntegerField(default=0, help_text="one after the other")
    proposal = models.ForeignKey(ImportProposal, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")

    class Meta:
        ordering = ["zone_set__name"]

    def __str__(self) -> str:
        return f"{self.zone_set} from {self.address}"


class HeightReference(models.TextChoices):
    AGL = "AGL", "above ground"
    AMSL = "AMSL", "above sea level"
    WGS84 = "WGS84", "above the ellipsoid"
    STD = "STD", "flight level, metres of standard pressure altitude"


class NoFlyZone(models.Model):
    """One layer of a zone. It stores facts as its source states them; null means "not stated", which differs from 0.

    inspection/zones computes its heights and times: unstated values count as reaching, and as always.
    """

    zone_set = models.ForeignKey(ZoneSet, on_delete=models.CASCADE, null=True, blank=True, related_name="zones")
    identifier = models.CharField(max_length=100, help_text="the source's own key")
    layer = models.PositiveSmallIntegerField(default=0)
    name = models.CharField(max_length=255)
    geometry = models.MultiPolygonField(srid=4326)
    restriction = models.CharField(max_length=100, blank=True)
    reason = models.CharField(max_length=255, blank=True)
    lower_limit_m = models.FloatField(null=True, blank=True)
    lower_reference = models.CharField(max_length=5, choices=HeightReference.choices, blank=True)
    upper_limit_m = models.FloatField(null=True, blank=True)
    upper_reference = models.CharField(max_length=5, choices=HeightReference.choices, blank=True)
    source_heights = models.JSONField(default=dict, blank=True, help_text="limits, unit and references as the file gives them")
    circle = models.JSONField(null=True, blank=True, help_text='{"centre": [lon, lat], "radius_m": number}; the polygon encloses it')
    schedule = models.JSONField(null=True, blank=True, help_text="periods of applicability as the file gives them; null = permanent")
    properties = models.JSONField(default=dict, blank=True, help_text="everything else that the source says")
    is_edited = models.BooleanField(
        default=False, db_default=False, help_text="changed by a curator; imports leave the row alone unless told otherwise"
    )
    revision = models.PositiveIntegerField(default=1, db_default=1, editable=False, help_text="counts the changes; what If-Match compares")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["pk"]
        verbose_name = "no-fly zone"
        constraints = [
            models.UniqueConstraint(fields=["zone_set", "identifier", "layer"], name="zone_source_key"),
            models.CheckConstraint(
                condition=Q(lower_limit_m=None)
                | Q(upper_limit_m=None)
                | ~Q(lower_reference=models.F("upper_reference"))
                | Q(upper_limit_m__gte=models.F("lower_limit_m")),
                name="zone_band_upright",
            ),
        ]

    def __str__(self) -> str:
        return self.name
