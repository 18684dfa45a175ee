"""Finds missions by their external id and by those of their targets."""

from django.contrib.postgres.operations import AddIndexConcurrently
from django.db import migrations, models
from django.db.models import Q


class Migration(migrations.Migration):
    atomic = False
    dependencies = [("missions", "0030_external_ids")]

    operations = [
        AddIndexConcurrently(
            "mission",
            models.Index(fields=["organisation", "external_id"], condition=~Q(external_id=""), name="mission_external_id_idx"),
        ),
        AddIndexConcurrently(
            "inspectiontarget",
            models.Index(fields=["external_id"], condition=~Q(external_id=""), name="target_external_id_idx"),
        ),
    ]
