"""What exists on the ground, and the graph that connects it."""

from django.conf import settings
from django.contrib.gis.db import models
from django.contrib.postgres.fields import ArrayField
from django.contrib.postgres.indexes import GinIndex, OpClass
from django.db.models import Case, F, Func, Q, Value, When
from django.db.models.functions import Now, Upper


class ImportKind(models.TextChoices):
    OSM = "osm", "OpenStreetMap"
    ZONES = "zones", "No-fly zones"
    TERRAIN = "terrain", "Terrain"


class DataImport(models.Model):
    """One file that was read: where the data comes from, under which licence, and what was in it."""

    kind = models.CharField(max_length=20, choices=ImportKind.choices)
    file_name = models.CharField(max_length=255)
    sha256 = models.CharField(max_length=64)
    attribution = models.CharField(max_length=300, blank=True)
    is_synthetic = models.BooleanField(default=False, help_text="made data, such as the demo region; said wherever it is shown")
    data_timestamp = models.DateTimeField(null=True, blank=True, help_text="how fresh the file says that its data is")
    counts = models.JSONField(default=dict)
    imported_at = models.DateTimeField(db_default=Now(), editable=False)
    imported_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True)

    class Meta:
        ordering = ["-imported_at", "-pk"]

    def __str__(self) -> str:
        return self.file_name


class AssetKind(models.TextChoices):
    TOWER = "tower", "Power tower"
    LINE = "line", "Power line"
    RAILWAY = "railway", "Railway"
    BRIDGE = "bridge", "Bridge"


class OsmType(models.TextChoices):
    NODE = "n", "Node"
    WAY = "w", "Way"
    RELATION = "r", "Relation"


# What a bridge may carry, as JSON paths below the tags of its own and of the ways on its area.
_RAIL = 'railway ? (@ like_regex "^(rail|light_rail|narrow_gauge|tram|subway|monorail|funicular|preserved|miniature)$")'
_PATH = 'highway ? (@ like_regex "^(footway|path|pedestrian|steps|cycleway|bridleway|corridor|platform)$")'
_ROAD = 'highway ? (!(@ like_regex "^(footway|path|pedestrian|steps|cycleway|bridleway|corridor|platform)$"))'


def _is_tagged(path: str) -> Q:
    def exists(column: str, place: str) -> Func:
        return Func(F(column), Value(place), function="jsonb_path_exists", output_field=models.BooleanField())

    return Q(exists("tags", f"$.{path}")) | Q(exists("parts", f"$[*].tags.{path}"))


def _what_a_bridge_carries() -> Case:
    return Case(
        When(~Q(kind=AssetKind.BRIDGE.value), then=Value("")),
        When(_is_tagged(_ROAD) & _is_tagged(_RAIL), then=Value("a road and a railway")),
        When(_is_tagged(_RAIL), then=Value("a railway")),
        When(_is_tagged(_ROAD), then=Value("a road")),
        When(_is_tagged(_PATH), then=Value("a path")),
        When(_is_tagged("waterway"), then=Value("water")),
        When(_is_tagged('man_made ? (@ == "pipeline")'), then=Value("a pipeline")),
        default=Value(""),
    )


class Asset(models.Model):
    """A piece of infrastructure. One table for all kinds: targets, findings, tiles and imports point at one thing.

    geometry: Point for a tower, LineString for a line or railway, Polygon or MultiPolygon for a bridge; WGS84, lon lat.
    """

    kind = models.CharField(max_length=20, choices=AssetKind.choices)
    subtype = models.CharField(max_length=40, blank=True, help_text="tower, pole, portal; line, minor_line, cable; rail, tram; way, area")
    osm_type = models.CharField(max_length=1, choices=OsmType.choices, blank=True)
    osm_id = models.BigIntegerField(null=True, blank=True)
    geometry = models.GeometryField(srid=4326)
    centre = models.PointField(srid=4326, help_text="where the asset is drawn and targeted as a point")
    name = models.CharField(max_length=255, blank=True)
    ref = models.CharField(max_length=255, blank=True)
    operator = models.CharField(max_length=255, blank=True)
    voltages_v = ArrayField(models.PositiveIntegerField(), default=list, blank=True, help_text="highest first")
    max_voltage_v = models.PositiveIntegerField(null=True, blank=True)
    circuits = models.PositiveSmallIntegerField(null=True, blank=True)
    height_m = models.FloatField(null=True, blank=True, help_text="above ground, as tagged; empty when not stated")
    length_m = models.FloatField(null=True, blank=True, help_text="geodesic length of a line or railway")
    is_flyable = models.BooleanField(default=True, help_text="part of the inspection graph: not underground, disused, a busbar or a bay")
    node_osm_ids = ArrayField(
        models.BigIntegerField(), default=list, blank=True, editable=False, help_text="OSM node of each vertex of a way"
    )
    tags = models.JSONField(default=dict, blank=True)
    parts = models.JSONField(default=list, blank=True, editable=False, help_text='the OSM ways on a bridge\'s area: [{"osm_id", "tags"}]')
    line = models.ForeignKey(
        "self", on_delete=models.SET_NULL, null=True, editable=False, related_name="supports",
        help_text="of a support: the line of the highest voltage that it carries; see services/supports.py",
    )  # fmt: skip
    place_on_line = models.PositiveSmallIntegerField(null=True, editable=False, help_text="counted from 1 in the line's direction")
    places_on_line = models.PositiveSmallIntegerField(null=True, editable=False, help_text="the line's supports")
    carries = models.GeneratedField(expression=_what_a_bridge_carries(), output_field=models.CharField(max_length=30), db_persist=True)
    data_import = models.ForeignKey(DataImport, on_delete=models.SET_NULL, null=True, blank=True, related_name="assets")
    content_hash = models.CharField(max_length=64, blank=True, editable=False, help_text="of what the last import said")
    is_edited = models.BooleanField(default=False, help_text="changed by a curator; imports leave the row alone")
    vanished_at = models.DateTimeField(null=True, blank=True, help_text="when an import no longer had it")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["pk"]
        constraints = [
            models.UniqueConstraint(fields=["kind", "osm_type", "osm_id"], condition=Q(osm_id__isnull=False), name="asset_osm_key"),
            models.CheckConstraint(condition=Q(kind__in=AssetKind.values), name="asset_kind_known"),
        ]
        indexes = [
            models.Index(fields=["kind", "id"], name="asset_kind_idx"),
            models.Index(fields=["osm_type", "osm_id"], name="asset_osm_idx"),
            GinIndex(
                OpClass(Upper("name"), name="gin_trgm_ops"),
                OpClass(Upper("ref"), name="gin_trgm_ops"),
                OpClass(Upper("operator"), name="gin_trgm_ops"),
                name="asset_text_idx",
            ),
        ]

    def __str__(self) -> str:
        return self.ref or self.name or f"{AssetKind(self.kind).label} {self.osm_type}{self.osm_id or self.pk}"


def _proxy_manager(kind: AssetKind) -> models.Manager:
    class KindManager(models.Manager):
        def get_queryset(self):  # type: ignore[no-untyped-def]
            return super().get_queryset().filter(kind=kind)

    return KindManager()


class PowerTower(Asset):
    objects = _proxy_manager(AssetKind.TOWER)

    class Meta:
        proxy = True


class PowerLine(Asset):
    objects = _proxy_manager(AssetKind.LINE)

    class Meta:
        proxy = True


class Railway(Asset):
    objects = _proxy_manager(AssetKind.RAILWAY)

    class Meta:
        proxy = True


class Bridge(Asset):
    objects = _proxy_manager(AssetKind.BRIDGE)

    class Meta:
        proxy = True


class ZoneSet(models.Model):
    """The zones of one source; importing the source's next file replaces them."""

    name = models.CharField(max_length=200, unique=True)
    data_import = models.ForeignKey(DataImport, on_delete=models.SET_NULL, null=True, blank=True, related_name="zone_sets")
    source_format = models.CharField(max_length=20, blank=True)

    class Meta:
        ordering = ["name"]

    def __str__(self) -> str:
        return self.name


class HeightReference(models.TextChoices):
    AGL = "AGL", "above ground"
    AMSL = "AMSL", "above sea level"


class NoFlyZone(models.Model):
    """One layer of a zone. It states facts as its source gives them; null is "not stated" and is not the same as 0.

    Today every row counts as in force, always and at all heights; height band and schedule are kept whole for later use.
    """

    zone_set = models.ForeignKey(ZoneSet, on_delete=models.CASCADE, null=True, blank=True, related_name="zones")
    identifier = models.CharField(max_length=100, help_text="the source's own key")
    layer = models.PositiveSmallIntegerField(default=0)
    name = models.CharField(max_length=255)
    geometry = models.MultiPolygonField(srid=4326)
    restriction = models.CharField(max_length=100, blank=True)
    reason = models.CharField(max_length=255, blank=True)
    lower_limit_m = models.FloatField(null=True, blank=True)
    lower_reference = models.CharField(max_length=4, choices=HeightReference.choices, blank=True)
    upper_limit_m = models.FloatField(null=True, blank=True)
    upper_reference = models.CharField(max_length=4, choices=HeightReference.choices, blank=True)
    source_heights = models.JSONField(default=dict, blank=True, help_text="limits, unit and references as the file gives them")
    circle = models.JSONField(null=True, blank=True, help_text='{"centre": [lon, lat], "radius_m": number}; the polygon encloses it')
    schedule = models.JSONField(null=True, blank=True, help_text="periods of applicability as the file gives them; null = permanent")
    properties = models.JSONField(default=dict, blank=True, help_text="everything else that the source says")
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


class TerrainTile(models.Model):
    """A block of a terrain model: float32 heights, zlib-compressed, row 0 in the north; NaN is void."""

    data_import = models.ForeignKey(DataImport, on_delete=models.CASCADE, related_name="terrain_tiles")
    extent = models.PolygonField(srid=4326)
    west_deg = models.FloatField(help_text="longitude of the centre of the first column")
    north_deg = models.FloatField(help_text="latitude of the centre of the first row")
    step_lon_deg = models.FloatField()
    step_lat_deg = models.FloatField()
    columns = models.PositiveIntegerField()
    rows = models.PositiveIntegerField()
    heights_amsl_m = models.BinaryField()
    vertical_datum = models.CharField(max_length=50, default="EGM96")

    def __str__(self) -> str:
        return f"{self.data_import} at {self.west_deg:.3f}, {self.north_deg:.3f}"


class Ground(models.Model):
    """One row: counts the changes to assets and zones, so that a graph can tell whether it is out of date."""

    SINGLE_ID = 1

    id = models.PositiveSmallIntegerField(primary_key=True, default=SINGLE_ID)
    revision = models.PositiveBigIntegerField(default=0)
    changed_at = models.DateTimeField(null=True)

    class Meta:
        verbose_name_plural = "ground"
        constraints = [models.CheckConstraint(condition=Q(id=1), name="ground_single")]

    def __str__(self) -> str:
        return f"revision {self.revision}"


class GraphSnapshot(models.Model):
    """An immutable graph, with the zones that it was cleared of. The primary key is the version."""

    version = models.BigAutoField(primary_key=True)
    ground_revision = models.PositiveBigIntegerField(help_text="the ground that it shows")
    rules = models.JSONField(help_text="the linking rules that it was built with")
    nodes = models.PositiveIntegerField()
    edges = models.PositiveIntegerField()
    components = models.PositiveIntegerField()
    excluded_nodes = models.PositiveIntegerField()
    excluded_edges = models.PositiveIntegerField()
    arrays = models.BinaryField(help_text="npz, see inspection/graph/snapshot_file.py")
    arrays_sha256 = models.CharField(max_length=64)
    build_s = models.FloatField()
    built_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["-version"]

    def __str__(self) -> str:
        return f"graph {self.version}"
