"""The height of the ground."""

from django.contrib.gis.db import models

from inspection.models.imports import DataImport


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
