"""Lets other systems keep an id and attributes with UAVs, missions and targets."""

from typing import Any

from django.db import migrations, models
from django.db.models import Q


def _external_id(help_text: str) -> Any:
    return models.CharField(blank=True, db_default="", default="", help_text=help_text, max_length=200)


def _attributes() -> Any:
    return models.JSONField(blank=True, db_default={}, default=dict, help_text="names and values of other systems")


class Migration(migrations.Migration):
    dependencies = [("missions", "0029_retired_uavs_give_back_system_ids")]

    operations = [
        migrations.AddField("uav", "external_id", _external_id("another system's id of it; one UAV each")),
        migrations.AddField("uav", "attributes", _attributes()),
        migrations.AddField(
            "mission", "external_id", _external_id("another system's id, such as a work order's; several missions may have one")
        ),
        migrations.AddField("mission", "attributes", _attributes()),
        migrations.AddField("inspectiontarget", "external_id", _external_id("another system's id, such as a work item's")),
        migrations.AddField("inspectiontarget", "attributes", _attributes()),
        migrations.AddConstraint(
            "uav",
            models.UniqueConstraint(fields=["organisation", "external_id"], condition=~Q(external_id=""), name="uav_external_id_unique"),
        ),
    ]
