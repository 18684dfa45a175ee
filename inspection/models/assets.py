"""Infrastructure: one table for all kinds, and a proxy for each."""

from typing import ClassVar, TypeVar

from django.contrib.gis.db import models
from django.contrib.postgres.fields import ArrayField
from django.contrib.postgres.indexes import GinIndex, OpClass
from django.db.models import Case, F, Func, Q, Value, When
from django.db.models.functions import Coalesce, Now, NullIf, Upper

from inspection.models.imports import DataImport
from workspace.api.external_data import MAX_EXTERNAL_ID_LENGTH
from workspace.models import Organisation

LAST_NAME = "\U0010ffff"  # sorts after every name


class AssetKind(models.TextChoices):
    TOWER = "tower", "Power tower"
    LINE = "line", "Power line"
    RAILWAY = "railway", "Railway"
    BRIDGE = "bridge", "Bridge"


class OsmType(models.TextChoices):
    NODE = "n", "Node"
    WAY = "w", "Way"
    RELATION = "r", "Relation"


# What a bridge may carry, as JSON paths in its own tags and in those of the ways on its area.
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


class AssetSet(models.Model):
    """The assets of one file other than OpenStreetMap's; importing the source's next file under the same name updates them."""

    name = models.CharField(max_length=200, unique=True)
    data_import = models.ForeignKey(DataImport, on_delete=models.SET_NULL, null=True, blank=True, related_name="asset_sets")
    mapping = models.JSONField(default=dict, blank=True, help_text="which column says what; kept for the next file")

    class Meta:
        ordering = ["name"]

    def __str__(self) -> str:
        return self.name


class Asset(models.Model):
    """A piece of infrastructure. One table for all kinds, so that targets, findings, tiles and imports can refer to any of them.

    geometry: Point for a tower, LineString for a line or railway, Polygon or MultiPolygon for a bridge; WGS84, lon lat.
    """

    kind = models.CharField(max_length=20, choices=AssetKind.choices)
    subtype = models.CharField(max_length=40, blank=True, help_text="tower, pole, portal; line, minor_line, cable; rail, tram; way, area")
    osm_type = models.CharField(max_length=1, choices=OsmType.choices, blank=True)
    osm_id = models.BigIntegerField(null=True, blank=True)
    asset_set = models.ForeignKey(AssetSet, on_delete=models.SET_NULL, null=True, blank=True, related_name="assets")
    source_key = models.CharField(max_length=200, blank=True, default="", db_default="", help_text="the asset's own key in its set")
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
        help_text="of a support: the line of the highest voltage that it carries; see services/ground.py",
    )  # fmt: skip
    place_on_line = models.PositiveSmallIntegerField(null=True, editable=False, help_text="counted from 1 in the line's direction")
    places_on_line = models.PositiveSmallIntegerField(null=True, editable=False, help_text="the line's supports")
    carries = models.GeneratedField(expression=_what_a_bridge_carries(), output_field=models.CharField(max_length=30), db_persist=True)
    data_import = models.ForeignKey(DataImport, on_delete=models.SET_NULL, null=True, blank=True, related_name="assets")
    content_hash = models.CharField(max_length=64, blank=True, editable=False, help_text="of what the last import said")
    is_edited = models.BooleanField(default=False, help_text="changed by a curator; imports leave the row alone")
    source_facts = models.JSONField(
        null=True, blank=True, editable=False, help_text="of an edited row: what its source says, brought up to date by imports"
    )
    revision = models.PositiveIntegerField(default=1, db_default=1, editable=False, help_text="counts the changes; what If-Match compares")
    vanished_at = models.DateTimeField(null=True, blank=True, help_text="when an import no longer had it")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["pk"]
        constraints = [
            models.UniqueConstraint(fields=["kind", "osm_type", "osm_id"], condition=Q(osm_id__isnull=False), name="asset_osm_key"),
            models.UniqueConstraint(fields=["asset_set", "kind", "source_key"], condition=~Q(source_key=""), name="asset_set_key"),
            models.CheckConstraint(condition=Q(kind__in=AssetKind.values), name="asset_kind_known"),
        ]
        indexes = [
            models.Index(fields=["kind", "id"], name="asset_kind_idx"),
            models.Index(  # the most important lines first: tiles of whole countries
                F("max_voltage_v").desc(nulls_last=True),
                F("length_m").desc(nulls_last=True),
                condition=Q(kind="line", vanished_at=None),
                name="asset_lines_idx",
            ),
            models.Index(fields=["osm_type", "osm_id"], name="asset_osm_idx"),
            GinIndex(fields=["voltages_v"], name="asset_voltages_idx"),
            GinIndex(
                OpClass(Upper("name"), name="gin_trgm_ops"),
                OpClass(Upper("ref"), name="gin_trgm_ops"),
                OpClass(Upper("operator"), name="gin_trgm_ops"),
                name="asset_text_idx",
            ),
            models.Index(  # the register by name, those without a name last
                Coalesce(NullIf(Upper("ref"), Value("")), NullIf(Upper("name"), Value("")), Value(LAST_NAME)),
                "id",
                condition=Q(vanished_at=None),
                name="asset_register_idx",
            ),
            models.Index(fields=["updated_at", "id"], name="asset_updated_idx"),
            models.Index(  # the register by height and by length, as its orders compare them
                Coalesce("height_m", Value(0.0), output_field=models.FloatField()),
                "id",
                condition=Q(vanished_at=None),
                name="asset_height_idx",
            ),
            models.Index(
                Coalesce("length_m", Value(0.0), output_field=models.FloatField()),
                "id",
                condition=Q(vanished_at=None),
                name="asset_length_idx",
            ),
        ]

    @property
    def bridge_tags(self) -> list[dict[str, str]]:
        """The tags of a bridge, then those of each way on its area."""
        return [self.tags, *(part["tags"] for part in self.parts)]

    def __str__(self) -> str:
        return self.ref or self.name or f"{AssetKind(self.kind).label} {self.osm_type}{self.osm_id or self.pk}"


Kind = TypeVar("Kind", bound=Asset)


class KindManager(models.Manager[Kind]):
    """The assets of one kind."""

    def __init__(self, kind: AssetKind) -> None:
        super().__init__()
        self.kind = kind

    def get_queryset(self) -> models.QuerySet[Kind]:
        return super().get_queryset().filter(kind=self.kind)


class PowerTower(Asset):
    objects: ClassVar = KindManager(AssetKind.TOWER)

    class Meta:
        proxy = True


class PowerLine(Asset):
    objects: ClassVar = KindManager(AssetKind.LINE)

    class Meta:
        proxy = True


class Railway(Asset):
    objects: ClassVar = KindManager(AssetKind.RAILWAY)

    class Meta:
        proxy = True


class Bridge(Asset):
    objects: ClassVar = KindManager(AssetKind.BRIDGE)

    class Meta:
        proxy = True


class AssetReference(models.Model):
    """An organisation's id and attributes of an asset. They are separate from the asset's row, so that imports do not change them and

    other organisations cannot read them.
    """

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, related_name="asset_references")
    asset = models.ForeignKey(Asset, on_delete=models.CASCADE, related_name="references")
    external_id = models.CharField(max_length=MAX_EXTERNAL_ID_LENGTH, blank=True, default="", db_default="")
    attributes = models.JSONField(default=dict, db_default={}, blank=True)
    updated_at = models.DateTimeField(auto_now=True, db_default=Now())

    class Meta:
        ordering = ["pk"]
        constraints = [
            models.UniqueConstraint(fields=["organisation", "asset"], name="asset_reference_one_each"),
            models.UniqueConstraint(fields=["organisation", "external_id"], condition=~Q(external_id=""), name="asset_external_id_unique"),
        ]

    def __str__(self) -> str:
        return self.external_id or f"attributes of asset {self.asset_id}"
