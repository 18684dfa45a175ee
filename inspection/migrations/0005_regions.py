"""Regions, and those of the imports so far."""

from typing import Any

import django.contrib.gis.db.models.fields
import django.db.models.deletion
from django.contrib.gis.db.models import Extent
from django.contrib.gis.geos import Polygon
from django.db import migrations, models
from django.db.models.functions import Now

Box = tuple[float, float, float, float]


def name_regions(apps: Any, _schema_editor: Any) -> None:
    """Give each import of assets a region of its own unless its extent meets an earlier one; zones and terrain join what they meet."""
    Region, DataImport = apps.get_model("inspection", "Region"), apps.get_model("inspection", "DataImport")  # noqa: N806 - models
    found: list[Any] = []
    for data_import in DataImport.objects.order_by("pk"):
        extent = _extent(apps, data_import)
        if extent is None:
            continue
        region = next((region for region in found if _meet(region.extent.extent, extent)), None)
        if region is None:
            name, count = "Elme Valley" if data_import.is_synthetic else data_import.file_name.partition(".")[0][:180] or "Region", 2
            while Region.objects.filter(name=name).exists():
                name, count = f"{name.rpartition(' ')[0] if count > 2 else name} {count}", count + 1
            region = Region.objects.create(name=name, extent=Polygon.from_bbox(extent))
            found.append(region)
        elif data_import.kind in {"osm", "assets"}:
            region.extent = Polygon.from_bbox(_around(region.extent.extent, extent))
            region.save(update_fields=["extent"])
        DataImport.objects.filter(pk=data_import.pk).update(region=region)


def _extent(apps: Any, data_import: Any) -> Box | None:
    model, column, condition = {
        "zones": ("NoFlyZone", "geometry", {"zone_set__data_import": data_import.pk}),
        "terrain": ("TerrainTile", "extent", {"data_import": data_import.pk}),
    }.get(data_import.kind, ("Asset", "centre", {"data_import": data_import.pk, "vanished_at": None}))
    found: Box | None = apps.get_model("inspection", model).objects.filter(**condition).aggregate(found=Extent(column))["found"]
    if found is None or (found[0] < found[2] and found[1] < found[3]):
        return found
    return (found[0] - 1e-4, found[1] - 1e-4, found[2] + 1e-4, found[3] + 1e-4)


def _meet(one: Box, other: Box) -> bool:
    return one[0] <= other[2] and other[0] <= one[2] and one[1] <= other[3] and other[1] <= one[3]


def _around(one: Box, other: Box) -> Box:
    return min(one[0], other[0]), min(one[1], other[1]), max(one[2], other[2]), max(one[3], other[3])


class Migration(migrations.Migration):
    dependencies = [("inspection", "0004_keys_of_changes")]

    operations = [
        migrations.CreateModel(
            name="Region",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("name", models.CharField(max_length=200, unique=True)),
                (
                    "extent",
                    django.contrib.gis.db.models.fields.PolygonField(
                        help_text="box around its assets; without any, around its zones and terrain", srid=4326
                    ),
                ),
                ("created_at", models.DateTimeField(db_default=Now(), editable=False)),
            ],
            options={"ordering": ["name"]},
        ),
        migrations.AddField(
            model_name="dataimport",
            name="region",
            field=models.ForeignKey(
                blank=True,
                null=True,
                on_delete=django.db.models.deletion.SET_NULL,
                related_name="imports",
                to="inspection.region",
            ),
        ),
        migrations.RunPython(name_regions, migrations.RunPython.noop, elidable=True),
    ]
