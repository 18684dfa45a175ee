"""The dataset version, and the graphs built from map data."""

from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from inspection.models.imports import DataImport


class Ground(models.Model):
    """One row that counts the changes to assets and zones, so that an outdated graph is detected."""

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
    """An immutable network without zones, with counts of the graph cleared of its time's zones. The primary key is the version."""

    version = models.BigAutoField(primary_key=True)
    ground_revision = models.PositiveBigIntegerField(help_text="the ground that it shows")
    rules = models.JSONField(help_text="the linking rules that it was built with")
    nodes = models.PositiveIntegerField()
    edges = models.PositiveIntegerField()
    components = models.PositiveIntegerField()
    excluded_nodes = models.PositiveIntegerField()
    excluded_edges = models.PositiveIntegerField()
    arrays = models.BinaryField(help_text="npz, see inspection/network/snapshot_file.py")
    arrays_sha256 = models.CharField(max_length=64)
    build_s = models.FloatField()
    built_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["-version"]

    def __str__(self) -> str:
        return f"graph {self.version}"


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
