"""Regions: named places of the map data."""

from django.contrib.gis.db import models
from django.db.models.functions import Now


class Region(models.Model):
    """A place with map data. Each import makes one or joins one."""

    name = models.CharField(max_length=200, unique=True)
    extent = models.PolygonField(srid=4326, help_text="box around its assets; without any, around its zones and terrain")
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["name"]

    def __str__(self) -> str:
        return self.name
